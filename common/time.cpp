// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/time.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <fmt/format.h>

namespace gridspace {
namespace {

__extension__ using Wide = __int128;
constexpr std::int64_t kNsPerSecond = 1'000'000'000;

std::int64_t divide_to_nearest(Wide num, Wide den) {
    Wide const twice = 2 * num + (num < 0 ? -den : den);
    return static_cast<std::int64_t>(twice / (2 * den));
}

} // namespace

std::int64_t TimeBase::nanoseconds(SimTime t) const {
    return divide_to_nearest(static_cast<Wide>(t.quanta) * quantum_s_.num() * kNsPerSecond, quantum_s_.den());
}

SimTime TimeBase::from_nanoseconds(std::int64_t ns) const {
    return {divide_to_nearest(static_cast<Wide>(ns) * quantum_s_.den(),
                              static_cast<Wide>(quantum_s_.num()) * kNsPerSecond)};
}

/// Longer than any run is as good as for ever: 30 years of nanoseconds still fit into 64 bits.
SimTime TimeBase::later(SimTime t, double seconds) const {
    constexpr double kLongestS = 1e9;
    auto const ns = static_cast<std::int64_t>(std::min(seconds, kLongestS) * 1e9);
    SimSpan const span = from_nanoseconds(ns) - SimTime{};
    return t.quanta > INT64_MAX - span.quanta ? SimTime{INT64_MAX} : t + span;
}

SimSpan TimeBase::ceil(Rational seconds) const {
    return {(seconds / quantum_s_).ceil()};
}
SimSpan TimeBase::nearest(Rational seconds) const {
    return {(seconds / quantum_s_).round()};
}

std::string human_duration(double seconds) {
    if (!std::isfinite(seconds)) {
        return "?";
    }
    if (seconds < 60.0) {
        return fmt::format("{:.3g} s", seconds);
    }
    auto const whole = static_cast<std::int64_t>(std::llround(seconds));
    if (whole < 3600) {
        return fmt::format("{} min {:02} s", whole / 60, whole % 60);
    }
    return fmt::format("{} h {:02} min", whole / 3600, (whole % 3600) / 60);
}

std::optional<Rational> parse_duration(std::string_view text) {
    Rational factor{1};
    for (auto const& [suffix, seconds] :
         {std::pair{"min", Rational{60}}, {"ms", Rational{1, 1000}}, {"h", Rational{3600}}, {"s", Rational{1}}}) {
        if (text.ends_with(suffix)) {
            text.remove_suffix(std::string_view{suffix}.size());
            factor = seconds;
            break;
        }
    }
    auto const value = Rational::parse(trim(text));
    return value && *value > Rational{0} ? std::optional{*value * factor} : std::nullopt;
}

std::optional<std::int64_t> parse_utc(std::string_view text) {
    // 2019-12-01T09:00:00Z
    if (text.size() != 20 || text[4] != '-' || text[7] != '-' || text[10] != 'T' || text[13] != ':' ||
        text[16] != ':' || text[19] != 'Z') {
        return std::nullopt;
    }
    auto const number = [&](std::size_t at, std::size_t count) -> int {
        int value = 0;
        for (std::size_t i = at; i < at + count; ++i) {
            if (text[i] < '0' || text[i] > '9') {
                return -1;
            }
            value = value * 10 + (text[i] - '0');
        }
        return value;
    };
    int const year = number(0, 4), month = number(5, 2), day = number(8, 2);
    int const hour = number(11, 2), minute = number(14, 2), second = number(17, 2);
    using namespace std::chrono;
    year_month_day const date{std::chrono::year{year}, std::chrono::month{static_cast<unsigned>(month)},
                              std::chrono::day{static_cast<unsigned>(day)}};
    constexpr int kFirstYear = 1970, kLastYear = 2199; // recordings count nanoseconds from 1970, in 63 bits
    if (year < kFirstYear || year > kLastYear || month < 0 || day < 0 || !date.ok() || hour < 0 || hour > 23 ||
        minute < 0 || minute > 59 || second < 0 || second > 59) {
        return std::nullopt;
    }
    return duration_cast<seconds>(sys_days{date}.time_since_epoch()).count() + hour * 3600 + minute * 60 + second;
}

std::string format_utc(std::int64_t unix_seconds) {
    using namespace std::chrono;
    sys_seconds const at{seconds{unix_seconds}};
    auto const days = floor<std::chrono::days>(at);
    year_month_day const date{days};
    hh_mm_ss const clock{at - days};
    return fmt::format("{:04}-{:02}-{:02}T{:02}:{:02}:{:02}Z", int{date.year()}, unsigned{date.month()},
                       unsigned{date.day()}, clock.hours().count(), clock.minutes().count(), clock.seconds().count());
}

} // namespace gridspace
