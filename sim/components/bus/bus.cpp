// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/bus/bus.hpp"

#include "sim/components/faces/number_specs.hpp"

namespace gridspace::sim {

using namespace elements;

void Bus::fields(Fields& f) {
    f.number("voltage_v", voltage_v, positive("nominal voltage, line to line, r.m.s.", true));
    f.object("diagram", {.doc = "place in the one-line diagram"}, [&](Fields& d) {
        d.number("x", diagram_x, any("column"));
        d.number("y", diagram_y, any("row, downwards"));
    });
}

} // namespace gridspace::sim
