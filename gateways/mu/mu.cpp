// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-mu: a merging unit; sampled line currents from DDS onto the process bus as sampled values. A gateway with
// one mapping.
#include "gateways/gateway/gateway.hpp"
#include "gateways/mu/mu_declaration.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

using config::Node;

/// Rules for three members of the data set; an integer counts parts of `1 / scale`.
void add_phases(Node& fields, std::array<std::string, 3> const& members, std::array<char const*, 3> const& from,
                char const* scale, streams::Stream const* stream) {
    for (std::size_t phase = 0; phase < from.size(); ++phase) {
        Node rule = Node::map();
        rule.set("from", Node::quoted_text(from[phase]));
        for (iec61850::Leaf const& leaf :
             stream == nullptr ? std::vector<iec61850::Leaf>{} : iec61850::leaves_of(stream->data_set)) {
            if (leaf.name == members[phase] && iec61850::is_integer(leaf.type)) {
                rule.set("scale", Node::scalar(scale));
            }
        }
        fields.set(members[phase], std::move(rule));
    }
}

/// `fields:`: phases into the members that the configuration names; 9-2LE counts milliamperes and 10 mV.
Node fields_of(MuConfig const& mu, streams::Stream const* stream) {
    Node fields = Node::map();
    add_phases(fields, mu.channels, {"samples.ia", "samples.ib", "samples.ic"}, "1000", stream);
    if (mu.voltages) {
        add_phases(fields, *mu.voltages, {"samples.va", "samples.vb", "samples.vc"}, "100", stream);
    }
    return fields;
}

GatewayConfig table_of(MuConfig const& mu, std::vector<streams::Stream> const& streams) {
    MappingConfig mapping;
    mapping.name = mu.to;
    mapping.from.topic = mu.from;
    mapping.from.type.name = mu.type();
    mapping.to.stream = mu.to;
    mapping.each.name = "samples";
    mapping.index.name = "first_index";
    mapping.fields = fields_of(mu, streams::find_stream(streams, mu.to.name));
    mapping.sending = mu.sending == MuConfig::Sending::scheduled ? MappingConfig::Sending::scheduled
                                                                 : MappingConfig::Sending::on_arrival;
    mapping.buffer_ms = mu.buffer_ms;
    GatewayConfig out;
    out.mappings.push_back(std::move(mapping));
    out.latency_us = mu.latency_us;
    out.ptp = mu.ptp;
    return out;
}

void describe_clock_changes(config::Fields& f, std::vector<ClockChange>& changes) {
    f.list(
        "clock_changes", {.doc = "what events do to its clock; filled in by `gridspace run`"}, [&](config::Fields& c) {
            ClockChange change;
            c.fraction("at_s", change.at_s, {.doc = "simulated time", .required = true, .min = 0});
            c.flag("synchronised", change.synchronised, {.doc = "false: smpSynch is 0 from then on"});
            c.integer("shift_samples", change.shift_samples, {.doc = "how far the counter runs ahead of the samples"});
            changes.push_back(change);
        });
}

} // namespace
} // namespace gridspace::gateways

int main(int argc, char** argv) {
    using namespace gridspace::gateways;
    GatewaySettings settings;
    MuConfig mu;
    std::vector<ClockChange> clock_changes;
    GatewayProgram const program{mu_declaration,
                                 [&](gridspace::config::Fields& f) {
                                     describe(f, mu);
                                     describe_clock_changes(f, clock_changes);
                                 },
                                 [&](GatewaySettings& s, gridspace::bus::NodeConfig const&) {
                                     s.gateway = table_of(mu, s.wire.streams);
                                     s.gateway.mappings.front().clock_changes = clock_changes;
                                 },
                                 {}};
    return run_gateway(program, settings, argc, argv);
}
