// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/units.hpp"

#include <algorithm>
#include <array>
#include <numbers>

namespace gridspace::fmi {
namespace {

constexpr std::array kUnits{
    Unit{.name = "p.u."},
    Unit{.name = "%", .factor = 0.01},
    Unit{.name = "s", .s = 1},
    Unit{.name = "Hz", .s = -1},
    Unit{.name = "deg", .rad = 1, .factor = std::numbers::pi / 180},
    Unit{.name = "m/s", .m = 1, .s = -1},
    Unit{.name = "kg", .kg = 1},
    Unit{.name = "degC", .k = 1, .offset = 273.15},
    Unit{.name = "V", .kg = 1, .m = 2, .s = -3, .a = -1},
    Unit{.name = "A", .a = 1},
    Unit{.name = "kW", .kg = 1, .m = 2, .s = -3, .factor = 1e3},
    Unit{.name = "kvar", .kg = 1, .m = 2, .s = -3, .factor = 1e3},
    Unit{.name = "kWh/kg", .m = 2, .s = -2, .factor = 3.6e6},
};

} // namespace

Unit const* unit_named(std::string_view name) {
    auto const* const found = std::find_if(kUnits.begin(), kUnits.end(), [&](Unit const& u) { return u.name == name; });
    return found == kUnits.end() ? nullptr : found;
}

} // namespace gridspace::fmi
