// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/breaker/breaker_declaration.hpp"

namespace gridspace::gateways {

std::vector<program::Signal> command_signals() {
    return {{"breaker_ied.{process}.command", ""},
            {"breaker_ied.{process}.stream_alive", ""},
            {"breaker_ied.{process}.commanded_after_ms", "ms"},
            {"breaker_ied.{process}.effect_ms", "ms"}};
}

program::Declaration declaration(BreakerConfig const& config, DeclarationContext const& context) {
    std::string const stream = config.stream().name;
    program::Declaration out{.name = "gridspace-breaker",
                             .description = "breaker IED: the trip of a GOOSE stream becomes a command",
                             .role = "breaker",
                             .settings = config::keys_of<BreakerConfig>(),
                             .latency = "latency_us",
                             .works_ahead = true};
    out.reads = {{.topic = stream, .is_stream = true}};
    out.writes = {{.topic = config.to.name, .type = "TripCommand"}, stream_statistics()};
    out.signals = command_signals();
    add(out.signals, first_line_signals(config.first_line, {guarded(context, stream, false)}));
    return out;
}

program::Declaration breaker_declaration() {
    BreakerConfig config;
    config.from.name = "{from}";
    config.to.name = "{to}";
    return declaration(config, {});
}

} // namespace gridspace::gateways
