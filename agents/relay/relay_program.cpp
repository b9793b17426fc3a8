// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/relay_program.hpp"

namespace gridspace::relay {

void describe(config::Fields& f, RelayConfig& config) {
    using Output = RelayConfig::TripOutput;
    f.object("currents", {.doc = "streams of the two ends of the line", .required = true}, [&](config::Fields& c) {
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

} // namespace gridspace::relay
