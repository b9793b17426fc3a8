// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/network_circuit.hpp"

#include "sim/emt/transformer_circuit.hpp"
#include "sim/powerflow/three_phase.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

/// An element without power conducts nothing, but can be given power later.
constexpr double kNothing = 1e18;

using Kind = CurrentTerm::Kind;

PhaseMatrix same(double x) {
    return PhaseMatrix::sequence(x, x);
}

class Builder {
  public:
    explicit Builder(Network const& n) : n_{n} {}

    Result<NetworkCircuit> build() {
        out_.circuit.frequency_hz = n_.frequency_hz;
        for (Bus const& b : n_.buses) {
            out_.bus_node.push_back(c_.add_triple(fmt::format("bus '{}'", b.name.name)));
            out_.bus_peak_v.push_back(b.voltage_v * std::sqrt(2.0 / 3));
        }
        out_.breaker_switch.assign(n_.breakers.size(), -1);
        for (Line const& l : n_.lines) {
            if (auto ok = line(l); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        for (Source const& s : n_.sources) {
            source(s);
        }
        for (Generator const& g : n_.generators) {
            generator(g);
        }
        for (Machine const& m : n_.machines) {
            machine(m);
        }
        for (Load const& l : n_.loads) {
            load(l);
        }
        for (Shunt const& s : n_.shunts) {
            out_.shunts.push_back(star("shunt", s.name.name, s.bus, s.p_kw, -s.q_kvar));
        }
        for (Transformer const& t : n_.transformers) {
            if (auto ok = transformer(t); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        for (std::size_t i = 0; i < n_.pv.size(); ++i) {
            double const rating = n_.pv[i].rating_kva > 0 ? n_.pv[i].rating_kva : n_.pv[i].p_kw / n_.pv[i].power_factor;
            converter(NetworkCircuit::Follower::Kind::pv, "PV", i, n_.pv[i].name.name, n_.pv[i].bus, rating);
        }
        for (std::size_t i = 0; i < n_.evs.size(); ++i) {
            Ev const& ev = n_.evs[i];
            converter(NetworkCircuit::Follower::Kind::ev, "EV", i, ev.name.name, ev.bus,
                      ev.max_current_a * ev.battery_v / ev.efficiency / 1e3);
        }
        for (std::size_t i = 0; i < n_.batteries.size(); ++i) {
            converter(NetworkCircuit::Follower::Kind::battery, "battery", i, n_.batteries[i].name.name,
                      n_.batteries[i].bus, n_.batteries[i].rating_kva);
        }
        return std::move(out_);
    }

  private:
    std::size_t bus_of(Ref const& bus) const { return index_of(n_.buses, bus.name); }

    /// A triple behind a switch at a bus, so that the element can be taken out of service.
    int terminal(std::string const& name, int bus_node, int& switch_index, bool closed = true) {
        int const node = c_.add_triple(name);
        switch_index = static_cast<int>(c_.switches.size());
        c_.switches.push_back({bus_node, node, {closed, closed, closed}, {}, name});
        return node;
    }
    void flows(int switch_index, Kind kind, std::size_t index, double sign) {
        c_.switches[static_cast<std::size_t>(switch_index)].terms.push_back({kind, static_cast<int>(index), sign});
    }
    int rl(int from, int to, PhaseMatrix const& r, PhaseMatrix const& l) {
        c_.rl.push_back({from, to, r, l});
        return static_cast<int>(c_.rl.size()) - 1;
    }
    int capacitor(int from, int to, PhaseMatrix const& c) {
        c_.capacitors.push_back({from, to, c});
        return static_cast<int>(c_.capacitors.size()) - 1;
    }

    Result<void> line(Line const& l) {
        LineType const* const type = find(n_.line_types, l.type.name);
        bool const by_phase = type != nullptr && !type->phase_r_ohm_per_km.empty();
        LineTotals const t = line_totals(n_, l);

        NetworkCircuit::LineParts parts;
        auto const end = [&](LineEnd which, Ref const& bus, int& switch_index) {
            bool closed = true;
            for (Breaker const& b : n_.breakers) {
                if (b.line == l.name && b.end == which) {
                    closed = b.closed;
                }
            }
            int const node =
                terminal(fmt::format("line '{}' ({} end)", l.name.name, which == LineEnd::from ? "from" : "to"),
                         out_.bus_node[bus_of(bus)], switch_index, closed);
            for (std::size_t b = 0; b < n_.breakers.size(); ++b) {
                if (n_.breakers[b].line == l.name && n_.breakers[b].end == which) {
                    out_.breaker_switch[b] = switch_index;
                }
            }
            return node;
        };
        parts.from_node = end(LineEnd::from, l.from, parts.from_switch);
        parts.to_node = end(LineEnd::to, l.to, parts.to_switch);
        if (l.model == LineModel::bergeron) {
            if (by_phase) {
                return fail(ExitCode::usage,
                            fmt::format("line '{}': travelling waves need a transposed line", l.name.name),
                            "use `model: pi`, or give its type r_ohm_per_km, x_ohm_per_km, r0 and x0");
            }
            if (t.l_h <= 0 || t.c_f <= 0 || t.l0_h <= 0 || t.c0_f <= 0) {
                return fail(ExitCode::usage,
                            fmt::format("line '{}': a travelling wave needs inductance and capacitance", l.name.name),
                            "give l_mh and c_nf, or use `model: pi`");
            }
            flows(parts.from_switch, Kind::bergeron_from, c_.bergeron.size(), 1);
            flows(parts.to_switch, Kind::bergeron_to, c_.bergeron.size(), 1);
            c_.bergeron.push_back({parts.from_node, parts.to_node, std::sqrt(t.l_h / t.c_f), std::sqrt(t.l0_h / t.c0_f),
                                   std::sqrt(t.l_h * t.c_f), std::sqrt(t.l0_h * t.c0_f), t.r_ohm, t.r0_ohm,
                                   l.name.name});
            parts.sections.push_back(
                {NetworkCircuit::LineParts::Section::Kind::wave, static_cast<int>(c_.bergeron.size()) - 1, 0, 1});
            out_.terminals[l.name.name] = {parts.from_switch, parts.to_switch};
            out_.lines.push_back(std::move(parts));
            return {};
        }
        if (by_phase) {
            double const km = l.length_km.value_or(0), w = 2 * std::numbers::pi * n_.frequency_hz;
            c_.coupled.push_back({CoupledBranch::Kind::inductive,
                                  parts.from_node,
                                  parts.to_node,
                                  full(type->phase_r_ohm_per_km, km),
                                  full(type->phase_x_ohm_per_km, km / w),
                                  {}});
            parts.sections.push_back(
                {NetworkCircuit::LineParts::Section::Kind::coupled, static_cast<int>(c_.coupled.size()) - 1, 0, 1});
            flows(parts.from_switch, Kind::coupled, c_.coupled.size() - 1, 1);
            flows(parts.to_switch, Kind::coupled, c_.coupled.size() - 1, -1);
        } else {
            int const series = rl(parts.from_node, parts.to_node, PhaseMatrix::sequence(t.r_ohm, t.r0_ohm),
                                  PhaseMatrix::sequence(t.l_h, t.l0_h));
            parts.sections.push_back({NetworkCircuit::LineParts::Section::Kind::rl, series, 0, 1});
            flows(parts.from_switch, Kind::rl, static_cast<std::size_t>(series), 1);
            flows(parts.to_switch, Kind::rl, static_cast<std::size_t>(series), -1);
        }
        if (t.c_f > 0 || t.c0_f > 0) {
            PhaseMatrix const half = PhaseMatrix::sequence(t.c_f / 2, t.c0_f / 2);
            flows(parts.from_switch, Kind::capacitor,
                  static_cast<std::size_t>(capacitor(parts.from_node, kEarth, half)), 1);
            flows(parts.to_switch, Kind::capacitor, static_cast<std::size_t>(capacitor(parts.to_node, kEarth, half)),
                  1);
        }
        out_.terminals[l.name.name] = {parts.from_switch, parts.to_switch};
        out_.lines.push_back(std::move(parts));
        return {};
    }

    NetworkCircuit::SourceParts ideal_source(std::string const& kind, std::string const& name, Ref const& bus,
                                             double voltage_pu, double angle_deg, PhaseMatrix const& r,
                                             PhaseMatrix const& l, std::vector<Source::Harmonic> const& harmonics) {
        NetworkCircuit::SourceParts parts;
        std::size_t const b = bus_of(bus);
        int const node = terminal(fmt::format("{} '{}'", kind, name), out_.bus_node[b], parts.breaker);
        int inside = node;
        if (r.one != 0 || l.one != 0) {
            inside = c_.add_triple(fmt::format("inside of {} '{}'", kind, name));
            parts.impedance = rl(inside, node, r, l);
            flows(parts.breaker, Kind::rl, static_cast<std::size_t>(parts.impedance), -1);
        }
        parts.source = static_cast<int>(c_.sources.size());
        VoltageSource source{
            inside, voltage_pu * out_.bus_peak_v[b], angle_deg * std::numbers::pi / 180, n_.frequency_hz, {}, name};
        for (Source::Harmonic const& h : harmonics) {
            source.harmonics.push_back(
                {static_cast<int>(h.order), h.percent / 100, h.angle_deg * std::numbers::pi / 180});
        }
        c_.sources.push_back(std::move(source));
        out_.terminals[name] = {parts.breaker};
        return parts;
    }

    void source(Source const& s) {
        double const l = s.l_mh * 1e-3;
        out_.sources.push_back(ideal_source("source", s.name.name, s.bus, s.voltage_pu, s.angle_deg,
                                            PhaseMatrix::sequence(s.r_ohm, s.r0_ohm.value_or(s.r_ohm)),
                                            PhaseMatrix::sequence(l, s.l0_mh ? *s.l0_mh * 1e-3 : l), s.harmonics));
    }

    void generator(Generator const& g) {
        if (g.role != GeneratorRole::slack) {
            // The reactive power of one that holds a voltage is not known here: without a rating nothing limits it.
            double const rating =
                g.role == GeneratorRole::pq ? std::max(g.rating_kva, std::hypot(g.p_kw, g.q_kvar)) : g.rating_kva;
            converter(NetworkCircuit::Follower::Kind::generator, "generator", index_of(n_.generators, g.name.name),
                      g.name.name, g.bus, rating);
            return;
        }
        out_.slack_generators.push_back(
            ideal_source("generator", g.name.name, g.bus, g.voltage_setpoint_pu, g.angle_deg, {}, {}, {}));
    }

    void machine(Machine const& m) {
        std::size_t const b = bus_of(m.bus);
        MachinePort port;
        port.name = m.name.name;
        port.data = machines::machine_data(n_, m);
        port.v_base = out_.bus_peak_v[b];
        port.i_base = 2 * m.rating_kva * 1e3 / (3 * port.v_base);
        NetworkCircuit::MachineParts parts;
        port.node = terminal(fmt::format("machine '{}'", m.name.name), out_.bus_node[b], parts.breaker);
        flows(parts.breaker, Kind::machine, c_.machines.size(), -1);
        c_.machines.push_back(std::move(port));
        out_.terminals[m.name.name] = {parts.breaker};
        out_.machines.push_back(parts);
    }

    NetworkCircuit::LoadParts star(std::string const& kind, std::string const& name, Ref const& bus, double p_kw,
                                   double q_kvar) {
        std::size_t const b = bus_of(bus);
        NetworkCircuit::LoadParts parts;
        parts.node = terminal(fmt::format("{} '{}'", kind, name), out_.bus_node[b], parts.breaker);
        StarElements const e = star_elements(p_kw, q_kvar, n_.buses[b].voltage_v, n_.frequency_hz);
        parts.resistance = rl(parts.node, kEarth, same(e.r_ohm), {});
        flows(parts.breaker, Kind::rl, static_cast<std::size_t>(parts.resistance), 1);
        if (e.l_h < kNothing) {
            parts.inductance = rl(parts.node, kEarth, {}, same(e.l_h));
            flows(parts.breaker, Kind::rl, static_cast<std::size_t>(parts.inductance), 1);
        }
        if (e.c_f > 0) {
            parts.capacitance = capacitor(parts.node, kEarth, same(e.c_f));
            flows(parts.breaker, Kind::capacitor, static_cast<std::size_t>(parts.capacitance), 1);
        }
        out_.terminals[name] = {parts.breaker};
        return parts;
    }

    /// A load by phase: three resistances, and an inductance or capacitance beside each.
    NetworkCircuit::LoadParts star_by_phase(Load const& l) {
        std::size_t const b = bus_of(l.bus);
        NetworkCircuit::LoadParts parts;
        parts.node = terminal(fmt::format("load '{}'", l.name.name), out_.bus_node[b], parts.breaker);
        std::array<StarElements, 3> e;
        for (std::size_t k = 0; k < 3; ++k) {
            e[k] = star_elements(3 * l.phase_p_kw[k], 3 * l.phase_q_kvar[k], n_.buses[b].voltage_v, n_.frequency_hz);
        }
        auto const add = [&](CoupledBranch branch) {
            flows(parts.breaker, Kind::coupled, c_.coupled.size(), 1);
            c_.coupled.push_back(branch);
        };
        using Branch = CoupledBranch::Kind;
        add({Branch::inductive, parts.node, kEarth, diagonal(e[0].r_ohm, e[1].r_ohm, e[2].r_ohm), {}, {}});
        if (std::min({e[0].l_h, e[1].l_h, e[2].l_h}) < kNothing) {
            add({Branch::inductive, parts.node, kEarth, {}, diagonal(e[0].l_h, e[1].l_h, e[2].l_h), {}});
        }
        if (std::max({e[0].c_f, e[1].c_f, e[2].c_f}) > 0) {
            add({Branch::capacitive, parts.node, kEarth, {}, {}, diagonal(e[0].c_f, e[1].c_f, e[2].c_f)});
        }
        out_.terminals[l.name.name] = {parts.breaker};
        return parts;
    }

    void load(Load const& l) {
        if (l.model == LoadModel::dc_constant_power) {
            converter(NetworkCircuit::Follower::Kind::dc_load, "load", index_of(n_.loads, l.name.name), l.name.name,
                      l.bus, std::abs(l.p_kw));
            NetworkCircuit::Follower const& f = out_.followers.back();
            NetworkCircuit::LoadParts parts;
            parts.node = f.node;
            parts.breaker = f.breaker;
            out_.loads.push_back(parts);
            return;
        }
        out_.loads.push_back(l.phase_p_kw.empty() ? star("load", l.name.name, l.bus, l.p_kw, load_q_kvar(l))
                                                  : star_by_phase(l));
        bool const constant_impedance = l.model == LoadModel::constant_impedance || l.model == LoadModel::dc_resistive;
        if (!constant_impedance || !l.scale.empty() || l.lag_s > 0) {
            NetworkCircuit::LoadParts const& parts = out_.loads.back();
            follower({NetworkCircuit::Follower::Kind::load, static_cast<std::size_t>(&l - n_.loads.data()),
                      bus_of(l.bus), parts.node, parts.breaker, 0, 0, unbalanced_});
        }
    }

    void follower(NetworkCircuit::Follower const& f) {
        flows(f.breaker, Kind::injection, c_.injections.size(), -1);
        c_.injections.push_back({f.node});
        out_.followers.push_back(f);
    }

    void converter(NetworkCircuit::Follower::Kind kind, std::string const& word, std::size_t element,
                   std::string const& name, Ref const& bus, double rating_kva) {
        NetworkCircuit::Follower f{kind, element, bus_of(bus), 0, 0, 0, 0, false};
        f.node = terminal(fmt::format("{} '{}'", word, name), out_.bus_node[f.bus], f.breaker);
        f.max_peak_a = kConverterOverload * 2 * rating_kva * 1e3 / (3 * out_.bus_peak_v[f.bus]);
        // Its filter leaves a path for what is not its current; the converter draws what the filter gives.
        f.filter_kvar = 1e-3 * (rating_kva > 0 ? rating_kva : n_.power_kva);
        capacitor(f.node, kEarth,
                  same(f.filter_kvar * 1e3 / (n_.buses[f.bus].voltage_v * n_.buses[f.bus].voltage_v) /
                       (2 * std::numbers::pi * n_.frequency_hz)));
        flows(f.breaker, Kind::capacitor, c_.capacitors.size() - 1, 1);
        out_.terminals[name] = {f.breaker};
        follower(f);
    }

    Result<void> transformer(Transformer const& t) {
        NetworkCircuit::TransformerParts parts;
        auto const side = [&](Ref const& bus, sim::Winding connection, char const* which, int& breaker) {
            std::string const name = fmt::format("transformer '{}' ({} side)", t.name.name, which);
            return Winding3{terminal(name, out_.bus_node[bus_of(bus)], breaker), connection,
                            n_.buses[bus_of(bus)].voltage_v, name};
        };
        Winding3 const from = side(t.from, t.from_winding, "from", parts.from_switch);
        Winding3 const to = side(t.to, t.to_winding, "to", parts.to_switch);
        out_.terminals[t.name.name] = {parts.from_switch, parts.to_switch};
        out_.transformers.push_back(parts);
        return add_transformer(c_, t, from, to, parts.from_switch, parts.to_switch);
    }

    static Matrix3 full(std::vector<double> const& lower, double times) {
        constexpr std::size_t kPlace[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
        Matrix3 m{};
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                m[i][j] = lower[kPlace[i][j]] * times;
            }
        }
        return m;
    }

    Network const& n_;
    bool unbalanced_{is_unbalanced(n_)};
    NetworkCircuit out_;
    Circuit& c_{out_.circuit};
};

} // namespace

StarElements star_elements(double p_kw, double q_kvar, double voltage_v, double frequency_hz) {
    double const w = 2 * std::numbers::pi * frequency_hz;
    double const v2 = voltage_v * voltage_v;
    StarElements e;
    e.r_ohm = p_kw != 0 ? v2 / (p_kw * 1e3) : kNothing;
    e.l_h = q_kvar > 0 ? v2 / (q_kvar * 1e3) / w : kNothing;
    e.c_f = q_kvar < 0 ? -q_kvar * 1e3 / v2 / w : 0;
    return e;
}

Result<NetworkCircuit> make_circuit(Network const& network) {
    return Builder{network}.build();
}

} // namespace gridspace::sim::emt
