// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/fmu_config.hpp"

#include <fmt/format.h>

namespace gridspace::agents {
namespace {

using config::Fields;
using config::Node;

void read_map(Fields& f, std::string_view key, Node& node, config::Spec spec) {
    f.raw(key, node, spec);
    if (!node.is_null() && !node.is_map()) {
        f.error(key, fmt::format("`{}` is {}", key, config::describe(node)), "expected a map: NAME: VALUE");
        node = {};
    }
}

void describe_topic(Fields& f, gateways::MappingEnd& end) {
    f.reference("topic", end.topic, {.doc = "DDS topic"});
    f.reference("type", end.type, {.doc = "type of the topic, from an IDL file of the build"});
}

void describe_input(Fields& f, FmuInput& input) {
    describe_topic(f, input.from);
    gateways::describe_where(f, input.from);
    read_map(f, "fields", input.fields,
             {.doc = "input of the FMU: field of the topic, or {from, scale, offset, from_unit, to_unit}",
              .required = true});
    if (input.from.topic.empty() || input.from.type.empty()) {
        f.error("", "an input needs a topic and its type", "{topic: NAME, type: TYPE, fields: {VARIABLE: FIELD}}");
    }
}

void describe_output(Fields& f, FmuOutput& output) {
    describe_topic(f, output.to);
    read_map(f, "fields", output.fields,
             {.doc = "field of the topic: variable of the FMU, or {from, value, scale, offset, from_unit, to_unit}"});
    f.reference("set_point", output.set_point,
                {.doc = "instead of a topic: the quantity that is set, kind.element.quantity"});
    f.reference("from", output.value.from, {.doc = "of a set-point: variable of the FMU"});
    f.number("scale", output.value.scale, {.doc = "of a set-point: factor, after the units have been converted"});
    f.number("offset", output.value.offset, {.doc = "of a set-point: added then"});
    f.number("valid_for_s", output.valid_for_s,
             {.doc = "of a set-point: how long it stands without a newer one; 0: as the control says", .min = 0});
    bool const steers = !output.set_point.empty(), writes = !output.to.topic.empty();
    if (steers == writes) {
        f.error(
            "", steers ? "a topic and a set-point at once" : "an output needs a topic or a set-point",
            "{topic: NAME, type: TYPE, fields: {FIELD: VARIABLE}} or {set_point: battery.BAT1.p_kw, from: VARIABLE}");
    } else if (steers && output.value.from.empty()) {
        f.error("", fmt::format("set-point '{}' has no `from`", output.set_point.name),
                "the variable that gives its value");
    } else if (writes && (output.to.type.empty() || output.fields.is_null())) {
        f.error("", fmt::format("topic '{}' needs its type and fields", output.to.topic.name),
                "{topic: NAME, type: TYPE, fields: {FIELD: VARIABLE}}");
    }
}

} // namespace

void describe(Fields& f, FmuConfig& config) {
    using OnRestart = FmuConfig::OnRestart;
    f.file("fmu", config.fmu,
           {.doc = "the FMU: FMI 2.0 or 3.0, for co-simulation. Its code is run: as a program", .required = true});
    config.fmu_at = f.where("fmu");
    f.fraction("period_s", config.period_s, {.doc = "its communication step", .required = true, .above = 0});
    f.fraction("latency_us", config.latency_us,
               {.doc = "from a communication point to its outputs, in lockstep", .min = 0});
    read_map(f, "start", config.start, {.doc = "values of parameters and inputs before it starts: {NAME: VALUE}"});
    f.number("tolerance", config.tolerance,
             {.doc = "relative tolerance of its solver; its own when not given", .above = 0});
    f.map("inputs", {.doc = "where its inputs come from"}, [&](config::Ref const& name, Fields& one) {
        FmuInput input;
        input.name = name;
        describe_input(one, input);
        config.inputs.push_back(std::move(input));
    });
    f.map("outputs", {.doc = "what is written at each communication point"}, [&](config::Ref const& name, Fields& one) {
        FmuOutput output;
        output.name = name;
        describe_output(one, output);
        config.outputs.push_back(std::move(output));
    });
    f.references("watch", config.watch, {.doc = "variables that are published as signals, agent.PROCESS.VARIABLE"});
    f.choice<OnRestart>(
        "on_restart", config.on_restart, {{"start", OnRestart::start}, {"resume", OnRestart::resume}},
        {.doc = "restarted by an event it begins anew, or with the state of its last communication point"});
    config.on_restart_at = f.where("on_restart");
}

} // namespace gridspace::agents
