// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/protection_figures.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

namespace gridspace::launcher {
namespace {

using config::Node;

/// Buses with a machine, by the run's copy of the network file; empty when that is not YAML.
std::set<std::string> machine_buses(Results const& r) {
    std::set<std::string> out;
    config::Diagnostics ignored;
    auto const network = config::load_yaml(r.folder / "network.yaml", ignored);
    Node const* machines = network ? network->find("machines") : nullptr;
    for (Node::Entry const& machine : machines == nullptr ? std::vector<Node::Entry>{} : machines->entries) {
        if (Node const* bus = machine.value.find("bus")) {
            out.insert(bus->text);
        }
    }
    return out;
}

void add(Figure& f, SignalStore const& signals, std::string const& name, std::string label, bool dashed = false) {
    if (auto const it = signals.find(name); it != signals.end()) {
        Figure::Series s{std::move(label), it->second.times_ns, it->second.values};
        s.dashed = dashed;
        f.series.push_back(std::move(s));
    }
}

Figure frequency(Results const& r, Published const& published, bool with_loops) {
    Figure f;
    f.y_label = "frequency, Hz";
    for (auto const& [name, series] : r.signals) {
        if (matches_glob("machine.*.frequency_hz", name)) {
            add(f, r.signals, name, split(name, '.')[1] + " rotor");
        }
    }
    add(f, r.signals, "system.coi_hz", "mean of the rotors, by inertia");
    if (with_loops) {
        for (std::string const& bus : machine_buses(r)) {
            add(f, r.signals, "pll." + bus + ".hz", "PLL at " + bus, true);
        }
    }
    if (published.frequency_nadir_hz) {
        f.lines.push_back(
            {fmt::format("published nadir: {:.5g} Hz", *published.frequency_nadir_hz), *published.frequency_nadir_hz});
    }
    return f;
}

/// Fault, trip and open poles of a chain.
std::vector<Figure::Mark> marks_of(RelayTiming const& t) {
    std::vector<Figure::Mark> out{{t.event, t.event_s, 1}};
    for (ChainStep const& step : t.chain) {
        if (step.what == "relay decides to trip" || step.what.ends_with("last pole open")) {
            out.push_back(
                {step.what == "relay decides to trip" ? "trip" : step.what.substr(0, step.what.find(':')) + " open",
                 t.event_s + step.after_ms / 1e3, -1});
        }
    }
    return out;
}

} // namespace

std::vector<Figure> protection_figures(Results const& r, Node const& scenario, WireTiming const& timing,
                                       Published const& published) {
    std::vector<Figure> out;
    double const end_s = r.outcome.simulated_s > 0 ? r.outcome.simulated_s : 1;
    std::string const as =
        published.frequency_figure.empty() ? "" : " (published as " + published.frequency_figure + ")";
    auto const chains = protection_chains(scenario);
    bool frequency_drawn = false;
    for (std::size_t i = 0; i < timing.relays.size() && i < chains.size(); ++i) {
        RelayTiming const& t = timing.relays[i];
        if (t.chain.empty()) {
            continue;
        }
        for (bool const with_loops : {false, true}) {
            if (frequency_drawn && !with_loops) {
                break;
            }
            Figure around = frequency(r, published, with_loops);
            around.id = (with_loops ? "pll_" : "frequency_") + t.relay;
            around.title = with_loops ? "The same beside phase-locked loops" : "Frequency around the fault" + as;
            around.axis = "trip_" + t.relay;
            around.from_s = std::max(0.0, t.event_s - 0.05);
            around.to_s = std::min(end_s, t.event_s + 0.25);
            around.marks = marks_of(t);
            around.note = with_loops
                              ? "A phase-locked loop measures the voltage, whose phase jumps with the fault and with "
                                "the opening: it shows something else than the rotors."
                              : "Rotor speeds; the dip is the braking torque of the first half cycle of the fault.";
            if (!around.series.empty()) {
                out.push_back(std::move(around));
                frequency_drawn = true;
            }
        }
        Figure currents;
        currents.id = "currents_" + t.relay;
        currents.title =
            fmt::format("Currents of both ends, {}", chains[i].gateway.empty() ? t.relay : chains[i].gateway);
        currents.y_label = "primary current, A";
        currents.axis = "trip_" + t.relay + "_close";
        currents.from_s = std::max(0.0, t.event_s - 0.02);
        currents.to_s = std::min(end_s, t.event_s + 0.04);
        currents.marks = marks_of(t);
        for (ProtectionChain::End const& end : chains[i].ends) {
            for (char const phase : {'a', 'b', 'c'}) {
                add(currents, r.signals, fmt::format("ct.{}.i.{}", end.transformer, phase),
                    fmt::format("{} {}", end.transformer, phase), &end == &chains[i].ends[1]);
            }
        }
        if (!currents.series.empty()) {
            out.push_back(std::move(currents));
        }
    }
    Figure whole = frequency(r, published, false);
    if (!whole.series.empty() && (frequency_drawn || published.frequency_nadir_hz)) {
        whole.id = "frequency";
        whole.title = "Frequency over the run" + as;
        whole.to_s = end_s;
        out.insert(out.begin(), std::move(whole));
    }
    return out;
}

} // namespace gridspace::launcher
