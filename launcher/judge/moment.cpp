// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/moment.hpp"

#include "common/text.hpp"

#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

/// "2 s", "20 ms", "4 h"
std::optional<double> seconds_of(std::string_view text) {
    double number = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    std::string_view const unit = trim(text.substr(static_cast<std::size_t>(end - text.data())));
    double const factor = unit == "s" ? 1 : unit == "ms" ? 1e-3 : unit == "min" ? 60 : unit == "h" ? 3600 : 0;
    return error != std::errc{} || factor == 0 || !std::isfinite(number) ? std::nullopt
                                                                         : std::optional{number * factor};
}

} // namespace

std::optional<Moment> parse_moment(std::string_view text) {
    if (auto const absolute = seconds_of(trim(text))) {
        return Moment{"", *absolute};
    }
    Moment moment;
    std::size_t const sign = text.find_first_of("+-");
    moment.event = std::string{trim(text.substr(0, sign))};
    if (sign != std::string_view::npos) {
        auto const offset = seconds_of(trim(text.substr(sign + 1)));
        if (!offset) {
            return std::nullopt;
        }
        moment.offset_s = text[sign] == '-' ? -*offset : *offset;
    }
    bool const name = !moment.event.empty() && is_identifier(moment.event.substr(0, 1)); // not "5" without its unit
    return name ? std::optional{moment} : std::nullopt;
}

std::string to_text(Moment const& moment) {
    if (moment.event.empty()) {
        return shortest(moment.offset_s) + " s";
    }
    return moment.offset_s == 0 ? moment.event
                                : fmt::format("{} {} {} s", moment.event, moment.offset_s < 0 ? "-" : "+",
                                              shortest(std::abs(moment.offset_s)));
}

void describe_moment(config::Fields& f, std::string_view key, std::optional<Moment>& out, std::string_view doc) {
    std::string text;
    f.text(key, text, {.doc = doc});
    if (!text.empty()) {
        out = parse_moment(text);
        if (!out) {
            f.error(key, fmt::format("'{}' is not an instant", text),
                    "an event, with `+` or `-` and a time: fault + 2 s; or a time with its unit: 4 h");
        }
    }
}

Moments moments_of(config::Node const* timeline, std::vector<LoggedEvent> const& reported) {
    Moments out;
    if (timeline != nullptr) {
        for (config::Node::Entry const& event : timeline->entries) {
            if (config::Node const* at = event.value.find("at_s"); at != nullptr) {
                out[event.key] = config::number_of(*at).value_or(0);
            }
        }
    }
    for (LoggedEvent const& event : reported) {
        out.try_emplace(event.source + "." + event.event, event.time_s);
    }
    return out;
}

std::optional<double> instant_of(Moment const& moment, Moments const& moments) {
    if (moment.event.empty()) {
        return moment.offset_s;
    }
    auto const it = moments.find(moment.event);
    return it == moments.end() ? std::nullopt : std::optional{it->second + moment.offset_s};
}

} // namespace gridspace::launcher
