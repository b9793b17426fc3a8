// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_parts.hpp"

#include "agents/relay/functions/function_config.hpp"
#include "common/text.hpp"
#include "ids/forecaster/model_file.hpp"

#include <array>
#include <cstdlib>
#include <fmt/format.h>

namespace gridspace::relay {
namespace {

using gateways::WireClock;
using gateways::WirePort;

struct Streams {
    streams::Stream const *from, *to, *trip; ///< of a bay with one stream, `from` and `to` are the same
};

Result<Streams> find_streams(RelaySettings const& settings) {
    config::Diagnostics diagnostics;
    auto const find = [&](config::Ref const& name, streams::Kind kind) {
        return gateways::stream_of(settings.wire.streams, name, kind, diagnostics);
    };
    RelayConfig const& config = settings.relay;
    std::vector<config::Ref> const inputs = config.inputs();
    if (inputs.empty() || inputs.size() > 2) {
        return fail(ExitCode::usage, fmt::format("the relay hears {} streams", inputs.size()),
                    "one or two are possible");
    }
    Streams const out{find(inputs.front(), streams::Kind::smv), find(inputs.back(), streams::Kind::smv),
                      find(config.trip, streams::Kind::goose)};
    return diagnostics.ok() && out.from != nullptr && out.to != nullptr && out.trip != nullptr
               ? Result<Streams>{out}
               : fail(ExitCode::usage, diagnostics.render());
}

Result<void> make_bay(RelayConfig const& config, Rational rate_hz, RelayParts& out) {
    auto const params = make_bay_params(config, rate_hz);
    if (!params) {
        return std::unexpected{params.error()};
    }
    config::Diagnostics diagnostics;
    auto set =
        make_functions(config.bay.functions,
                       {params->rate_hz, params->frequency_hz, params->samples_per_cycle, params->inputs}, diagnostics);
    if (!set) {
        return fail(ExitCode::usage, diagnostics.render());
    }
    std::vector<config::Ref> const inputs = config.inputs();
    auto const source = [&](config::Ref const& stream) {
        return stream.empty() ? std::nullopt : std::optional{BaySource{stream == inputs.front() ? 0U : 1U}};
    };
    out.sources = {source(config.bay.currents), source(config.bay.voltages), source(config.bay.bus_voltages)};
    out.bay = std::make_unique<BayRelay>(*params, std::move(*set));
    return {};
}

Result<void> make_relay(RelaySettings const& settings, Rational rate_hz, DaemonRun& run, bus::Node& node,
                        RelayParts& out) {
    RelayConfig const& config = settings.relay;
    if (config.is_of_bay()) {
        return make_bay(config, rate_hz, out);
    }
    auto params =
        make_params(config.logic, rate_hz, Rational::parse(shortest(config.frequency_hz)).value_or(Rational{60}));
    if (!params) {
        return std::unexpected{params.error()};
    }
    params->from_positive = config.from_positive;
    params->to_positive = config.to_positive;
    if (!config.ids) {
        out.relay = std::make_unique<GuardedRelay>(*params);
        if (config.foreign_detector) {
            auto foreign = ForeignDetector::create(node, config, rate_hz.to_double());
            if (!foreign) {
                return std::unexpected{foreign.error()};
            }
            out.foreign = std::move(*foreign);
        }
        return {};
    }
    auto const model = ids::load_model(config.ids->model);
    if (!model) {
        return std::unexpected{model.error()};
    }
    auto const detector = ids::make_detector_params(*config.ids, *model, rate_hz.to_double(), config.frequency_hz);
    if (!detector) {
        return std::unexpected{detector.error()};
    }
    out.relay = std::make_unique<GuardedRelay>(*params, *model, *detector);
    auto output = IntrusionOutput::create(node, run, config, rate_hz);
    if (!output) {
        return std::unexpected{output.error()};
    }
    out.intrusion = std::move(*output);
    return {};
}

/// What is read of the streams.
std::array<CurrentInputs::Members, 2> members_of(RelayConfig const& config) {
    std::array<CurrentInputs::Members, 2> out;
    if (!config.is_of_bay()) {
        out[0].currents = out[1].currents = config.channels;
        return out;
    }
    std::vector<config::Ref> const inputs = config.inputs();
    for (std::size_t end = 0; end < inputs.size(); ++end) {
        if (inputs[end] == config.bay.currents) {
            out[end].currents = config.bay.current_members;
        }
        if (inputs[end] == config.bay.voltages || inputs[end] == config.bay.bus_voltages) {
            out[end].voltages = config.bay.voltage_members;
        }
    }
    return out;
}

Result<void> make_inputs(RelaySettings const& settings, Streams const& streams, bool simulated, RelayParts& out) {
    RelayConfig const& config = settings.relay;
    auto inputs = CurrentInputs::create(*streams.from, *streams.to,
                                        {members_of(config), static_cast<std::int64_t>(config.partner_timeout_ms * 1e6),
                                         static_cast<int>(config.logic.max_interpolated), config.first_line,
                                         config.logic.test_mode, !simulated, settings.wire.speed});
    if (!inputs) {
        return std::unexpected{inputs.error()};
    }
    out.inputs = std::make_unique<CurrentInputs>(std::move(*inputs));
    return {};
}

/// Into the folder of the run; a relay without a run, on a board of its own, needs a path.
void make_event_report(RelayConfig const& relay, std::string const& process, RelayParts& out) {
    EventReportConfig config = relay.event_report;
    char const* run = std::getenv("GRIDSPACE_RUN_FOLDER");
    if (config.folder.empty() && run != nullptr) {
        config.folder = std::filesystem::path{run} / "event_reports";
    }
    if (config.trigger != EventReportConfig::Trigger::off && !config.folder.empty() && !relay.is_of_bay()) {
        out.event_report = std::make_unique<EventReport>(
            config,
            EventReportFacts{process, relay.from_stream.name, relay.to_stream.name, out.rate_hz, relay.frequency_hz});
    }
}

Result<void> open_wire(RelaySettings const& settings, Streams const& streams, bus::Node& node, RelayParts& out) {
    auto port = WirePort::open(node, settings.wire, {{streams.trip->ethertype()}, {streams.from->ethertype()}});
    if (!port) {
        return std::unexpected{port.error()};
    }
    out.port = std::move(*port);
    std::vector<std::string> fields{settings.relay.trip_field};
    for (auto const& output : settings.relay.bay.outputs) {
        fields.push_back(output.first);
    }
    auto publisher = TripPublisher::create(node, *out.port, *streams.trip, fields);
    if (!publisher) {
        return std::unexpected{publisher.error()};
    }
    out.trip = std::move(*publisher);
    return {};
}

Result<void> open_first_line(RelayConfig const& config, DaemonRun& run, bus::Node& node, RelayParts& out) {
    if (config.first_line.on_finding == gateways::FirstLineConfig::OnFinding::ignore) {
        return {};
    }
    std::vector<gateways::FirstLineReport::Stream> streams;
    std::vector<config::Ref> const names = config.inputs();
    for (std::size_t i = 0; i < names.size(); ++i) {
        gateways::SvFirstLine const& rules = out.inputs->end(i).first_line;
        streams.push_back({names[i].name, streams::Kind::smv, [&rules] { return rules.counters(); },
                           [&rules] { return rules.refused(); }, [&rules] { return rules.contested(); }});
    }
    auto report = gateways::FirstLineReport::create(node, run, std::move(streams), out.port->authentication());
    if (!report) {
        return std::unexpected{report.error()};
    }
    out.first_line = std::move(*report);
    return {};
}

} // namespace

Result<RelayParts> make_parts(RelaySettings const& settings, DaemonRun& run, bus::Node& node) {
    auto const streams = find_streams(settings);
    if (!streams) {
        return std::unexpected{streams.error()};
    }
    RelayParts out;
    out.rate_hz = streams->from->rate_hz.to_double();
    if (auto ok = make_relay(settings, streams->from->rate_hz, run, node, out); !ok) {
        return std::unexpected{ok.error()};
    }
    if (auto ok = make_inputs(settings, *streams, WireClock{node}.simulated(), out); !ok) {
        return std::unexpected{ok.error()};
    }
    make_event_report(settings.relay, node.config().process, out);
    if (auto ok = open_wire(settings, *streams, node, out); !ok) {
        return std::unexpected{ok.error()};
    }
    auto signals = RelaySignals::create(node, settings.relay, out.rate_hz);
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    out.signals = std::move(*signals);
    if (auto ok = open_first_line(settings.relay, run, node, out); !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

} // namespace gridspace::relay
