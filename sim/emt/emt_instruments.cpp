// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <utility>

/// Current and voltage transformers of a network.
namespace gridspace::sim::emt {

void EmtEngine::add_instruments() {
    NetworkAround const around{network_};
    for (Instrument const* i : all<Instrument>(std::as_const(network_))) {
        Instrument::Place const place = i->place();
        InstrumentTransformer const transformer{i->data(around)};
        if (place.line.empty()) {
            instruments_.push_back(
                {transformer, false, static_cast<std::size_t>(parts_.bus_node[around.bus(place.bus)])});
            continue;
        }
        auto const line =
            std::find_if(two_ports_.begin(), two_ports_.end(), [&](TwoPort const* e) { return e->name == place.line; });
        TwoPortParts const& parts = parts_.two_ports[static_cast<std::size_t>(line - two_ports_.begin())];
        instruments_.push_back(
            {transformer, true,
             static_cast<std::size_t>(place.end == LineEnd::from ? parts.from_switch : parts.to_switch)});
    }
}

std::array<double, 3> EmtEngine::instrument_input(MeteredPlace const& i) const {
    if (i.current) {
        return {solver_.switch_current(i.at, 0), solver_.switch_current(i.at, 1), solver_.switch_current(i.at, 2)};
    }
    int const node = static_cast<int>(i.at);
    return {solver_.node_voltage(node), solver_.node_voltage(node + 1), solver_.node_voltage(node + 2)};
}

void EmtEngine::start_instruments() {
    double const w = 2 * std::numbers::pi * network_.frequency_hz;
    std::complex<double> const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
    for (MeteredPlace& i : instruments_) {
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
