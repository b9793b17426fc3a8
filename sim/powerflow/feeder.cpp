// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/powerflow/feeder.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

/// The admittance matrix of a feeder, and what holds or feeds it.
namespace gridspace::sim {

Feeder::Feeder(Network const& n, SwitchState const& state)
    : n_{n}, state_{state}, omega_{2 * std::numbers::pi * n.frequency_hz} {
    nodes_ = static_cast<int>(3 * n.buses.size());
    for (Bus const& b : n.buses) {
        phase_v_.push_back(b.voltage_v / std::sqrt(3.0));
    }
}

Result<void> Feeder::build() {
    if (!n_.machines.empty()) {
        return fail(
            ExitCode::usage,
            fmt::format("machine '{}': the three-phase power flow has no machines", n_.machines.front().name.name),
            "use the balanced power flow, or a source");
    }
    for (Generator const& g : n_.generators) {
        if (g.role == GeneratorRole::pv) {
            return fail(ExitCode::usage,
                        fmt::format("generator '{}': the three-phase power flow regulates no voltages", g.name.name),
                        "give it role pq or slack");
        }
    }
    for (std::size_t i = 0; i < n_.lines.size(); ++i) {
        line(i);
    }
    for (std::size_t i = 0; i < n_.transformers.size(); ++i) {
        if (auto ok = transformer(i); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    if (auto ok = sources(); !ok) {
        return std::unexpected{ok.error()};
    }
    for (OnePort const* e : one_ports(n_)) {
        if (e->closed_at_start()) {
            e->power_flow(*this);
        }
    }
    return {};
}

void Feeder::admit(Ref const& bus, Complex kva) {
    for (int k = 0; k < 3; ++k) {
        int const node = node_of(bus) + k;
        double const v = n_.buses[bus_of(bus)].voltage_v;
        add(node, node, kva * 1e3 / (v * v));
    }
}

double Feeder::scale(Ref const& name) const {
    Profile const* profile = name.empty() ? nullptr : find(n_.profiles, name.name);
    return profile == nullptr ? 1 : profile_value(*profile, hours_, start_hour_of_day_);
}

void Feeder::line(std::size_t index) {
    Line const& l = n_.lines[index];
    if (state_.line_out[index] || !state_.closed(n_, l.name.name, LineEnd::from) ||
        !state_.closed(n_, l.name.name, LineEnd::to)) {
        return;
    }
    LineTotals const t = line_totals(n_, l);
    Matrix3 z;
    LineType const* type = find(n_.line_types, l.type.name);
    if (type != nullptr && !type->phase_r_ohm_per_km.empty()) {
        constexpr int kPlace[3][3] = {{0, 1, 3}, {1, 2, 4}, {3, 4, 5}};
        for (int i = 0; i < 3; ++i) {
            for (int j = 0; j < 3; ++j) {
                auto const p = static_cast<std::size_t>(kPlace[i][j]);
                z(i, j) = Complex{type->phase_r_ohm_per_km[p], type->phase_x_ohm_per_km[p]} * l.length_km.value_or(0);
            }
        }
    } else {
        Complex const z1{t.r_ohm, omega_ * t.l_h}, z0{t.r0_ohm, omega_ * t.l0_h};
        z = Matrix3::Constant((z0 - z1) / 3.0) + z1 * Matrix3::Identity();
    }
    Matrix3 const y = z.inverse();
    Complex const c1{0, omega_ * t.c_f / 2}, c0{0, omega_ * t.c0_f / 2};
    Matrix3 const shunt = Matrix3::Constant((c0 - c1) / 3.0) + c1 * Matrix3::Identity();
    int const from = node_of(l.from), to = node_of(l.to);
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            add(from + i, from + j, y(i, j) + shunt(i, j));
            add(to + i, to + j, y(i, j) + shunt(i, j));
            add(from + i, to + j, -y(i, j));
            add(to + i, from + j, -y(i, j));
        }
    }
    lines_.push_back({index, y, shunt, from, to});
}

Feeder::Coils Feeder::coils(Ref const& bus, Winding connection, bool forward) {
    Coils out;
    int const node = node_of(bus);
    double const v = n_.buses[bus_of(bus)].voltage_v;
    int const neutral = connection == Winding::wye ? nodes_++ : -1;
    out.rated_v = connection == Winding::delta ? v : v / std::sqrt(3.0);
    for (int k = 0; k < 3; ++k) {
        int const other = connection == Winding::delta ? node + (k + (forward ? 1 : 2)) % 3 : neutral;
        out.ends[static_cast<std::size_t>(k)] = {node + k, other};
    }
    return out;
}

Result<void> Feeder::transformer(std::size_t index) {
    Transformer const& t = n_.transformers[index];
    if (state_.transformer_out[index]) {
        return {};
    }
    bool const from_delta = t.from_winding == Winding::delta, to_delta = t.to_winding == Winding::delta;
    double const natural = from_delta == to_delta ? 0 : 30;
    if (std::abs(std::abs(t.phase_shift_deg) - natural) > 1e-6) {
        return fail(ExitCode::usage,
                    fmt::format("transformer '{}' cannot shift by {} degrees with its windings", t.name.name,
                                t.phase_shift_deg),
                    natural == 0 ? "two stars or two deltas have phase_shift_deg: 0"
                                 : "a star and a delta have phase_shift_deg: 30 or -30");
    }
    bool const lags = t.phase_shift_deg > 0, both = from_delta && to_delta;
    Coils const primary = coils(t.from, t.from_winding, both || !lags);
    Coils const secondary = coils(t.to, t.to_winding, both || lags);
    double const ratio = secondary.rated_v / (primary.rated_v * t.tap_ratio);
    double const z_base = secondary.rated_v * secondary.rated_v / (t.rating_kva * 1e3 / 3);
    Complex const y = 100.0 / (Complex{t.r_percent, t.x_percent} * z_base);
    double const s = t.rating_kva * 1e3, v_from = n_.buses[bus_of(t.from)].voltage_v * t.tap_ratio,
                 v_to = n_.buses[bus_of(t.to)].voltage_v;
    double const z_from = 3 * std::pow(primary.rated_v * t.tap_ratio, 2) / s;
    Complex const magnetising{0, -t.magnetising_percent / 100 / z_from};
    for (std::size_t k = 0; k < 3; ++k) {
        auto const [a, b] = primary.ends[k];
        auto const [c, d] = secondary.ends[k];
        int const phase = static_cast<int>(k);
        limb({index, y, {a, b, c, d}, {ratio, -ratio, -1, 1}});
        limb({index, magnetising, {a, b, -1, -1}, {1, -1, 0, 0}});
        limb({index,
              {0, t.charging_percent / 200 * s / (v_from * v_from)},
              {node_of(t.from) + phase, -1, -1, -1},
              {1, 0, 0, 0}});
        limb({index,
              {0, t.charging_percent / 200 * s / (v_to * v_to)},
              {node_of(t.to) + phase, -1, -1, -1},
              {1, 0, 0, 0}});
    }
    return {};
}

void Feeder::limb(Limb const& l) {
    if (l.y == Complex{}) {
        return;
    }
    limbs_.push_back(l);
    for (std::size_t i = 0; i < 4; ++i) {
        for (std::size_t j = 0; j < 4; ++j) {
            add(l.nodes[i], l.nodes[j], l.weights[i] * l.weights[j] * l.y);
        }
    }
}

Result<void> Feeder::hold(std::string const& name, Ref const& bus, double pu, double angle_deg, Complex z1,
                          Complex z0) {
    int const node = node_of(bus);
    Complex const e = std::polar(pu * phase_v_[bus_of(bus)], angle_deg * std::numbers::pi / 180);
    for (int i = 0; i < 3; ++i) {
        Complex const phase = e * std::polar(1.0, -i * 2 * std::numbers::pi / 3);
        if (z1 == Complex{}) {
            auto const [it, fresh] = held_.try_emplace(node + i, phase);
            if (!fresh && std::abs(it->second - phase) > 1e-9 * phase_v_[bus_of(bus)]) {
                return fail(
                    ExitCode::usage,
                    fmt::format("'{}' holds bus '{}' at another voltage than somebody else does", name, bus.name),
                    "give one of them an impedance");
            }
            continue;
        }
        Complex const y1 = 1.0 / z1, mutual = (1.0 / z0 - y1) / 3.0;
        for (int j = 0; j < 3; ++j) {
            add(node + i, node + j, mutual + (i == j ? y1 : Complex{}));
        }
        sources_.emplace_back(node + i, y1 * phase); // balanced: no mutual part
    }
    return {};
}

Result<void> Feeder::sources() {
    for (Source const& s : n_.sources) {
        if (auto ok = hold(s.name.name, s.bus, s.voltage_pu, s.angle_deg, {s.r_ohm, omega_ * s.l_mh * 1e-3},
                           {s.r0_ohm.value_or(s.r_ohm), omega_ * s.l0_mh.value_or(s.l_mh) * 1e-3});
            !ok) {
            return ok;
        }
    }
    for (Generator const& g : n_.generators) {
        if (g.role == GeneratorRole::slack) {
            if (auto ok = hold(g.name.name, g.bus, g.voltage_setpoint_pu, g.angle_deg, {}, {}); !ok) {
                return ok;
            }
        }
    }
    if (held_.empty() && sources_.empty()) {
        return fail(ExitCode::usage, "the three-phase power flow needs a source or a slack generator");
    }
    return {};
}

} // namespace gridspace::sim
