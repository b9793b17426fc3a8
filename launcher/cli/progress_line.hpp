// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <chrono>
#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <unistd.h>

namespace gridspace::cli {

/// Progress on standard error: one line that is overwritten on a terminal, one line every ten seconds otherwise.
class ProgressLine {
  public:
    explicit ProgressLine(bool quiet) : quiet_{quiet}, terminal_{::isatty(STDERR_FILENO) != 0} {}
    void show(std::string const& text, bool last) {
        auto const now = std::chrono::steady_clock::now();
        if (quiet_ || (!terminal_ && !last && now - shown_ < std::chrono::seconds{10})) {
            return;
        }
        shown_ = now;
        fmt::print(stderr, "{}{}{}", terminal_ ? "\r\033[K" : "", text, terminal_ && !last ? "" : "\n");
    }

  private:
    bool quiet_, terminal_;
    std::chrono::steady_clock::time_point shown_{std::chrono::steady_clock::now()};
};

} // namespace gridspace::cli
