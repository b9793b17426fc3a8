// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/network_dae.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim::phasor {

using Kind = BusRule::Kind;

namespace {

/// A generator that left its limit is this far beyond its voltage before it holds it again, p.u.
constexpr double kRegained = 1e-6;

Complex limited_power(BusRule const& rule) {
    return {rule.p, rule.at_limit > 0 ? rule.q_max : rule.q_min};
}

} // namespace

NetworkDae::NetworkDae(std::vector<std::unique_ptr<PhasorInjection>> const& injections, std::size_t buses)
    : injections_{injections}, buses_{buses}, rows_(buses), rules_(buses), injections_at_(buses) {
    std::size_t most = 0;
    for (std::size_t k = 0; k < injections.size(); ++k) {
        state_start_.push_back(voltage_start_);
        voltage_start_ += injections[k]->states();
        most = std::max(most, injections[k]->states());
        injections_at_[injections[k]->bus()].push_back(k);
    }
    scratch_.resize(most);
    moved_.resize(most);
    slopes_.resize(most);
}

void NetworkDae::set_network(std::vector<Branch> branches, std::vector<Complex> shunts, std::vector<BusRule> rules) {
    rules_ = std::move(rules);
    for (auto& row : rows_) {
        row.clear();
    }
    auto const add = [&](std::size_t r, std::size_t c, Complex y) {
        auto const it = std::find_if(rows_[r].begin(), rows_[r].end(), [&](RowEntry const& e) { return e.bus == c; });
        if (it == rows_[r].end()) {
            rows_[r].push_back({c, y});
        } else {
            it->y += y;
        }
    };
    for (std::size_t i = 0; i < buses_; ++i) {
        add(i, i, shunts[i]);
    }
    for (Branch const& b : branches) {
        add(b.from, b.from, b.ff);
        add(b.from, b.to, b.ft);
        add(b.to, b.from, b.tf);
        add(b.to, b.to, b.tt);
    }
}

std::span<double> NetworkDae::states_of(std::size_t k, std::span<double> y) const {
    return y.subspan(state_start_[k], injections_[k]->states());
}
std::span<double const> NetworkDae::states_of(std::size_t k, std::span<double const> y) const {
    return y.subspan(state_start_[k], injections_[k]->states());
}
Complex NetworkDae::voltage(std::size_t bus, std::span<double const> y) const {
    return {y[voltage_start_ + 2 * bus], y[voltage_start_ + 2 * bus + 1]};
}
void NetworkDae::set_voltage(std::size_t bus, Complex v, std::span<double> y) const {
    y[voltage_start_ + 2 * bus] = v.real();
    y[voltage_start_ + 2 * bus + 1] = v.imag();
}

Complex NetworkDae::network_current(std::size_t bus, std::span<double const> y) const {
    Complex current{};
    for (RowEntry const& e : rows_[bus]) {
        current += e.y * voltage(e.bus, y);
    }
    return current;
}

Complex NetworkDae::injected_current(std::size_t bus, double t, std::span<double const> y) const {
    Complex current{};
    for (std::size_t const k : injections_at_[bus]) {
        current +=
            injections_[k]->flow(t, states_of(k, y), voltage(bus, y), {scratch_.data(), injections_[k]->states()});
    }
    return current;
}

double NetworkDae::regulating_q(std::size_t bus, double t, std::span<double const> y) const {
    Complex const current = network_current(bus, y) - injected_current(bus, t, y);
    return (voltage(bus, y) * std::conj(current)).imag();
}

std::vector<double> NetworkDae::differential() const {
    std::vector<double> out(size(), 0.0);
    std::fill(out.begin(), out.begin() + static_cast<std::ptrdiff_t>(voltage_start_), 1.0);
    return out;
}

void NetworkDae::residual(double t, std::span<double const> y, std::span<double const> yp, std::span<double> f) {
    for (std::size_t i = 0; i < buses_; ++i) {
        Complex const v = voltage(i, y);
        Complex injected{};
        for (std::size_t const k : injections_at_[i]) {
            std::size_t const start = state_start_[k], count = injections_[k]->states();
            std::span<double> const dx = f.subspan(start, count);
            injected += injections_[k]->flow(t, y.subspan(start, count), v, dx);
            for (std::size_t s = 0; s < count; ++s) {
                dx[s] = yp[start + s] - dx[s];
            }
        }
        double& re = f[voltage_start_ + 2 * i];
        double& im = f[voltage_start_ + 2 * i + 1];
        Complex rest{};
        switch (rules_[i].kind) {
        case Kind::balance:
            rest = injected - network_current(i, y);
            break;
        case Kind::held:
            rest = v - rules_[i].v;
            break;
        case Kind::regulated: {
            Complex const generated = network_current(i, y) - injected;
            rest = {v.real() * generated.real() + v.imag() * generated.imag() - rules_[i].p,
                    std::norm(v) - rules_[i].v_set * rules_[i].v_set};
            break;
        }
        case Kind::limited:
            rest = injected + std::conj(limited_power(rules_[i]) / v) - network_current(i, y);
            break;
        case Kind::dead:
            rest = v;
            break;
        }
        re = rest.real();
        im = rest.imag();
    }
}

