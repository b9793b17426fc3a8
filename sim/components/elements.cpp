// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/elements.hpp"

namespace gridspace::sim {

std::vector<OnePort const*> one_ports(Elements const& e) {
    return all<OnePort>(e);
}

std::vector<TwoPort const*> two_ports(Elements const& e) {
    return all<TwoPort>(e);
}

} // namespace gridspace::sim
