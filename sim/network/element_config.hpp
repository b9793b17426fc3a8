// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/network/network.hpp"

/// How those elements of a network file are read that have no home in sim/components: keys, units and limits.
namespace gridspace::sim::elements {

// branch_config.cpp: lines, transformers, breakers and instrument transformers
void line_type(Fields& f, LineType& element);
void line(Fields& f, Line& element);
void transformer(Fields& f, Transformer& element);
void breaker_type(Fields& f, BreakerType& element);
void breaker(Fields& f, Breaker& element);
void ct_type(Fields& f, CtType& element);
void vt_type(Fields& f, VtType& element);
void vt(Fields& f, Vt& element);
void ct(Fields& f, Ct& element);

// injection_config.cpp: what feeds a bus, and profiles
void source(Fields& f, Source& element);
void machine_type(Fields& f, MachineType& element);
void machine(Fields& f, Machine& element);
void generator(Fields& f, Generator& element);
void profile(Fields& f, Profile& element);

} // namespace gridspace::sim::elements
