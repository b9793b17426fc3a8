// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "sim/network/network.hpp"

#include <string_view>

/// How each element of a network file is read: its keys, units and limits. network_config.cpp puts them together.
namespace gridspace::sim::elements {

using config::Fields;
using config::NumberSpec;

constexpr NumberSpec positive(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    spec.above = 0;
    return spec;
}
constexpr NumberSpec not_negative(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    spec.min = 0;
    return spec;
}
constexpr NumberSpec any(std::string_view doc, bool required = false) {
    NumberSpec spec;
    spec.doc = doc;
    spec.required = required;
    return spec;
}
constexpr NumberSpec percent(std::string_view doc, bool required = false) {
    NumberSpec spec = not_negative(doc, required);
    spec.max = 100;
    return spec;
}

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

// injection_config.cpp: what feeds or loads a bus, and how that changes over time
void source(Fields& f, Source& element);
void machine_type(Fields& f, MachineType& element);
void machine(Fields& f, Machine& element);
void generator(Fields& f, Generator& element);
void load(Fields& f, Load& element);
void shunt(Fields& f, Shunt& element);
void pv(Fields& f, Pv& element);
void ev(Fields& f, Ev& element);
void battery(Fields& f, Battery& element);
void profile(Fields& f, Profile& element);

} // namespace gridspace::sim::elements
