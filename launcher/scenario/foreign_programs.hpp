// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/program/declaration.hpp"
#include "launcher/scenario/program.hpp"

#include <map>
#include <memory>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// `program: {path: FILE, arguments: [...]}`: programs of somebody else. Each is asked once what it is, `FILE ARGUMENTS
/// --describe`, with half a minute to answer.
class ForeignPrograms {
  public:
    /// `may_start` false: they are refused.
    explicit ForeignPrograms(bool may_start) : may_start_{may_start} {}

    /// Reads the keys of a process from `fields`; the program's name goes to `name`. Nothing when it does not say what
    /// it is: mistakes are reported at its path, or by line and column of what it printed.
    [[nodiscard]] std::unique_ptr<ProcessSettings> read(config::Fields& fields, config::Node const& written,
                                                        std::string& name, config::Diagnostics& diagnostics);

  private:
    std::optional<program::Declaration> const& ask(std::vector<std::string> const& command, config::Ref const& path,
                                                   config::Diagnostics& diagnostics);

    bool may_start_;
    std::map<std::vector<std::string>, std::optional<program::Declaration>> answers_; ///< by command
};

} // namespace gridspace::launcher
