// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_program.hpp"

#include "common/text.hpp"

#include <algorithm>

namespace gridspace::relay {
namespace {

void describe(config::Fields& f, BayConfig& bay, double& partner_timeout_ms) {
    f.object(
        "inputs", {.doc = "with `functions`: streams of the bay, at most two different ones"}, [&](config::Fields& i) {
            i.reference("currents", bay.currents, {.doc = "stream with the currents"});
            i.reference("voltages", bay.voltages, {.doc = "stream with the voltages to earth, on the line's side"});
            i.reference("bus_voltages", bay.bus_voltages, {.doc = "stream with those of the bus, for a synchrocheck"});
            i.number("partner_timeout_ms", partner_timeout_ms,
                     {.doc = "how long a sample of one stream waits for that of the other", .max = 1000, .above = 0});
            auto const members = [&](char const* key, std::array<std::string, 3>& names, std::string_view doc) {
                i.object(key, {.doc = doc}, [&](config::Fields& m) {
                    m.text("a", names[0], {.doc = "member of the data set for phase a"});
                    m.text("b", names[1], {.doc = "member for phase b"});
                    m.text("c", names[2], {.doc = "member for phase c"});
                });
            };
            members("current_members", bay.current_members, "members with the currents; Ia, Ib, Ic when not given");
            members("voltage_members", bay.voltage_members, "members with the voltages; Va, Vb, Vc when not given");
            i.number("offset_cycles", bay.offset_cycles,
                     {.doc = "time constant of the decaying offset that is taken out of the currents; 0: none",
                      .min = 0,
                      .max = 20});
            i.number("minimum_v", bay.minimum_v,
                     {.doc = "positive sequence to earth below which neither frequency nor direction is measured",
                      .min = 0});
            i.number("hold_ms", bay.hold_ms,
                     {.doc = "how long the voltage before a collapse gives direction", .min = 0});
            i.flag(
                "reversed", bay.reversed,
                {.doc =
                     "currents are counted out of what is protected; from the network's transformer when not given"});
        });
    f.raw("functions", bay.functions,
          {.doc = "protection functions of a bay by name, instead of `currents` and `element`: "
                  "docs/reference/relay_functions.md"});
    config::Node outputs;
    f.raw(
        "outputs", outputs,
        {.doc = "with `functions`: further Boolean members of the trip stream, and what they say: {backup: RBRF1.op}"});
    for (config::Node::Entry const& entry : outputs.entries) {
        bay.outputs.emplace_back(entry.key, Ref{entry.value.text, entry.where});
    }
    if (!outputs.is_null() && !outputs.is_map()) {
        f.error("outputs", "expected a map from members to functions", "{backup: RBRF1.op}");
    }
    bool const is_bay = !bay.functions.is_null();
    if (is_bay && bay.currents.empty() && bay.voltages.empty()) {
        f.error("functions", "functions of what?", "inputs: {currents: STREAM, voltages: STREAM}");
    }
    for (char const* key : {"currents", "element", "ids", "foreign_detector", "event_report", "positive"}) {
        if (is_bay && f.has(key)) {
            f.error(key, "it belongs to the differential of a line, and this relay has `functions`",
                    "a relay has one or the other; both are two processes");
        }
    }
}

void describe(config::Fields& f, ForeignDetectorConfig& c) {
    using OnFlagged = ForeignDetectorConfig::OnFlagged;
    using Unheard = ForeignDetectorConfig::Unheard;
    f.text("verdicts", c.verdicts, {.doc = "DDS topic of its verdicts (IdsVerdict) on both streams", .required = true});
    f.number("wait_ms", c.wait_ms, {.doc = "how long a pickup waits for the verdict on it", .min = 0, .max = 1000});
    f.number("hold_ms", c.hold_ms,
             {.doc = "how long before the pickup a flagged sample counts", .max = 10000, .above = 0});
    f.choice<OnFlagged>("on_flagged", c.on_flagged, {{"delay", OnFlagged::delay}, {"block", OnFlagged::block}},
                        {.doc = "a pickup while a sample is flagged trips after delay_ms, or never"});
    f.number("delay_ms", c.delay_ms, {.doc = "how long such a pickup has to last", .min = 0, .max = 1000});
    f.choice<Unheard>("unheard", c.unheard, {{"trip", Unheard::trip}, {"block", Unheard::block}},
                      {.doc = "a pickup on which no verdict has come after wait_ms"});
}

} // namespace

std::vector<Ref> RelayConfig::inputs() const {
    std::vector<Ref> out;
    for (Ref const* stream : is_of_bay() ? std::vector{&bay.currents, &bay.voltages, &bay.bus_voltages}
                                         : std::vector{&from_stream, &to_stream}) {
        if (!stream->empty() && (!is_of_bay() || std::find(out.begin(), out.end(), *stream) == out.end())) {
            out.push_back(*stream);
        }
    }
    return out;
}

void describe(config::Fields& f, RelayConfig& config) {
    using Output = RelayConfig::TripOutput;
    describe(f, config.bay, config.partner_timeout_ms);
    if (!config.is_of_bay() && !f.has("currents")) {
        f.error("", "the relay has neither `currents` nor `functions`",
                "currents: {from: STREAM, to: STREAM} of a line, or functions: {PTOC1: …} of a bay");
    } else if (!config.is_of_bay() && !f.has("element")) {
        f.error("", "the relay has no `element`", "element: {pickup_a: …}, the differential element");
    }
    f.object("currents", {.doc = "streams of the two ends of the line"}, [&](config::Fields& c) {
        c.reference("from", config.from_stream, {.doc = "stream of the line's `from` end", .required = true});
        c.reference("to", config.to_stream, {.doc = "stream of the line's `to` end", .required = true});
        c.text("a", config.channels[0], {.doc = "member of the data set for phase a"});
        c.text("b", config.channels[1], {.doc = "member for phase b"});
        c.text("c", config.channels[2], {.doc = "member for phase c"});
        c.number("partner_timeout_ms", config.partner_timeout_ms,
                 {.doc = "how long a sample waits for its partner", .max = 1000, .above = 0});
    });
    f.reference("trip", config.trip, {.doc = "GOOSE stream of its trip", .required = true});
    f.text("trip_field", config.trip_field, {.doc = "Boolean member of the data set that says trip"});
    f.choice<Output>("trip_output", config.trip_output, {{"enabled", Output::enabled}, {"blocked", Output::blocked}},
                     {.doc = "blocked: it decides and records, and sends no trip"});
    describe(f, config.logic);
    describe(f, config.first_line);
    describe(f, config.event_report);
    f.object("ids", {.doc = "intrusion detector in front of the relay"},
             [&](config::Fields& d) { describe(d, config.ids.emplace()); });
    f.object("foreign_detector",
             {.doc = "somebody else's detector, a process of its own: its verdicts permit the trip"},
             [&](config::Fields& d) {
                 describe(d, config.foreign_detector.emplace());
                 if (config.ids) {
                     d.error("", "the relay has `ids` and `foreign_detector`", "one detector permits its trip");
                 }
             });
    f.fraction("latency_us", config.latency_us,
               {.doc = "from a frame to the message; in real time the message is held back until then", .min = 0});
    f.number("frequency_hz", config.frequency_hz,
             {.doc = "nominal frequency; from the network when not given", .above = 0});
    auto const polarity = {std::pair<std::string_view, Positive>{"from_to", Positive::from_to},
                           {"into_line", Positive::into_line}};
    f.object("positive",
             {.doc = "direction that each end counts positive; from the network's transformers when not given"},
             [&](config::Fields& p) {
                 p.choice<Positive>("from", config.from_positive, polarity, {.doc = "the `from` end"});
                 p.choice<Positive>("to", config.to_positive, polarity, {.doc = "the `to` end"});
             });
}

Result<BayParams> make_bay_params(RelayConfig const& config, Rational rate_hz) {
    auto const cycle = whole_samples(rate_hz, Rational::parse(shortest(config.frequency_hz)).value_or(Rational{60}), 1);
    if (!cycle) {
        return std::unexpected{cycle.error()};
    }
    BayConfig const& bay = config.bay;
    BayParams out;
    out.rate_hz = rate_hz.to_double();
    out.frequency_hz = config.frequency_hz;
    out.samples_per_cycle = *cycle;
    out.offset_cycles = bay.offset_cycles;
    out.minimum_v = bay.minimum_v;
    out.hold_s = bay.hold_ms / 1e3;
    out.reversed = bay.reversed;
    out.seal_in = config.logic.seal_in == RelayLogicConfig::SealIn::until_reset;
    out.max_interpolated = static_cast<int>(config.logic.max_interpolated);
    out.inputs = static_cast<std::uint8_t>((bay.currents.empty() ? 0U : unsigned{kCurrents}) |
                                           (bay.voltages.empty() ? 0U : unsigned{kVoltages}) |
                                           (bay.bus_voltages.empty() ? 0U : unsigned{kBusVoltages}));
    return out;
}

} // namespace gridspace::relay
