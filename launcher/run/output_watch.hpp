// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

namespace gridspace::launcher {

/// Looks for a text in a file that grows.
class OutputWatch {
  public:
    OutputWatch(std::filesystem::path file, std::string text);
    [[nodiscard]] bool found();

  private:
    std::filesystem::path file_;
    std::string text_, end_; ///< `end_`: what has been read last, shorter than the text
    std::uintmax_t read_{0};
    bool found_{false};
};

} // namespace gridspace::launcher
