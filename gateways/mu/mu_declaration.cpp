// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mu/mu_declaration.hpp"

namespace gridspace::gateways {

program::Declaration declaration(MuConfig const& config, DeclarationContext const& context) {
    program::Declaration out{.name = "gridspace-mu",
                             .description = "merging unit: sampled line currents onto the process bus",
                             .role = "merging_unit",
                             .settings = config::keys_of<MuConfig>(),
                             .latency = "latency_us",
                             .promises_latency = true};
    out.reads = {{.topic = config.from.name, .type = config.type(), .triggers = true}};
    out.writes = {{.topic = config.to.name, .is_stream = true}, stream_statistics()};
    out.signals = publisher_signals();
    add(out.signals, sent_sample_signals(config.to.name));
    add(out.signals, clock_signals(config.ptp, context));
    return out;
}

program::Declaration mu_declaration() {
    MuConfig config;
    config.from.name = "{from}";
    config.to.name = "{to}";
    config.ptp.emplace();
    return declaration(config, {});
}

} // namespace gridspace::gateways
