// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// Names runs by what they depend on, so that a run that is there already is not done again: the scenario as it is
/// after all overrides, but for what only its report shows; the network, and every file that either of them or a
/// process's configuration names (models, profiles, QoS); the programs and this launcher; its version; `depends_on`.
/// Not by the libraries and the kernel of the machine.
class RunKeys {
  public:
    explicit RunKeys(std::vector<std::filesystem::path> const& depends_on);

    /// 16 hexadecimal digits of SHA-256.
    [[nodiscard]] std::string key_of(Scenario const& scenario);

  private:
    void add_files(config::Node const& node, std::map<std::string, std::string>& files);
    void add_file(std::filesystem::path const& file, std::map<std::string, std::string>& files);

    std::map<std::string, std::string> hashes_; ///< by path; empty: no file. The files of a study are read once
    std::map<std::string, std::string> always_;
};

} // namespace gridspace::launcher
