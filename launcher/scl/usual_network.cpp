// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scl/station_scenario.hpp"

#include "common/text.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {

std::string usual_network(std::string const& name, double nominal_hz) {
    return fmt::format(
        R"(# What the merging units of a station measure while nobody has said more: a source, a line, a load. Change it, or give
# `gridspace scl import` a network of your own (--network, --map).
---
gridspace_network: 1
name: {}
base: {{frequency_hz: {}, power_kva: 100000}}
buses:
  A: {{voltage_v: 110000, diagram: {{x: 0, y: 0}}}}
  B: {{voltage_v: 110000, diagram: {{x: 1, y: 0}}}}
sources:
  SA: {{bus: A, r_ohm: 0.5, l_mh: 20, r0_ohm: 0.5, l0_mh: 20}}
lines:
  AB: {{from: A, to: B, r_ohm: 1.2, l_mh: 13, r0_ohm: 3.6, l0_mh: 39}}
breaker_types:
  quick: {{mechanism_ms: 40, opens: each_pole_at_current_zero, latched: true}}
breakers:
  Q1: {{line: AB, end: from, type: quick, state: closed}}
ct_types:
  c600: {{ratio: "600:1"}}
cts:
  CT1: {{line: AB, end: from, type: c600, positive: into_line}}
vt_types:
  v110: {{ratio: "110000:100"}}
vts:
  VT1: {{bus: A, type: v110}}
loads:
  LB: {{bus: B, p_kw: 60000, power_factor: 0.95, model: constant_impedance}}
)",
        name, shortest(nominal_hz));
}

} // namespace gridspace::launcher
