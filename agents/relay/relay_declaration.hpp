// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/relay_program.hpp"
#include "gateways/port/declared_signals.hpp"

namespace gridspace::relay {

// Its groups of signals, each in the order of its columns. "{process}" stands for the relay.
[[nodiscard]] std::vector<program::Signal> state_signals();
/// Counters of a received stream; how often frames come only in real time.
[[nodiscard]] std::vector<program::Signal> received_signals(Ref const& stream, bool real_time);
[[nodiscard]] program::Signal arrival_age(Ref const& stream);
[[nodiscard]] program::Signal decision_age();
/// Of the differential element (`publish_values`).
[[nodiscard]] std::vector<program::Signal> element_signals();
/// Of functions by their names: picked up, tripped.
[[nodiscard]] std::vector<program::Signal> function_signals(std::vector<std::string> const& functions);
/// Of functions that are asked to publish what they measure.
[[nodiscard]] std::vector<program::Signal> measured_signals(FunctionSet const& functions);
[[nodiscard]] std::vector<program::Signal> detector_state_signals(RelayConfig const& config);
[[nodiscard]] std::vector<program::Signal> detector_counter_signals(RelayConfig const& config);

/// What a relay with these settings hears, sends and publishes.
[[nodiscard]] program::Declaration declaration(RelayConfig const& config, gateways::DeclarationContext const& context);
/// Of the relay of a line, with names of settings in the place of their values.
[[nodiscard]] program::Declaration relay_declaration();

} // namespace gridspace::relay
