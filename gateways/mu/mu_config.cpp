// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mu/mu_config.hpp"

namespace gridspace::gateways {

void describe(config::Fields& f, MuConfig& config) {
    using Sending = MuConfig::Sending;
    f.reference("from", config.from, {.doc = "DDS topic of sampled line currents", .required = true});
    f.reference("to", config.to, {.doc = "the stream that it sends", .required = true});
    f.object("channels", {.doc = "members of the data set that get the phase currents"}, [&](config::Fields& c) {
        c.text("a", config.channels[0], {.doc = "member for phase a"});
        c.text("b", config.channels[1], {.doc = "member for phase b"});
        c.text("c", config.channels[2], {.doc = "member for phase c"});
    });
    f.object("voltages", {.doc = "members that get the phase voltages: `from` is then the topic of a bay, with a `vt`"},
             [&](config::Fields& v) {
                 std::array<std::string, 3>& members =
                     config.voltages.emplace(std::array<std::string, 3>{"Va", "Vb", "Vc"});
                 v.text("a", members[0], {.doc = "member for phase a"});
                 v.text("b", members[1], {.doc = "member for phase b"});
                 v.text("c", members[2], {.doc = "member for phase c"});
             });
    f.choice<Sending>("sending", config.sending,
                      {{"scheduled", Sending::scheduled}, {"on_arrival", Sending::on_arrival}},
                      {.doc = "real time: at the exact sample rate behind a small buffer, or as soon as samples come"});
    f.number("buffer_ms", config.buffer_ms,
             {.doc = "real time, scheduled: how much later than the samples it sends", .min = 0, .max = 100});
    ptp::describe_ptp(f, config.ptp);
    f.fraction("latency_us", config.latency_us, {.doc = "lockstep: from the sample to the frame", .min = 0});
}

} // namespace gridspace::gateways
