// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/transformer_circuit.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Kind = CurrentTerm::Kind;

/// A three-phase winding: which nodes its three coils lie between.
struct Coils {
    std::array<std::pair<int, int>, 3> ends;
    int back{0}; ///< for a delta: the coil that ends at node k is coil (k + back) % 3
    bool delta{false};
    double coil_v{0}; ///< rated, r.m.s.
};

/// In a delta, coil k goes from node k to the next phase (`forward`) or to the one before.
Coils coils_of(Circuit& c, Winding3 const& w, bool forward) {
    Coils out;
    out.delta = w.connection == sim::Winding::delta;
    out.coil_v = out.delta ? w.voltage_v : w.voltage_v / std::sqrt(3.0);
    int neutral = kEarth;
    if (w.connection == sim::Winding::wye) {
        neutral = c.add_triple(w.name + " (star point)");
        // One star point: the other two nodes of the triple are not used.
        c.switches.push_back({kEarth, neutral, {false, true, true}, {}, w.name + " (star point)"});
    }
    for (int k = 0; k < 3; ++k) {
        int const other = out.delta ? w.node + (k + (forward ? 1 : 2)) % 3 : neutral;
        out.ends[static_cast<std::size_t>(k)] = {w.node + k, other};
    }
    out.back = forward ? 2 : 1;
    return out;
}

/// The current out of node k into elements of kind `kind`, coils `first` to `first` + 2, with this weight.
void flows(Circuit& c, int breaker, Kind kind, std::size_t first, double weight, Coils const& coils) {
    auto& terms = c.switches[static_cast<std::size_t>(breaker)].terms;
    terms.push_back({kind, static_cast<int>(first), weight, 0});
    if (coils.delta) {
        terms.push_back({kind, static_cast<int>(first), -weight, coils.back});
    }
}

} // namespace

Result<void> add_transformer(Circuit& c, Transformer const& t, Winding3 const& from, Winding3 const& to,
                             int from_switch, int to_switch) {
    double const w = 2 * std::numbers::pi * c.frequency_hz;
    bool const from_delta = t.from_winding == sim::Winding::delta, to_delta = t.to_winding == sim::Winding::delta;
    if (t.saturation && t.magnetising_percent == 0) {
        return fail(ExitCode::usage,
                    fmt::format("transformer '{}' saturates but has no magnetising current", t.name.name),
                    "give magnetising_percent");
    }
    double const natural = from_delta == to_delta ? 0 : 30;
    if (std::abs(std::abs(t.phase_shift_deg) - natural) > 1e-6) {
        return fail(ExitCode::usage,
                    fmt::format("transformer '{}' cannot shift by {} degrees with its windings", t.name.name,
                                t.phase_shift_deg),
                    natural == 0 ? "two stars or two deltas have phase_shift_deg: 0"
                                 : "a star and a delta have phase_shift_deg: 30 or -30");
    }
    // `to` lags by 30 degrees when its delta goes forward, or when the delta of `from` goes backward.
    bool const lags = t.phase_shift_deg > 0;
    Coils const primary = coils_of(c, from, from_delta && to_delta ? true : !lags);
    Coils const secondary = coils_of(c, to, from_delta && to_delta ? true : lags);
    double const ratio = secondary.coil_v / (primary.coil_v * t.tap_ratio);
    double const s_phase = t.rating_kva * 1e3 / 3;
    double const z_to = secondary.coil_v * secondary.coil_v / s_phase;
    double const z_from = std::pow(primary.coil_v * t.tap_ratio, 2) / s_phase;
    std::size_t const first = c.windings.size();
    for (std::size_t k = 0; k < 3; ++k) {
        auto const [a, b] = primary.ends[k];
        auto const [x, y] = secondary.ends[k];
        c.windings.push_back(
            {{a, b, x, y}, {ratio, -ratio, -1, 1}, t.r_percent / 100 * z_to, t.x_percent / 100 * z_to / w});
    }
    flows(c, from_switch, Kind::winding, first, ratio, primary);
    flows(c, to_switch, Kind::winding, first, -1, secondary);
    if (t.magnetising_percent > 0) {
        double const l = z_from * 100 / t.magnetising_percent / w;
        std::size_t const core = t.saturation ? c.cores.size() : c.windings.size();
        for (std::size_t k = 0; k < 3; ++k) {
            auto const [a, b] = primary.ends[k];
            if (t.saturation) {
                double const flux = std::sqrt(2.0) * primary.coil_v * t.tap_ratio / w;
                c.cores.push_back({{a, b, kEarth, kEarth},
                                   {1, -1, 0, 0},
                                   l,
                                   t.saturation->air_core_percent / 100 * z_from / w,
                                   t.saturation->knee_pu * flux});
            } else {
                c.windings.push_back({{a, b, kEarth, kEarth}, {1, -1, 0, 0}, 0, l});
            }
        }
        flows(c, from_switch, t.saturation ? Kind::core : Kind::winding, core, 1, primary);
    }
    if (t.charging_percent > 0) {
        auto const shunt = [&](Winding3 const& side, int breaker, double tap) {
            double const farad = t.charging_percent / 200 * t.rating_kva * 1e3 / std::pow(side.voltage_v * tap, 2) / w;
            c.switches[static_cast<std::size_t>(breaker)].terms.push_back(
                {Kind::capacitor, static_cast<int>(c.capacitors.size()), 1});
            c.capacitors.push_back({side.node, kEarth, PhaseMatrix::sequence(farad, farad)});
        };
        shunt(from, from_switch, t.tap_ratio);
        shunt(to, to_switch, 1);
    }
    return {};
}

} // namespace gridspace::sim::emt
