// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <cmath>
#include <numbers>

/// Current and voltage transformers of a network.
namespace gridspace::sim::emt {

void EmtEngine::add_instruments() {
    double const w = 2 * std::numbers::pi * network_.frequency_hz;
    constexpr double kRoot2 = std::numbers::sqrt2;
    for (Ct const& ct : network_.cts) {
        CtType const& type = *find(network_.ct_types, ct.type.name);
        NetworkCircuit::LineParts const& line = parts_.lines[index_of(network_.lines, ct.line.name)];
        bool const at_from = ct.end == LineEnd::from;
        InstrumentData d;
        d.factor = (at_from || ct.positive == CtPolarity::into_line ? 1 : -1) * (1 + type.error_percent / 100);
        d.quantum = type.quantum_ma * 1e-3;
        d.cutoff_hz = type.filter == InstrumentFilter::none ? 0 : type.cutoff_hz;
        if (type.saturation) {
            CtSaturation const& s = *type.saturation;
            double const knee = kRoot2 * s.knee_v / w;
            d.core = {InstrumentData::Core::Of::current,
                      {knee / (kRoot2 * s.magnetising_ma * 1e-3), s.air_core_mh * 1e-3, knee},
                      s.winding_ohm + s.burden_ohm,
                      type.primary_a / type.secondary_a,
                      knee * s.remanence_percent / 100};
        }
        instruments_.push_back(
            {InstrumentTransformer{d}, true, static_cast<std::size_t>(at_from ? line.from_switch : line.to_switch)});
    }
    for (Vt const& vt : network_.vts) {
        VtType const& type = *find(network_.vt_types, vt.type.name);
        std::size_t const bus = index_of(network_.buses, vt.bus.name);
        InstrumentData d;
        d.factor = 1 + type.error_percent / 100;
        d.quantum = type.quantum_mv * 1e-3;
        d.cutoff_hz = type.filter == InstrumentFilter::none ? 0 : type.cutoff_hz;
        if (type.saturation) {
            VtSaturation const& s = *type.saturation;
            double const knee = s.knee_pu * parts_.bus_peak_v[bus] / w;
            d.core = {InstrumentData::Core::Of::voltage,
                      {knee / (kRoot2 * s.magnetising_ma * 1e-3), s.air_core_mh * 1e-3, knee},
                      s.winding_ohm,
                      1,
                      0};
        }
        instruments_.push_back({InstrumentTransformer{d}, false, static_cast<std::size_t>(parts_.bus_node[bus])});
    }
}

std::array<double, 3> EmtEngine::instrument_input(Instrument const& i) const {
    if (i.current) {
        return {solver_.switch_current(i.at, 0), solver_.switch_current(i.at, 1), solver_.switch_current(i.at, 2)};
    }
    int const node = static_cast<int>(i.at);
    return {solver_.node_voltage(node), solver_.node_voltage(node + 1), solver_.node_voltage(node + 2)};
}

void EmtEngine::start_instruments() {
    double const w = 2 * std::numbers::pi * network_.frequency_hz;
    std::complex<double> const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
    for (Instrument& i : instruments_) {
        if (i.transformer.dynamic()) {
            // The phasors of the positive sequence: exact where phases are balanced; the rest settles.
            auto const x = instrument_input(i);
            Space const s = to_space(x[0], x[1], x[2]);
            std::complex<double> const a{s.alpha, s.beta};
            i.transformer.start({a, a / turn, a * turn}, w, options_.time_base.seconds(options_.step));
        }
    }
}

} // namespace gridspace::sim::emt
