// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/checks.hpp"

#include <charconv>
#include <fmt/format.h>

namespace gridspace::cli {
namespace {

constexpr double kAny = std::numeric_limits<double>::max();

} // namespace

Check number(double least, char const* what, double most) {
    return Check{[least, what, most](std::string const& text) {
        double value = 0;
        auto const [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value);
        bool const ok = ec == std::errc{} && end == text.data() + text.size() && value >= least && value <= most;
        return ok ? std::string{} : fmt::format("'{}' is not {}", text, what);
    }};
}

Check positive() {
    return number(std::numeric_limits<double>::min(), "a number above 0", kAny);
}

Check not_negative() {
    return number(0, "a number from 0 on", kAny);
}

} // namespace gridspace::cli
