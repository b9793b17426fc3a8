// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_declaration.hpp"

#include "agents/relay/functions/function_config.hpp"

#include <fmt/format.h>

namespace gridspace::relay {
namespace {

using gateways::add;
using program::Signal;

void append(std::vector<Signal>& out, std::string const& prefix, std::initializer_list<char const*> names,
            std::string const& unit = "", double rate_hz = 0) {
    for (char const* name : names) {
        out.push_back({prefix + name, unit, rate_hz});
    }
}

/// The functions of a bay, whatever it is fed with; mistakes in them are reported where the relay is checked.
std::vector<Signal> measured_by(BayConfig const& bay) {
    FunctionContext any;
    any.inputs = kCurrents | kVoltages | kBusVoltages;
    config::Diagnostics said;
    auto const set = make_functions(bay.functions, any, said);
    return set ? measured_signals(*set) : std::vector<Signal>{};
}

/// Of the message that trips; how long its frame takes is computed by the report.
std::vector<Signal> trip_signals(Ref const& stream) {
    std::string const prefix = "stream." + stream.name + ".";
    return {{prefix + "st_num", ""},
            {prefix + "sq_num", ""},
            {prefix + "interval_ms", "ms"},
            {prefix + "wire_delay_ms", "ms"}};
}

/// What the report makes of the verdicts, and how long the detector takes.
void add_detector_scores(RelayConfig const& config, std::vector<Signal>& out) {
    std::string const prefix = "ids.{process}.";
    if (!config.ids->verdicts.empty()) {
        for (Ref const* stream : {&config.from_stream, &config.to_stream}) {
            append(out, prefix + stream->name + ".", {"false_positive_percent", "open_loop_false_positive_percent"},
                   "%");
        }
        append(out, prefix,
               {"false_trips", "false_trips_without", "real_faults", "real_faults_tripped", "false_alarms"});
        append(out, prefix, {"real_fault_trip_added_ms"}, "ms");
    }
    append(out, prefix, {"time_us_p50", "time_us_p99", "time_us_max"}, "us");
}

std::vector<Signal> signals_of(RelayConfig const& config, gateways::DeclarationContext const& context) {
    std::vector<Signal> out = state_signals();
    std::vector<gateways::GuardedStream> guarded;
    for (Ref const& stream : config.inputs()) {
        guarded.push_back(gateways::guarded(context, stream.name, true));
        add(out, received_signals(stream, true));
        out.push_back(arrival_age(stream));
    }
    std::vector<std::string> functions;
    for (config::Node::Entry const& function : config.bay.functions.entries) {
        functions.push_back(function.key);
    }
    add(out, function_signals(functions));
    add(out, config.is_of_bay() ? measured_by(config.bay) : std::vector<Signal>{});
    add(out, config.logic.publish_values ? element_signals() : std::vector<Signal>{});
    out.push_back(decision_age());
    add(out, trip_signals(config.trip));
    add(out, first_line_signals(config.first_line, guarded));
    if (config.ids) {
        add(out, detector_state_signals(config));
        add(out, detector_counter_signals(config));
        add_detector_scores(config, out);
    }
    return out;
}

} // namespace

std::vector<Signal> state_signals() {
    std::vector<Signal> out;
    append(out, "relay.{process}.", {"pickup", "trip", "blocked"});
    append(out, "relay.{process}.", {"sample_s"}, "s");
    return out;
}

std::vector<Signal> received_signals(Ref const& stream, bool real_time) {
    std::string const prefix = "stream." + stream.name + ".";
    std::vector<Signal> out;
    append(out, prefix, {"received", "lost", "duplicate", "late", "invalid", "silences"}, "", 1);
    if (real_time) { // says nothing where nobody looks at a clock
        append(out, prefix, {"rate_hz"}, "Hz", 1);
    }
    return out;
}

Signal arrival_age(Ref const& stream) {
    return {"stream." + stream.name + ".arrival_age_ms", "ms"};
}

Signal decision_age() {
    return {"relay.{process}.sample_to_decision_ms", "ms"};
}

std::vector<Signal> element_signals() {
    std::vector<Signal> out;
    for (char const* quantity : {"differential_a", "restraint_a", "operate_at_a"}) {
        append(out, fmt::format("relay.{{process}}.{}.", quantity), {"a", "b", "c"}, "A");
    }
    return out;
}

std::vector<Signal> function_signals(std::vector<std::string> const& functions) {
    std::vector<Signal> out;
    for (std::string const& function : functions) {
        append(out, "relay.{process}." + function, {".str", ".op"});
    }
    return out;
}

std::vector<Signal> measured_signals(FunctionSet const& functions) {
    std::vector<Signal> out;
    for (NamedFunction const& f : functions.functions()) {
        for (MeasuredQuantity const& q : f.publishes ? f.function->quantities() : std::span<MeasuredQuantity const>{}) {
            out.push_back({fmt::format("relay.{{process}}.{}.{}", f.name, q.name), std::string{q.unit}});
        }
    }
    return out;
}

std::vector<Signal> detector_state_signals(RelayConfig const& config) {
    std::vector<Signal> out;
    append(out, "ids.{process}.", {"alarm", "alarm_reasons", "granted"});
    for (Ref const* stream : {&config.from_stream, &config.to_stream}) {
        append(out, "ids.{process}." + stream->name, {".locked_out"});
    }
    return out;
}

std::vector<Signal> detector_counter_signals(RelayConfig const& config) {
    std::vector<Signal> out{{"ids.{process}.alarms", "", 1}};
    for (Ref const* stream : {&config.from_stream, &config.to_stream}) {
        for (char const* name : kIdsCounters) {
            out.push_back({"ids.{process}." + stream->name + "." + name, "", 1});
        }
        out.push_back({"ids.{process}." + stream->name + ".sigma_percent", "%", 1});
    }
    return out;
}

program::Declaration declaration(RelayConfig const& config, gateways::DeclarationContext const& context) {
    program::Declaration out{
        .name = "gridspace-relay",
        .description =
            "protection relay: a line differential, or functions of a bay; sampled values in, a trip by GOOSE out",
        .role = "relay",
        .settings = config::keys_of<RelayConfig>(),
        .latency = "latency_us",
        .promises_latency = true};
    for (Ref const& stream : config.inputs()) {
        out.reads.push_back({.topic = stream.name, .is_stream = true});
    }
    if (config.foreign_detector) {
        out.reads.push_back({.topic = config.foreign_detector->verdicts, .type = "IdsVerdict"});
    }
    out.writes.push_back({.topic = config.trip.name, .is_stream = true});
    if (config.ids && !config.ids->verdicts.empty()) {
        out.writes.push_back({.topic = config.ids->verdicts, .type = "IdsVerdict"});
    }
    out.writes.push_back(gateways::stream_statistics());
    out.signals = signals_of(config, context);
    return out;
}

program::Declaration relay_declaration() {
    RelayConfig config;
    config.from_stream.name = "{currents.from}";
    config.to_stream.name = "{currents.to}";
    config.trip.name = "{trip}";
    config.logic.publish_values = true;
    config.ids.emplace().verdicts = "{ids.verdicts}";
    return declaration(config, {});
}

} // namespace gridspace::relay
