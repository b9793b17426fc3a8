// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/fmu_declaration.hpp"

namespace gridspace::agents {
program::Declaration fmu_declaration() {
    return {.name = "gridspace-fmu",
            .description = "a model of another tool (FMU) as an agent",
            .settings = config::keys_of<FmuConfig>(),
            .whole_steps = {"period_s"},
            .latency = "latency_us"};
}

program::Declaration declaration(FmuConfig const& config, fmi::ModelDescription const& description,
                                 FmuTable const& table) {
    program::Declaration out = fmu_declaration();
    for (FmuInput const& input : config.inputs) {
        add_once(out.reads, {.topic = input.from.topic.name, .type = input.from.type.name});
    }
    for (FmuOutput const& output : config.outputs) {
        bool const steers = !output.set_point.empty();
        add_once(out.writes, {.topic = steers ? "set_points" : output.to.topic.name,
                              .type = steers ? "SetPoint" : output.to.type.name,
                              .optional = true});
    }
    for (std::size_t const at : table.watched) { // once a communication point
        fmi::Variable const& variable = description.variables[at];
        out.signals.push_back(
            {signal_name("{process}", variable.name), variable.unit.substr(0, 16), 1 / config.period_s.to_double()});
    }
    return out;
}

} // namespace gridspace::agents
