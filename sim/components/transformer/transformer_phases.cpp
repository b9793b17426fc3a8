// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/transformer/transformer.hpp"

#include <cmath>
#include <fmt/format.h>

/// Limbs of a transformer: in the power flow by phase and in the waveform simulation.
namespace gridspace::sim {
namespace {

using Part = emt::CurrentTerm::Kind;

/// A three-phase winding: which nodes its three coils lie between.
struct Coils {
    std::array<std::pair<int, int>, 3> ends;
    int back{0}; ///< for a delta: the coil that ends at node k is coil (k + back) % 3
    bool delta{false};
    double rated_v{0}; ///< of a coil, r.m.s.
};

/// `node`: first of its three terminals. `neutral`: the star point; earth's number where it is earthed.
Coils coils_of(Winding connection, int node, int neutral, double voltage_v, bool forward) {
    Coils out;
    out.delta = connection == Winding::delta;
    out.rated_v = out.delta ? voltage_v : voltage_v / std::sqrt(3.0);
    out.back = forward ? 2 : 1;
    for (int k = 0; k < 3; ++k) {
        int const other = out.delta ? node + (k + (forward ? 1 : 2)) % 3 : neutral;
        out.ends[static_cast<std::size_t>(k)] = {node + k, other};
    }
    return out;
}

} // namespace

Result<void> Transformer::phases(PhaseNetworkFace& face, Surroundings const& around) const {
    if (auto ok = check_windings(); !ok) {
        return ok;
    }
    constexpr int kEarth = -1;
    auto const side = [&](Ref const& bus, Winding connection, bool forward) {
        int const node = face.node(bus);
        return coils_of(connection, node, connection == Winding::wye ? face.add_node() : kEarth, around.voltage_v(bus),
                        forward);
    };
    Coils const primary = side(from, from_winding, from_forward()), secondary = side(to, to_winding, to_forward());
    double const ratio = secondary.rated_v / (primary.rated_v * tap_ratio);
    double const z_base = secondary.rated_v * secondary.rated_v / (rating_kva * 1e3 / 3);
    Complex const y = 100.0 / (Complex{r_percent, x_percent} * z_base);
    double const s = rating_kva * 1e3, v_from = around.voltage_v(from) * tap_ratio, v_to = around.voltage_v(to);
    double const z_from = 3 * std::pow(primary.rated_v * tap_ratio, 2) / s;
    Complex const magnetising{0, -magnetising_percent / 100 / z_from};
    for (std::size_t k = 0; k < 3; ++k) {
        auto const [a, b] = primary.ends[k];
        auto const [c, d] = secondary.ends[k];
        int const phase = static_cast<int>(k);
        face.limb(y, {a, b, c, d}, {ratio, -ratio, -1, 1});
        face.limb(magnetising, {a, b, -1, -1}, {1, -1, 0, 0});
        face.limb({0, charging_percent / 200 * s / (v_from * v_from)}, {face.node(from) + phase, -1, -1, -1},
                  {1, 0, 0, 0});
        face.limb({0, charging_percent / 200 * s / (v_to * v_to)}, {face.node(to) + phase, -1, -1, -1}, {1, 0, 0, 0});
    }
    return {};
}

namespace {

/// The star point of a winding that has one of its own: a switch makes the other two nodes of its triple earth.
int add_neutral(emt::Circuit& c, std::string const& side) {
    int const neutral = c.add_triple(side + " (star point)");
    c.switches.push_back({emt::kEarth, neutral, {false, true, true}, {}, side + " (star point)"});
    return neutral;
}

/// The current out of node k into elements of kind `kind`, coils `first` to `first` + 2, with this weight.
void flows(emt::Circuit& c, int breaker, Part kind, std::size_t first, double weight, Coils const& coils) {
    auto& terms = c.switches[static_cast<std::size_t>(breaker)].terms;
    terms.push_back({kind, static_cast<int>(first), weight, 0});
    if (coils.delta) {
        terms.push_back({kind, static_cast<int>(first), -weight, coils.back});
    }
}

/// Magnetising inductances of the coils at `from`, as cores where they saturate.
void magnetise(emt::Circuit& c, Transformer const& t, Coils const& primary, int from_switch, double z_from, double w) {
    double const l = z_from * 100 / t.magnetising_percent / w;
    std::size_t const core = t.saturation ? c.cores.size() : c.windings.size();
    for (std::size_t k = 0; k < 3; ++k) {
        auto const [a, b] = primary.ends[k];
        if (t.saturation) {
            double const flux = std::sqrt(2.0) * primary.rated_v * t.tap_ratio / w;
            c.cores.push_back({{a, b, emt::kEarth, emt::kEarth},
                               {1, -1, 0, 0},
                               l,
                               t.saturation->air_core_percent / 100 * z_from / w,
                               t.saturation->knee_pu * flux});
        } else {
            c.windings.push_back({{a, b, emt::kEarth, emt::kEarth}, {1, -1, 0, 0}, 0, l});
        }
    }
    flows(c, from_switch, t.saturation ? Part::core : Part::winding, core, 1, primary);
}

} // namespace

Result<void> Transformer::circuit(emt::Circuit& c, emt::TwoPortParts& parts, Surroundings const& around) const {
    if (saturation && magnetising_percent == 0) {
        return fail(ExitCode::usage,
                    fmt::format("transformer '{}' saturates but has no magnetising current", name.name),
                    "give magnetising_percent");
    }
    if (charging_percent < 0) { // a shunt reactor, said so in a MATPOWER case
        return fail(ExitCode::usage, fmt::format("transformer '{}' has a negative charging_percent", name.name),
                    "simulate with phasors, or give it none and shunts with negative q_kvar at its buses");
    }
    if (auto ok = check_windings(); !ok) {
        return ok;
    }
    double const w = 2 * std::numbers::pi * c.frequency_hz;
    auto const side = [&](Ref const& bus, Winding connection, int node, bool forward, char const* which) {
        int const neutral = connection == Winding::wye
                                ? add_neutral(c, fmt::format("transformer '{}' ({} side)", name.name, which))
                                : emt::kEarth;
        return coils_of(connection, node, neutral, around.voltage_v(bus), forward);
    };
    parts.windings = static_cast<int>(c.windings.size());
    Coils const primary = side(from, from_winding, parts.from_node, from_forward(), "from");
    Coils const secondary = side(to, to_winding, parts.to_node, to_forward(), "to");
    double const ratio = secondary.rated_v / (primary.rated_v * tap_ratio);
    double const s_phase = rating_kva * 1e3 / 3;
    double const z_to = secondary.rated_v * secondary.rated_v / s_phase;
    double const z_from = std::pow(primary.rated_v * tap_ratio, 2) / s_phase;
    std::size_t const first = c.windings.size();
    for (std::size_t k = 0; k < 3; ++k) {
        auto const [a, b] = primary.ends[k];
        auto const [x, y] = secondary.ends[k];
        c.windings.push_back(
            {{a, b, x, y}, {ratio, -ratio, -1, 1}, r_percent / 100 * z_to, x_percent / 100 * z_to / w});
    }
    flows(c, parts.from_switch, Part::winding, first, ratio, primary);
    flows(c, parts.to_switch, Part::winding, first, -1, secondary);
    if (magnetising_percent > 0) {
        magnetise(c, *this, primary, parts.from_switch, z_from, w);
    }
    if (charging_percent > 0) {
        auto const shunt = [&](Ref const& bus, int node, int breaker, double tap) {
            double const farad =
                charging_percent / 200 * rating_kva * 1e3 / std::pow(around.voltage_v(bus) * tap, 2) / w;
            c.flows(breaker, Part::capacitor, c.capacitors.size(), 1);
            c.add_capacitor(node, emt::kEarth, emt::PhaseMatrix::sequence(farad, farad));
        };
        shunt(from, parts.from_node, parts.from_switch, tap_ratio);
        shunt(to, parts.to_node, parts.to_switch, 1);
    }
    return {};
}

/// What is seen from its `from` side goes with the turns there: currents, capacitance and magnetising inductance.
bool Transformer::set_in_circuit(emt::Circuit& c, emt::TwoPortParts const& parts, std::string_view, double value) {
    if (saturation) {
        return false;
    }
    double const fewer = tap_ratio / value, square = fewer * fewer;
    auto const limbs = static_cast<std::size_t>(parts.windings);
    for (std::size_t k = limbs; k < limbs + 3; ++k) {
        c.windings[k].weights[0] *= fewer;
        c.windings[k].weights[1] *= fewer;
    }
    for (emt::CurrentTerm& term : c.switches[static_cast<std::size_t>(parts.from_switch)].terms) {
        auto const index = static_cast<std::size_t>(term.index);
        if (term.kind == Part::capacitor) {
            emt::PhaseMatrix& farad = c.capacitors[index].c;
            farad = emt::PhaseMatrix::sequence(farad.one * square, farad.zero() * square);
        } else if (term.kind == Part::winding && index == limbs) {
            term.sign *= fewer;
        } else if (term.kind == Part::winding && term.sign > 0) { // magnetising, once
            for (std::size_t k = index; k < index + 3; ++k) {
                c.windings[k].l /= square;
            }
        }
    }
    tap_ratio = value;
    return true;
}

} // namespace gridspace::sim
