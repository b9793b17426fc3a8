// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/port/declared_signals.hpp"
#include "launcher/scenario/program.hpp"

#include <memory>

namespace gridspace::sim {
struct Ct;
}

namespace gridspace::launcher {

// Programs that exchange raw frames: what the launcher has to know about them.
[[nodiscard]] std::unique_ptr<ProcessSettings> read_merging_unit(config::Fields& f);
[[nodiscard]] std::unique_ptr<ProcessSettings> read_breaker(config::Fields& f);
[[nodiscard]] std::unique_ptr<ProcessSettings> read_attacker(config::Fields& f);
[[nodiscard]] std::unique_ptr<ProcessSettings> read_relay(config::Fields& f);
[[nodiscard]] std::unique_ptr<ProcessSettings> read_link(config::Fields& f);
[[nodiscard]] std::unique_ptr<ProcessSettings> read_gateway(config::Fields& f);

/// A model of another tool.
[[nodiscard]] std::unique_ptr<ProcessSettings> read_fmu(config::Fields& f);

/// The transformer behind a stream: stream <- merging unit <- topic <- transformer. Null when the stream comes from
/// somebody else's device.
[[nodiscard]] sim::Ct const* transformer_behind(Scenario const& s, config::Ref const& stream);

/// The topics on which signals are published.
void add_signals(std::vector<TopicUse>& topics);

/// What the declarations of programs with raw frames follow from, besides their settings.
[[nodiscard]] gateways::DeclarationContext context_of(Scenario const& s);

/// Own keys, the port, and the declarations of the streams that the process uses.
[[nodiscard]] config::Node wire_process_settings(Scenario const& s, Process const& process,
                                                 std::vector<std::string> const& used);

} // namespace gridspace::launcher
