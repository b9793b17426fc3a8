// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "gateways/gateway/gateway_config.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace gridspace::agents {

/// Inputs of the FMU that are taken from a topic.
struct FmuInput {
    config::Ref name;
    gateways::MappingEnd from;
    config::Node fields; ///< variable: field of the topic, as a gateway's
};

/// What is written at each communication point: a sample of a topic, or a set-point.
struct FmuOutput {
    config::Ref name;
    gateways::MappingEnd to;
    config::Node fields;   ///< field of the topic: variable
    config::Ref set_point; ///< "battery.BAT1.p_kw"; then `to` and `fields` are empty
    gateways::FieldRule value;
    double valid_for_s{0};
};

/// gridspace-fmu: a model of somebody else as an agent.
struct FmuConfig {
    std::filesystem::path fmu;
    config::SourceMark fmu_at;
    Rational period_s{1};
    Rational latency_us{0};
    config::Node start; ///< variable: value
    std::optional<double> tolerance;
    std::vector<FmuInput> inputs;
    std::vector<FmuOutput> outputs;
    std::vector<config::Ref> watch;
    enum class OnRestart { start, resume } on_restart{OnRestart::start};
    config::SourceMark on_restart_at;
};
void describe(config::Fields& f, FmuConfig& config);

} // namespace gridspace::agents
