// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/app/sim_config.hpp"

#include "sim/gateway/gateway_config.hpp"

namespace gridspace::sim {
namespace {

void names(config::Fields& f, std::string_view key, std::vector<std::string>& out, std::string_view doc) {
    std::vector<config::Ref> refs;
    f.references(key, refs, {.doc = doc});
    if (!refs.empty()) {
        out.clear();
    }
    for (config::Ref& ref : refs) {
        out.push_back(std::move(ref.name));
    }
}

} // namespace

Rational SimulationConfig::duration() const {
    return duration_s ? *duration_s : duration_h ? *duration_h * Rational{3600} : Rational{0};
}

bool is_switching_signal(std::string_view name) {
    return name.starts_with("breaker.");
}

Rational signal_rate_hz(SimulationConfig const& simulation) {
    Rational const steps = Rational{1} / simulation.step_s;
    if (simulation.solver == SolverKind::phasor) {
        return steps;
    }
    config::Diagnostics ignored; // reported where the sampling is used
    Rational const rate = read_sampling(simulation.sampling, ignored).rate_hz;
    return (steps / rate).is_whole() ? rate : steps;
}

void describe(config::Fields& f, SimulationConfig& s) {
    f.file("network", s.network, {.doc = "network file (YAML, or a MATPOWER case *.m)", .required = true});
    s.network_mark = f.where("network");
    f.raw("network_changes", s.network_changes, {.doc = "laid over the network file, key by key"});
    describe(f, static_cast<EngineSettings&>(s));
    f.fraction("duration_s", s.duration_s, {.doc = "simulated time", .above = 0});
    f.fraction("duration_h", s.duration_h, {.doc = "simulated time", .above = 0});
    f.raw("gateways", s.gateways, {.doc = "per_bus, or a map of line gateways"});
    f.raw("sampling", s.sampling, {.doc = "sampled values of line gateways"});
    f.raw("controls", s.controls, {.doc = "who may set quantities of elements, or command them"});
    if (s.duration_s.has_value() == s.duration_h.has_value()) {
        f.error(s.duration_s ? "duration_s" : "",
                s.duration_s ? "the simulation has both duration_s and duration_h" : "the simulation has no duration",
                "give one of duration_s and duration_h");
    }
}

void describe(config::Fields& f, SimConfig& c) {
    f.object("simulation", {.doc = "what is simulated", .required = true},
             [&](config::Fields& s) { describe(s, c.simulation); });
    f.number("speed", c.speed, {.doc = "simulated seconds per second; 0: as fast as it goes", .min = 0});
    f.flag("start_on_utc_second", c.start_on_utc_second,
           {.doc = "real time: simulated time 0 is a whole second of UTC"});
    describe_events(f, c.events);
    f.map("members", {.doc = "lockstep members"}, [&](config::Ref const& name, config::Fields& m) {
        bus::MemberPlan plan;
        plan.name = name.name;
        names(m, "upstream", plan.upstream, "members whose output it reads");
        names(m, "triggered_by", plan.triggered_by, "those whose output makes it work in the same tick");
        names(m, "late", plan.late, "those upstream whose output is due after the tick it is made in");
        m.flag("feeds_simulator", plan.feeds_simulator, {.doc = "the simulator reads its output"});
        m.flag("collects_frames", plan.collects_frames,
               {.doc = "it reads frames, and need not do so in the tick in which they are sent"});
        c.members.push_back(std::move(plan));
    });
    std::vector<config::Ref> holds;
    f.references("holds_s", holds, {.doc = "instants after which the launcher acts"});
    for (config::Ref const& hold : holds) {
        if (auto const at = Rational::parse(hold.name)) {
            c.holds_s.push_back(*at);
        }
    }
    names(f, "signals", c.signals, "patterns of the signals that are published");
}

} // namespace gridspace::sim
