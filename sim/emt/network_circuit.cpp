// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/network_circuit.hpp"

#include "sim/components/faces/converter.hpp"
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
    Builder(Network const& n, double start_hour_of_day) : n_{n}, around_{n, start_hour_of_day} {}

    Result<NetworkCircuit> build() {
        c_.frequency_hz = n_.frequency_hz;
        for (Bus const& b : n_.buses) {
            out_.bus_node.push_back(c_.add_triple(fmt::format("bus '{}'", b.name.name)));
            out_.bus_peak_v.push_back(b.voltage_v * std::sqrt(2.0 / 3));
            c_.peak_v = std::max(c_.peak_v, out_.bus_peak_v.back());
        }
        out_.line_switch.assign(switches_.size(), -1);
        Result<void> ok;
        for_each_kind(n_, [&]<class T>(std::vector<T> const& elements) {
            for (std::size_t i = 0; ok && i < elements.size(); ++i) {
                if constexpr (std::derived_from<T, TwoPort>) {
                    ok = two_port(elements[i]);
                } else if constexpr (std::derived_from<T, OnePort>) {
                    one_port(elements[i]);
                }
            }
        });
        if (!ok) {
            return std::unexpected{ok.error()};
        }
        return std::move(out_);
    }

  private:
    /// A triple behind a switch at a bus, so that the element can be taken out of service.
    int terminal(std::string const& name, int bus_node, int& switch_index, bool closed = true) {
        int const node = c_.add_triple(name);
        switch_index = static_cast<int>(c_.switches.size());
        c_.switches.push_back({bus_node, node, {closed, closed, closed}, {}, name});
        return node;
    }

    Result<void> two_port(TwoPort const& e) {
        TwoPortParts parts;
        parts.from_node = end(e, LineEnd::from, e.from, parts.from_switch);
        parts.to_node = end(e, LineEnd::to, e.to, parts.to_switch);
        out_.terminals[e.name.name] = {parts.from_switch, parts.to_switch};
        auto ok = e.circuit(c_, parts, around_);
        out_.two_ports.push_back(std::move(parts));
        return ok;
    }

    /// A triple behind the switch of an end, or behind poles that stay closed.
    int end(TwoPort const& e, LineEnd which, Ref const& bus, int& switch_index) {
        std::vector<std::size_t> here;
        bool closed = true;
        for (std::size_t s = 0; s < switches_.size(); ++s) {
            if (switches_[s]->line == e.name && switches_[s]->end == which) {
                here.push_back(s);
                closed = switches_[s]->closed_at_start();
            }
        }
        std::string const name = fmt::format("{} ({} end)", owner_of(e), which == LineEnd::from ? "from" : "to");
        int const node = terminal(name, out_.bus_node[around_.bus(bus)], switch_index, closed);
        for (std::size_t const s : here) {
            out_.line_switch[s] = switch_index;
        }
        return node;
    }

    void one_port(OnePort const& e) {
        NetworkCircuit::OnePortParts parts;
        parts.bus = around_.bus(e.bus);
        parts.node = terminal(owner_of(e), out_.bus_node[parts.bus], parts.breaker, e.closed_at_start());
        out_.terminals[e.name.name] = {parts.breaker};
        out_.one_ports.push_back(parts);
        e.circuit(*this);
    }
    /// Those of the element that is just being added.
    NetworkCircuit::OnePortParts& own() { return out_.one_ports.back(); }

    [[nodiscard]] double frequency_hz() const override { return around_.frequency_hz(); }
    [[nodiscard]] double base_kva() const override { return around_.base_kva(); }
    [[nodiscard]] std::size_t bus(Ref const& bus) const override { return around_.bus(bus); }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return around_.voltage_v(bus); }
    [[nodiscard]] double peak_v(Ref const& bus) const override { return out_.bus_peak_v[around_.bus(bus)]; }
    [[nodiscard]] Scale scale(Ref const& profile) const override { return around_.scale(profile); }
    [[nodiscard]] Element const* element(std::string_view section, Ref const& name) const override {
        return around_.element(section, name);
    }

    void source(OnePort const& e, SourceData const& data) override {
        NetworkCircuit::OnePortParts& parts = own();
        int inside = parts.node;
        if (data.r_ohm.one != 0 || data.l_h.one != 0) {
            inside = c_.add_triple("inside of " + owner_of(e));
            parts.impedance = c_.add_rl(inside, parts.node, data.r_ohm, data.l_h);
            c_.flows(parts.breaker, Kind::rl, static_cast<std::size_t>(parts.impedance), -1);
        }
        parts.source = static_cast<int>(c_.sources.size());
        c_.sources.push_back({inside, data.voltage_pu * out_.bus_peak_v[parts.bus],
                              data.angle_deg * std::numbers::pi / 180, n_.frequency_hz, data.harmonics, e.name.name});
    }

    void norton(OnePort const&, std::shared_ptr<NortonElement> model) override {
        NetworkCircuit::OnePortParts& parts = own();
        parts.norton = static_cast<int>(c_.norton.size());
        c_.flows(parts.breaker, Kind::norton, c_.norton.size(), -1);
        c_.norton.push_back({parts.node, std::move(model)});
    }

    void star(OnePort const& element) override {
        NetworkCircuit::OnePortParts& parts = own();
        double const voltage_v = n_.buses[parts.bus].voltage_v;
        StarElements const e = star_elements(element.admittance_kva(voltage_v), voltage_v, n_.frequency_hz);
        parts.resistance = c_.add_rl(parts.node, kEarth, same(e.r_ohm), {});
        c_.flows(parts.breaker, Kind::rl, static_cast<std::size_t>(parts.resistance), 1);
        if (e.l_h < kNothing) {
            parts.inductance = c_.add_rl(parts.node, kEarth, {}, same(e.l_h));
            c_.flows(parts.breaker, Kind::rl, static_cast<std::size_t>(parts.inductance), 1);
        }
        if (e.c_f > 0) {
            parts.capacitance = c_.add_capacitor(parts.node, kEarth, same(e.c_f));
            c_.flows(parts.breaker, Kind::capacitor, static_cast<std::size_t>(parts.capacitance), 1);
        }
    }

    /// Three resistances, and an inductance or capacitance parallel to each.
    void star_by_phase(OnePort const&, std::array<Complex, 3> const& kva) override {
        NetworkCircuit::OnePortParts const& parts = own();
        std::array<StarElements, 3> e;
        for (std::size_t k = 0; k < 3; ++k) {
            e[k] = star_elements(std::conj(3.0 * kva[k]), n_.buses[parts.bus].voltage_v, n_.frequency_hz);
        }
        auto const add = [&](CoupledBranch branch) {
            c_.flows(parts.breaker, Kind::coupled, c_.coupled.size(), 1);
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

    void converter(OnePort const& e, double rating_kva, std::unique_ptr<PowerModel> model,
                   std::optional<RideThrough> const& ride_through) override {
        NetworkCircuit::OnePortParts& parts = own();
        double const voltage_v = n_.buses[parts.bus].voltage_v;
        // Its filter leaves a path for what is not its current; the converter draws what the filter gives.
        double const filter_kvar = 1e-3 * (rating_kva > 0 ? rating_kva : n_.power_kva);
        c_.add_capacitor(parts.node, kEarth,
                         same(filter_kvar * 1e3 / (voltage_v * voltage_v) / (2 * std::numbers::pi * n_.frequency_hz)));
        c_.flows(parts.breaker, Kind::capacitor, c_.capacitors.size() - 1, 1);
        double const max_peak_a = kConverterOverload * 2 * rating_kva * 1e3 / (3 * out_.bus_peak_v[parts.bus]);
        GridRules rules = ride_through     ? ride_through->rules(n_.frequency_hz)
                          : e.kind().feeds ? GridRules::usual()
                                           : GridRules::of_load();
        parts.injection = inject({parts.bus, parts.node, parts.breaker, max_peak_a, filter_kvar, false,
                                  std::move(rules), ride_through.has_value(), std::move(model)});
    }

    void beyond_star(OnePort const&, std::unique_ptr<PowerModel> model) override {
        NetworkCircuit::OnePortParts& parts = own();
        parts.injection =
            inject({parts.bus, parts.node, parts.breaker, 0, 0, unbalanced_, {}, false, std::move(model)});
    }

    int inject(NetworkCircuit::Injection injection) {
        c_.flows(injection.breaker, Kind::injection, c_.injections.size(), -1);
        c_.injections.push_back({injection.node});
        out_.injections.push_back(std::move(injection));
        return static_cast<int>(out_.injections.size()) - 1;
    }

    Network const& n_;
    NetworkAround around_;
    std::vector<LineSwitch const*> switches_{all<LineSwitch>(n_)};
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
