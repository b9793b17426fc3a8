// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string_view>

namespace gridspace::fmi {

/// A unit by the base units of SI (section 2.4.4 of FMI 3.0.1): value in base units = factor * value + offset.
struct Unit {
    std::string_view name;
    int kg{0}, m{0}, s{0}, a{0}, k{0}, rad{0};
    double factor{1}, offset{0};
};

/// Of the names that signals and keys of ours have ("kW", "p.u."); nullptr for others, a code of positions for example.
[[nodiscard]] Unit const* unit_named(std::string_view name);

} // namespace gridspace::fmi
