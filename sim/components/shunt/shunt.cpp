// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/shunt/shunt.hpp"

#include "sim/components/faces/number_specs.hpp"

namespace gridspace::sim {

using namespace elements;

void Shunt::fields(Fields& f) {
    f.number("p_kw", p_kw, any("active power consumed at 1 p.u."));
    f.number("q_kvar", q_kvar, any("reactive power produced at 1 p.u."));
}

} // namespace gridspace::sim
