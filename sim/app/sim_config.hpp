// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/member_plan.hpp"
#include "common/config/fields.hpp"
#include "sim/events/event.hpp"
#include "sim/solvers/engine_settings.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::sim {

/// `simulation:` of a scenario.
struct SimulationConfig : EngineSettings {
    std::filesystem::path network;
    config::SourceMark network_mark;
    config::Node network_changes; ///< laid over the network file
    std::optional<Rational> duration_s, duration_h;
    config::Node gateways; ///< `per_bus`, or a map of line gateways
    config::Node sampling;
    config::Node controls;                   ///< who may steer what
    [[nodiscard]] Rational duration() const; ///< seconds
};
void describe(config::Fields& f, SimulationConfig& simulation);

/// A signal that jumps: published when it changes, at the step in which it does; everything else is published at a
/// rate.
[[nodiscard]] bool is_switching_signal(std::string_view name);

/// How often the other signals are published: every step of the phasor solver; at the rate of the sampled values with
/// waveforms.
[[nodiscard]] Rational signal_rate_hz(SimulationConfig const& simulation);

/// Settings of gridspace-sim; written by `gridspace run` from the scenario.
struct SimConfig {
    SimulationConfig simulation;
    double speed{0};                 ///< simulated seconds per second; 0: as fast as it goes
    bool start_on_utc_second{false}; ///< real time: simulated time 0 is a whole second of UTC
    std::vector<Event> events;
    std::vector<bus::MemberPlan> members;
    std::vector<Rational> holds_s;         ///< the launcher has to act when these instants have been acknowledged
    std::vector<std::string> signals{"*"}; ///< which signals are published
};
void describe(config::Fields& f, SimConfig& config);

} // namespace gridspace::sim
