// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"
#include "launcher/run/progress_bar.hpp"
#include "launcher/run/say.hpp"
#include "launcher/sweep/sweep.hpp"

#include <chrono>
#include <fmt/format.h>
#include <string>
#include <unistd.h>

namespace gridspace::cli {

/// One line that is redrawn on a terminal; a line every half minute elsewhere.
class SweepProgressLine {
  public:
    SweepProgressLine(std::string study, bool quiet)
        : study_{std::move(study)}, quiet_{quiet}, is_terminal_{::isatty(STDERR_FILENO) != 0} {}

    void show(launcher::SweepProgress const& at, bool last) {
        auto const now = std::chrono::steady_clock::now();
        auto const pause = is_terminal_ ? std::chrono::milliseconds{200} : std::chrono::milliseconds{30'000};
        if (quiet_ || at.of == 0 || (!last && now - shown_ < pause)) {
            return;
        }
        shown_ = now;
        std::string const text = fmt::format(
            "{} / {} runs{}{}", at.done, at.of, at.failed > 0 ? fmt::format(", {} not passed", at.failed) : "",
            !last && at.left_s ? ", about " + human_duration(*at.left_s) + " left" : "");
        if (is_terminal_) {
            double const share = static_cast<double>(at.done) / static_cast<double>(at.of);
            say(stderr, "\r\x1b[K{} ▕{}▏ {}{}", study_, launcher::progress_bar(share, 24), text, last ? "\n" : "");
            is_drawn_ = !last;
        } else {
            say(stderr, "{}: {}\n", study_, text);
        }
    }

    void note(std::string_view text) {
        if (!quiet_) {
            say(stderr, "{}{}\n", is_drawn_ ? "\r\x1b[K" : "", text);
            is_drawn_ = false;
        }
    }

  private:
    std::string study_;
    bool quiet_, is_terminal_, is_drawn_{false};
    std::chrono::steady_clock::time_point shown_{std::chrono::steady_clock::now()};
};

} // namespace gridspace::cli
