// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/instance.hpp"

#include <filesystem>
#include <memory>
#include <string>

namespace gridspace::agents {

/// An FMU in a folder of its own, in the folder that the process runs in: for as long as this lives.
class UnpackedFmu {
  public:
    [[nodiscard]] static Result<std::unique_ptr<UnpackedFmu>> open(std::filesystem::path const& file,
                                                                   std::string const& process);
    ~UnpackedFmu();
    UnpackedFmu(UnpackedFmu const&) = delete;
    UnpackedFmu& operator=(UnpackedFmu const&) = delete;

    [[nodiscard]] fmi::ModelDescription const& description() const { return description_; }
    [[nodiscard]] Result<std::unique_ptr<fmi::Instance>> instantiate(std::string const& name, fmi::Host& host) const;

  private:
    UnpackedFmu() = default;
    std::filesystem::path folder_;
    std::string binary_;
    fmi::ModelDescription description_;
};

} // namespace gridspace::agents
