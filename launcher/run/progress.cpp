// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/progress.hpp"

#include "common/time.hpp"
#include "launcher/run/progress_bar.hpp"
#include "launcher/run/say.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <sys/ioctl.h>
#include <unistd.h>
#include <utility>

namespace gridspace::launcher {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

double seconds_since(Clock::time_point start) {
    return std::chrono::duration<double>(Clock::now() - start).count();
}

std::size_t terminal_width() {
    winsize size{};
    return ::ioctl(STDERR_FILENO, TIOCGWINSZ, &size) == 0 && size.ws_col > 20 ? size.ws_col : 100;
}

} // namespace

Progress::Progress(Style style, std::string scenario, double duration_s)
    : style_{style}, scenario_{std::move(scenario)}, duration_s_{duration_s} {}

Progress::~Progress() {
    if (std::string const text = take_unread(); !text.empty()) {
        say(stderr, "{}", text);
    }
}

std::string Progress::take_unread() {
    std::string text = output_.take();
    if (output_.left_out() > 0 && !std::exchange(left_out_is_said_, true)) {
        std::string const note =
            fmt::format("{} lines are left out here; events.ndjson has every event", output_.left_out());
        text += style_ == Style::json ? Json{{"note", note}}.dump() + "\n" : note + "\n";
    }
    return text;
}

void Progress::clear() {
    if (style_ == Style::terminal && drawn_) {
        print("\r\x1b[K");
        drawn_ = false;
    }
}

void Progress::note(std::string_view text) {
    if (style_ == Style::quiet) {
        return;
    }
    clear();
    if (style_ == Style::json) {
        print(Json{{"note", text}}.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
    } else {
        print(fmt::format("{}\n", text));
    }
}

void Progress::event(double time_s, std::string_view source, std::string_view kind, std::string_view text) {
    if (style_ == Style::quiet) {
        return;
    }
    clear();
    if (style_ == Style::json) {
        Json const line{{"time_s", time_s}, {"source", source}, {"event", kind}, {"text", text}};
        print(line.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n");
    } else {
        print(fmt::format("  {:>12.4f} s  {:<12} {:<16} {}\n", time_s, source, kind, text));
    }
}

void Progress::update(double time_s, unsigned long overruns) {
    if (!started_) {
        started_ = true;
        start_ = drawn_at_ = Clock::now();
    }
    time_s_ = time_s;
    overruns_ = overruns;
    double const since_drawn = seconds_since(drawn_at_);
    bool const due = style_ == Style::terminal ? since_drawn >= 0.1
                     : style_ == Style::json   ? since_drawn >= 0.5
                                               : since_drawn >= 10;
    if (due) {
        draw(false);
    }
}

void Progress::draw(bool last) {
    if (style_ == Style::quiet || !started_) {
        return;
    }
    drawn_at_ = Clock::now();
    double const wall = std::max(1e-3, seconds_since(start_));
    double const speed = time_s_ / wall;
    double const share = duration_s_ > 0 ? time_s_ / duration_s_ : 0;
    double const left = speed > 0 ? (duration_s_ - time_s_) / speed : 0;
    if (style_ == Style::json) {
        show(Json{{"time_s", time_s_}, {"duration_s", duration_s_}, {"speed", speed}, {"overruns", overruns_}}.dump() +
                 "\n",
             last);
        return;
    }
    std::string const text =
        fmt::format("sim {} / {}  x{:.3g}  {}{}", human_duration(time_s_), human_duration(duration_s_), speed,
                    last ? fmt::format("in {}", human_duration(wall)) : fmt::format("ETA {}", human_duration(left)),
                    overruns_ > 0 ? fmt::format("  overruns {}", overruns_) : "");
    if (style_ == Style::plain) {
        show(fmt::format("{}: {}\n", scenario_, text), last);
        return;
    }
    int const cells = terminal_width() > scenario_.size() + text.size() + 26 ? 20 : 0;
    show(fmt::format("\r\x1b[K{} {}{}{}", scenario_, cells > 0 ? "▕" : "",
                     cells > 0 ? progress_bar(share, cells) + "▏ " : "", text),
         last);
    drawn_ = true;
}

void Progress::finish() {
    if (started_) {
        draw(true);
        if (style_ == Style::terminal) {
            print("\n");
            drawn_ = false;
        }
    }
    output_.drain(std::chrono::seconds{1});
}

void Progress::show(std::string text, bool last) {
    if (last) {
        print(text);
    } else {
        output_.put_latest(std::move(text));
    }
}

} // namespace gridspace::launcher
