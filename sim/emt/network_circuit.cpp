// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/network_circuit.hpp"

#include "sim/components/faces/converter.hpp"
#include "sim/emt/generator_power.hpp"
#include "sim/emt/transformer_circuit.hpp"
#include "sim/powerflow/three_phase.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Kind = CurrentTerm::Kind;

PhaseMatrix same(double x) {
    return PhaseMatrix::sequence(x, x);
}

class Builder final : private CircuitFace {
  public:
    Builder(Network const& n, double start_hour_of_day) : n_{n}, start_hour_of_day_{start_hour_of_day} {}

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
        for (Transformer const& t : n_.transformers) {
            if (auto ok = transformer(t); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        for (OnePort const* e : one_ports(n_)) {
            one_port(*e);
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

    using Section = NetworkCircuit::LineParts::Section;

    Result<void> line(Line const& l) {
        LineType const* const type = find(n_.line_types, l.type.name);
        bool const by_phase = type != nullptr && !type->phase_r_ohm_per_km.empty();
        LineTotals const t = line_totals(n_, l);

        NetworkCircuit::LineParts parts;
        parts.from_node = line_end(l, LineEnd::from, l.from, parts.from_switch);
        parts.to_node = line_end(l, LineEnd::to, l.to, parts.to_switch);
        if (l.model == LineModel::bergeron) {
            if (auto ok = wave(l, t, by_phase, parts); !ok) {
                return ok;
            }
        } else if (by_phase) {
            coupled(l, *type, parts);
        } else {
            int const series = rl(parts.from_node, parts.to_node, PhaseMatrix::sequence(t.r_ohm, t.r0_ohm),
                                  PhaseMatrix::sequence(t.l_h, t.l0_h));
            parts.sections.push_back({Section::Kind::rl, series, 0, 1});
            flows(parts.from_switch, Kind::rl, static_cast<std::size_t>(series), 1);
            flows(parts.to_switch, Kind::rl, static_cast<std::size_t>(series), -1);
        }
        if (l.model == LineModel::pi && (t.c_f > 0 || t.c0_f > 0)) {
            PhaseMatrix const half = PhaseMatrix::sequence(t.c_f / 2, t.c0_f / 2);
            for (auto const& [node, breaker] :
                 {std::pair{parts.from_node, parts.from_switch}, std::pair{parts.to_node, parts.to_switch}}) {
                flows(breaker, Kind::capacitor, static_cast<std::size_t>(capacitor(node, kEarth, half)), 1);
            }
        }
        out_.terminals[l.name.name] = {parts.from_switch, parts.to_switch};
        out_.lines.push_back(std::move(parts));
        return {};
    }

    /// A triple behind the breaker of an end, or behind poles that stay closed.
    int line_end(Line const& l, LineEnd which, Ref const& bus, int& switch_index) {
        std::vector<std::size_t> breakers;
        bool closed = true;
        for (std::size_t b = 0; b < n_.breakers.size(); ++b) {
            if (n_.breakers[b].line == l.name && n_.breakers[b].end == which) {
                breakers.push_back(b);
                closed = n_.breakers[b].closed;
            }
        }
        int const node =
            terminal(fmt::format("line '{}' ({} end)", l.name.name, which == LineEnd::from ? "from" : "to"),
                     out_.bus_node[bus_of(bus)], switch_index, closed);
        for (std::size_t const b : breakers) {
            out_.breaker_switch[b] = switch_index;
        }
        return node;
    }

    Result<void> wave(Line const& l, LineTotals const& t, bool by_phase, NetworkCircuit::LineParts& parts) {
        if (by_phase) {
            return fail(ExitCode::usage, fmt::format("line '{}': travelling waves need a transposed line", l.name.name),
                        "use `model: pi`, or give its type r_ohm_per_km, x_ohm_per_km, r0 and x0");
        }
        if (t.l_h <= 0 || t.c_f <= 0 || t.l0_h <= 0 || t.c0_f <= 0) {
            return fail(ExitCode::usage,
                        fmt::format("line '{}': a travelling wave needs inductance and capacitance", l.name.name),
                        "give l_mh and c_nf, or use `model: pi`");
        }
        flows(parts.from_switch, Kind::bergeron_from, c_.bergeron.size(), 1);
        flows(parts.to_switch, Kind::bergeron_to, c_.bergeron.size(), 1);
        parts.sections.push_back({Section::Kind::wave, static_cast<int>(c_.bergeron.size()), 0, 1});
        c_.bergeron.push_back({parts.from_node, parts.to_node, std::sqrt(t.l_h / t.c_f), std::sqrt(t.l0_h / t.c0_f),
                               std::sqrt(t.l_h * t.c_f), std::sqrt(t.l0_h * t.c0_f), t.r_ohm, t.r0_ohm, l.name.name});
        return {};
    }

    /// A line that is not transposed.
    void coupled(Line const& l, LineType const& type, NetworkCircuit::LineParts& parts) {
        double const km = l.length_km.value_or(0), w = 2 * std::numbers::pi * n_.frequency_hz;
        parts.sections.push_back({Section::Kind::coupled, static_cast<int>(c_.coupled.size()), 0, 1});
        flows(parts.from_switch, Kind::coupled, c_.coupled.size(), 1);
        flows(parts.to_switch, Kind::coupled, c_.coupled.size(), -1);
        c_.coupled.push_back({CoupledBranch::Kind::inductive,
                              parts.from_node,
                              parts.to_node,
                              full(type.phase_r_ohm_per_km, km),
                              full(type.phase_x_ohm_per_km, km / w),
                              {}});
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
            NetworkCircuit::GeneratorParts parts;
            int const node =
                terminal(fmt::format("generator '{}'", g.name.name), out_.bus_node[bus_of(g.bus)], parts.breaker);
            out_.terminals[g.name.name] = {parts.breaker};
            parts.injection = converter(bus_of(g.bus), node, parts.breaker, rating, true,
                                        std::make_unique<GeneratorPower>(g, n_.power_kva));
            out_.generators.push_back(parts);
            return;
        }
        auto const ideal =
            ideal_source("generator", g.name.name, g.bus, g.voltage_setpoint_pu, g.angle_deg, {}, {}, {});
        out_.generators.push_back({.breaker = ideal.breaker, .injection = -1, .source = ideal.source});
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

    void one_port(OnePort const& e) {
        NetworkCircuit::OnePortParts parts;
        parts.bus = bus_of(e.bus);
        parts.node = terminal(fmt::format("{} '{}'", e.kind().word, e.name.name), out_.bus_node[parts.bus],
                              parts.breaker, e.closed_at_start());
        out_.terminals[e.name.name] = {parts.breaker};
        out_.one_ports.push_back(parts);
        e.circuit(*this);
    }
    /// Those of the element that is just being added.
    NetworkCircuit::OnePortParts& own() { return out_.one_ports.back(); }

    [[nodiscard]] double base_kva() const override { return n_.power_kva; }
    [[nodiscard]] std::size_t bus(Ref const& bus) const override { return bus_of(bus); }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return n_.buses[bus_of(bus)].voltage_v; }
    [[nodiscard]] Scale scale(Ref const& profile) const override { return scale_of(n_, profile, start_hour_of_day_); }

    void star(OnePort const& element) override {
        NetworkCircuit::OnePortParts& parts = own();
        double const voltage_v = n_.buses[parts.bus].voltage_v;
        StarElements const e = star_elements(element.admittance_kva(voltage_v), voltage_v, n_.frequency_hz);
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
    }

    /// Three resistances, and an inductance or capacitance beside each.
    void star_by_phase(OnePort const&, std::array<Complex, 3> const& kva) override {
        NetworkCircuit::OnePortParts const& parts = own();
        std::array<StarElements, 3> e;
        for (std::size_t k = 0; k < 3; ++k) {
            e[k] = star_elements(std::conj(3.0 * kva[k]), n_.buses[parts.bus].voltage_v, n_.frequency_hz);
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
    }

    void converter(OnePort const& element, double rating_kva, std::unique_ptr<PowerModel> model) override {
        NetworkCircuit::OnePortParts& parts = own();
        parts.injection =
            converter(parts.bus, parts.node, parts.breaker, rating_kva, element.kind().feeds, std::move(model));
    }

    void beyond_star(OnePort const&, std::unique_ptr<PowerModel> model) override {
        NetworkCircuit::OnePortParts& parts = own();
        parts.injection = inject({parts.bus, parts.node, parts.breaker, 0, 0, unbalanced_, false, std::move(model)});
    }

    int inject(NetworkCircuit::Injection injection) {
        flows(injection.breaker, Kind::injection, c_.injections.size(), -1);
        c_.injections.push_back({injection.node});
        out_.injections.push_back(std::move(injection));
        return static_cast<int>(out_.injections.size()) - 1;
    }

    int converter(std::size_t bus, int node, int breaker, double rating_kva, bool ceases,
                  std::unique_ptr<PowerModel> model) {
        double const voltage_v = n_.buses[bus].voltage_v;
        // Its filter leaves a path for what is not its current; the converter draws what the filter gives.
        double const filter_kvar = 1e-3 * (rating_kva > 0 ? rating_kva : n_.power_kva);
        capacitor(node, kEarth,
                  same(filter_kvar * 1e3 / (voltage_v * voltage_v) / (2 * std::numbers::pi * n_.frequency_hz)));
        flows(breaker, Kind::capacitor, c_.capacitors.size() - 1, 1);
        double const max_peak_a = kConverterOverload * 2 * rating_kva * 1e3 / (3 * out_.bus_peak_v[bus]);
        return inject({bus, node, breaker, max_peak_a, filter_kvar, false, ceases, std::move(model)});
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
        parts.limbs = static_cast<int>(c_.windings.size());
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
    double start_hour_of_day_;
    bool unbalanced_{is_unbalanced(n_)};
    NetworkCircuit out_;
    Circuit& c_{out_.circuit};
};

} // namespace

StarElements star_elements(Complex admittance_kva, double voltage_v, double frequency_hz) {
    double const p_kw = admittance_kva.real(), q_kvar = -admittance_kva.imag(); // drawn
    double const w = 2 * std::numbers::pi * frequency_hz;
    double const v2 = voltage_v * voltage_v;
    StarElements e;
    e.r_ohm = p_kw != 0 ? v2 / (p_kw * 1e3) : kNothing;
    e.l_h = q_kvar > 0 ? v2 / (q_kvar * 1e3) / w : kNothing;
    e.c_f = q_kvar < 0 ? -q_kvar * 1e3 / v2 / w : 0;
    return e;
}

Result<NetworkCircuit> make_circuit(Network const& network, double start_hour_of_day) {
    return Builder{network, start_hour_of_day}.build();
}

} // namespace gridspace::sim::emt
