// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/elements.hpp"

#include <fmt/format.h>

namespace gridspace::sim {

std::string settable_paths(bool in_phasors) {
    std::string out;
    OnePorts const none;
    for_each_kind(none, [&]<class T>(std::vector<T> const&) {
        for (Quantity const& q : T::kKind.settable) {
            if (q.in_phasors || !in_phasors) {
                out += fmt::format("{}{}.<name>.{}", out.empty() ? "" : ", ", T::kKind.section, q.name);
            }
        }
    });
    return out;
}

} // namespace gridspace::sim
