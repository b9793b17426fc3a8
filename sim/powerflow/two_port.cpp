// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/two_port.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim {
namespace {

TwoPort line_port(Network const& n, NameIndex const& buses, SwitchState const& state, std::size_t index) {
    Line const& line = n.lines[index];
    TwoPort port;
    port.kind = TwoPort::Kind::line;
    port.element = index;
    port.from = buses[line.from.name];
    port.to = buses[line.to.name];
    double const omega = 2 * std::numbers::pi * n.frequency_hz;
    double const z_base = base_impedance(n, n.buses[port.from]);
    LineTotals const t = line_totals(n, line);
    Complex const series = z_base / Complex{t.r_ohm, omega * t.l_h};
    Complex const half{0, omega * t.c_f / 2 * z_base};
    bool const from_closed = state.closed(n, line.name.name, LineEnd::from);
    bool const to_closed = state.closed(n, line.name.name, LineEnd::to);
    if (from_closed && to_closed) {
        port.ff = port.tt = series + half;
        port.ft = port.tf = -series;
    } else if (half != Complex{} && from_closed != to_closed) {
        // Seen from the closed end: the near half, and the far half through the line.
        (from_closed ? port.ff : port.tt) = half + series * half / (series + half);
    }
    return port;
}

TwoPort transformer_port(Network const& n, NameIndex const& buses, std::size_t index) {
    // MATPOWER User's Manual, branch model: an ideal transformer at the `from` end of a pi.
    Transformer const& t = n.transformers[index];
    TwoPort port;
    port.kind = TwoPort::Kind::transformer;
    port.element = index;
    port.from = buses[t.from.name];
    port.to = buses[t.to.name];
    double const to_system = n.power_kva / t.rating_kva;
    Complex const series = 100.0 / (to_system * Complex{t.r_percent, t.x_percent});
    Complex const half{0, t.charging_percent / 200 / to_system};
    Complex const magnetising{0, -t.magnetising_percent / 100 / to_system};
    Complex const tap = std::polar(t.tap_ratio, t.phase_shift_deg * std::numbers::pi / 180);
    port.tt = series + half;
    port.ff = (series + half + magnetising) / std::norm(tap);
    port.ft = -series / std::conj(tap);
    port.tf = -series / tap;
    return port;
}

} // namespace

SwitchState::SwitchState(Network const& network)
    : line_out(network.lines.size(), false), transformer_out(network.transformers.size(), false) {
    for (Breaker const& breaker : network.breakers) {
        breaker_closed.push_back(breaker.closed);
    }
}

bool SwitchState::closed(Network const& network, std::string const& line, LineEnd end) const {
    for (std::size_t i = 0; i < network.breakers.size(); ++i) {
        Breaker const& breaker = network.breakers[i];
        if (breaker.line.name == line && breaker.end == end && !breaker_closed[i]) {
            return false;
        }
    }
    return true;
}

double base_impedance(Network const& network, Bus const& bus) {
    return bus.voltage_v * bus.voltage_v / (network.power_kva * 1e3);
}

double lead_of(TwoPort const& b) {
    if (b.ft == b.tf || b.ft == Complex{} || b.tt == Complex{}) {
        return 0;
    }
    double const twice = std::arg(b.tf / b.ft), angle = twice / 2;
    bool const opposite = std::cos(std::arg(-b.tf / b.tt) - angle) < 0;
    return opposite ? angle + std::numbers::pi : angle;
}

std::vector<TwoPort> two_ports(Network const& network, SwitchState const& state) {
    NameIndex const buses{network.buses};
    std::vector<TwoPort> ports;
    for (std::size_t i = 0; i < network.lines.size(); ++i) {
        if (!state.line_out[i]) {
            ports.push_back(line_port(network, buses, state, i));
        }
    }
    for (std::size_t i = 0; i < network.transformers.size(); ++i) {
        if (!state.transformer_out[i]) {
            ports.push_back(transformer_port(network, buses, i));
        }
    }
    return ports;
}

} // namespace gridspace::sim
