// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/feeder.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// The admittance matrix of a feeder, and what holds or feeds it.
namespace gridspace::sim {

Feeder::Feeder(Network const& n, SwitchState const& state)
    : n_{n}, state_{state}, around_{n}, two_ports_{two_ports(n)} {
    nodes_ = static_cast<int>(3 * n.buses.size());
    for (Bus const& b : n.buses) {
        phase_v_.push_back(b.voltage_v / std::sqrt(3.0));
    }
}

Result<void> Feeder::build() {
    for (adding_ = 0; adding_ < two_ports_.size(); ++adding_) {
        TwoPort const& e = *two_ports_[adding_];
        Ends const closed = state_.closed(n_, e.name);
        if (state_.out[adding_] || !closed.from || !closed.to) {
            continue;
        }
        if (auto ok = e.phases(*this, around_); !ok) {
            return ok;
        }
    }
    for (OnePort const* e : one_ports(n_)) {
        added_ = e;
        if (e->closed_at_start()) {
            e->power_flow(*this);
        }
        if (refused_) {
            return std::unexpected{*refused_};
        }
    }
    if (held_.empty() && sources_.empty()) {
        return fail(ExitCode::usage, "the three-phase power flow needs a source or a slack generator");
    }
    return {};
}

void Feeder::admit(Ref const& bus, Complex kva) {
    double const v = around_.voltage_v(bus);
    for (int k = 0; k < 3; ++k) {
        add(node(bus) + k, node(bus) + k, kva * 1e3 / (v * v));
    }
}

void Feeder::regulate(Ref const&, Regulation const&) {
    refused_ =
        Error{ExitCode::usage, fmt::format("{}: the three-phase power flow regulates no voltages", owner_of(*added_)),
              "use the balanced power flow, a source, or a generator of role pq or slack"};
}

void Feeder::series(PhaseBlock const& z_ohm, PhaseBlock const& shunt_s) {
    Matrix3 z, shunt;
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            auto const row = static_cast<std::size_t>(i), column = static_cast<std::size_t>(j);
            z(i, j) = z_ohm[row][column];
            shunt(i, j) = shunt_s[row][column];
        }
    }
    Matrix3 const y = z.inverse();
    int const from = node(two_ports_[adding_]->from), to = node(two_ports_[adding_]->to);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            add(from + i, from + j, y(i, j) + shunt(i, j));
            add(to + i, to + j, y(i, j) + shunt(i, j));
            add(from + i, to + j, -y(i, j));
            add(to + i, from + j, -y(i, j));
        }
    }
    series_.push_back({adding_, y, shunt, from, to});
}

void Feeder::limb(Complex y, std::array<int, 4> const& nodes, std::array<double, 4> const& weights) {
    if (y == Complex{}) {
        return;
    }
    limbs_.push_back({adding_, y, nodes, weights});
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            add(nodes[i], nodes[j], weights[i] * weights[j] * y);
        }
    }
}

void Feeder::source(Ref const& bus, IdealSource const& s) {
    int const first = node(bus);
    double const nominal = phase_v_[around_.bus(bus)];
    Complex const e = std::polar(s.voltage_pu * nominal, s.angle_deg * std::numbers::pi / 180);
    for (int i = 0; i < 3; ++i) {
        Complex const phase = e * std::polar(1.0, -i * 2 * std::numbers::pi / 3);
        if (s.z1_ohm == Complex{}) {
            auto const [it, fresh] = held_.try_emplace(first + i, phase);
            if (!fresh && std::abs(it->second - phase) > 1e-9 * nominal) {
                refused_ = Error{ExitCode::usage,
                                 fmt::format("'{}' holds bus '{}' at another voltage than somebody else does",
                                             added_->name.name, bus.name),
                                 "give one of them an impedance"};
                return;
            }
            continue;
        }
        Complex const y1 = 1.0 / s.z1_ohm, mutual = (1.0 / s.z0_ohm - y1) / 3.0;
        for (int j = 0; j < 3; ++j) {
            add(first + i, first + j, mutual + (i == j ? y1 : Complex{}));
        }
        sources_.emplace_back(first + i, y1 * phase); // balanced: no mutual part
    }
}

} // namespace gridspace::sim