template <class Emit>
void NetworkDae::assemble(double t, double c, std::span<double const> y, Emit const& emit) const {
    for (std::size_t i = 0; i < buses_; ++i) {
        Complex const v = voltage(i, y);
        std::size_t const row = voltage_start_ + 2 * i;
        BusRule const& rule = rules_[i];
        bool const sum = rule.kind == Kind::balance || rule.kind == Kind::limited;
        bool const coupled = sum || rule.kind == Kind::regulated;
        Complex const generated =
            rule.kind == Kind::regulated ? network_current(i, y) - injected_current(i, t, y) : Complex{};
        // How a change (dre, dim) of the injected minus the network current enters the two equations of the bus.
        auto const enter = [&](std::size_t column, Complex change) {
            if (sum) {
                emit(row, column, change.real());
                emit(row + 1, column, change.imag());
            } else if (rule.kind == Kind::regulated) {
                emit(row, column, -(v.real() * change.real() + v.imag() * change.imag()));
            }
        };
        if (coupled) {
            for (RowEntry const& e : rows_[i]) {
                enter(voltage_start_ + 2 * e.bus, -e.y);
                enter(voltage_start_ + 2 * e.bus + 1, -e.y * Complex{0, 1});
            }
        }
        if (rule.kind == Kind::regulated) {
            emit(row, row, generated.real());
            emit(row, row + 1, generated.imag());
            emit(row + 1, row, 2 * v.real());
            emit(row + 1, row + 1, 2 * v.imag());
        } else if (rule.kind == Kind::limited) {
            Complex const slope = -std::conj(limited_power(rule) / (v * v));
            enter(row, slope);
            enter(row + 1, slope * Complex{0, -1});
        } else if (!coupled) {
            emit(row, row, 1.0);
            emit(row + 1, row + 1, 1.0);
        }
        // Each injection sees its own states and its bus voltage only: differences of its flow give its block.
        for (std::size_t const k : injections_at_[i]) {
            std::size_t const start = state_start_[k], count = injections_[k]->states();
            std::span<double const> const x = y.subspan(start, count);
            std::span<double> const dx{scratch_.data(), count};
            std::span<double> const dx_moved{slopes_.data(), count};
            Complex const at = injections_[k]->flow(t, x, v, dx);
            auto const column_of = [&](std::size_t column, double step, std::span<double const> x_moved,
                                       Complex v_moved) {
                Complex const moved = injections_[k]->flow(t, x_moved, v_moved, dx_moved);
                enter(column, (moved - at) / step);
                for (std::size_t s = 0; s < count; ++s) {
                    double const own = start + s == column ? c : 0;
                    emit(start + s, column, own - (dx_moved[s] - dx[s]) / step);
                }
            };
            std::copy(x.begin(), x.end(), moved_.begin());
            for (std::size_t s = 0; s < count; ++s) {
                double const step = 1e-7 * std::max(1.0, std::abs(x[s]));
                moved_[s] = x[s] + step;
                column_of(start + s, step, {moved_.data(), count}, v);
                moved_[s] = x[s];
            }
            constexpr double kStep = 1e-7;
            column_of(voltage_start_ + 2 * i, kStep, x, v + kStep);
            column_of(voltage_start_ + 2 * i + 1, kStep, x, v + Complex{0, kStep});
        }
    }
}

std::vector<SparsityEntry> NetworkDae::sparsity() const {
    std::vector<SparsityEntry> out;
    std::vector<double> y(size(), 0.0);
    for (std::size_t i = 0; i < buses_; ++i) {
        set_voltage(i, 1, y);
    }
    assemble(0, 1, y, [&](std::size_t row, std::size_t column, double) {
        out.push_back({static_cast<int>(row), static_cast<int>(column)});
    });
    return out;
}

void NetworkDae::jacobian(double t, double c, std::span<double const> y, std::span<double const>,
                          std::span<double> values) {
    std::size_t next = 0;
    assemble(t, c, y, [&](std::size_t, std::size_t, double value) { values[next++] = value; });
}

void NetworkDae::event_values(double t, std::span<double const> y, std::span<double> g) {
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        g[k] = injections_[k]->has_event() ? injections_[k]->event(t, states_of(k, y)) : 1.0;
    }
    for (std::size_t i = 0; i < buses_; ++i) {
        BusRule const& rule = rules_[i];
        double value = 1;
        if (rule.kind == Kind::regulated) {
            double const q = regulating_q(i, t, y);
            value = std::min({1.0, rule.q_max - q, q - rule.q_min});
        } else if (rule.kind == Kind::limited) {
            value = rule.at_limit * (rule.v_set - std::abs(voltage(i, y))) + kRegained;
        }
        g[injections_.size() + i] = value;
    }
}

} // namespace gridspace::sim::phasor
