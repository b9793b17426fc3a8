// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/phasor_engine.hpp"

#include "common/text.hpp"
#include "sim/network/earth_connection.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <utility>

namespace gridspace::sim::phasor {
namespace {

/// Time constant of the frequency of a bus.
constexpr double kFrequencyLagS = 0.02;

/// Instants that differ by rounding only: 0.3 s + 30 ms and 0.33 s. The integrator cannot go from one to the other.
bool same_instant(double a, double b) {
    return std::abs(a - b) < 2 * std::numeric_limits<double>::epsilon() * (std::abs(a) + std::abs(b));
}

} // namespace

PhasorEngine::PhasorEngine(Network network, PhasorOptions options)
    : network_{std::move(network)}, options_{options}, switches_{network_} {
    add_injections();
    dae_ = std::make_unique<NetworkDae>(injections_, network_.buses.size());
    y_.assign(dae_->size(), 0.0);
    at_q_limit_.assign(network_.buses.size(), 0);
    angles_.assign(network_.buses.size(), 0.0);
    slopes_hz_.assign(network_.buses.size(), 0.0);
    yp_.assign(dae_->size(), 0.0);
    define_signals();
}

Result<void> PhasorEngine::initialise() {
    if (auto const bus = unearthed_bus(network_)) {
        return fail(
            ExitCode::usage,
            fmt::format("nothing connects bus '{}' to earth: its voltage is undefined", network_.buses[*bus].name.name),
            "earth a star point, or add a load, a shunt or line capacitance there");
    }
    PowerFlowOptions options;
    options.start_hour_of_day = options_.start_hour_of_day;
    options.enforce_q_limits = true;
    auto const flow = solve_power_flow(network_, switches_, options);
    if (!flow) {
        return std::unexpected{flow.error()};
    }
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        dae_->set_voltage(i, flow->buses[i].v, y_);
        angles_[i] = std::arg(flow->buses[i].v);
    }
    for (std::size_t i = 0; i < units_.size(); ++i) {
        if (auto const k = units_[i].injection) {
            Complex const s = Complex{flow->units[i].p_kw, flow->units[i].q_kvar} / network_.power_kva;
            injections_[*k]->start(0, flow->buses[injections_[*k]->bus()].v, s, dae_->states_of(*k, std::span{y_}));
        }
    }
    std::vector<bool> fed(network_.buses.size(), false);
    std::vector<BusRule> const rules = bus_rules(fed);
    for (std::size_t bus = 0; bus < rules.size(); ++bus) {
        double const v = std::abs(flow->buses[bus].v), held = rules[bus].v_set;
        if (rules[bus].kind == BusRule::Kind::regulated && std::abs(v - held) > 1e-9) {
            at_q_limit_[bus] = v < held ? 1 : -1; // as the power flow found it
        }
    }
    if (auto ok = set_topology(); !ok) {
        return ok;
    }
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        if (auto ok = injections_[k]->check_start(dae_->states_of(k, std::span<double const>{y_})); !ok) {
            return ok;
        }
    }
    return restart();
}

Result<void> PhasorEngine::advance(SimTime until) {
    double const target = options_.time_base.seconds(until), before = t_;
    if (input_changed_) {
        if (auto ok = restart(); !ok) {
            return ok;
        }
    }
    while (t_ < target) {
        double const next = pending_.empty() ? target : std::min(target, pending_.begin()->first);
        if (next <= t_ || same_instant(next, t_)) {
            t_ = std::max(t_, next);
            if (auto ok = open_breakers(); !ok) {
                return ok;
            }
            continue;
        }
        auto const stop = solver_->advance(next, y_, yp_);
        if (!stop) {
            return std::unexpected{stop.error()};
        }
        t_ = stop->events.empty() ? next : stop->t;
        if (!stop->events.empty()) {
            bool limits = false;
            for (int const found : stop->events) {
                auto const k = static_cast<std::size_t>(found);
                if (k < injections_.size()) {
                    injections_[k]->on_event(dae_->states_of(k, std::span{y_}));
                } else {
                    limits = true;
                    reach_q_limit(k - injections_.size());
                }
            }
            if (auto ok = limits ? set_topology() : Result<void>{}; !ok) {
                return ok;
            }
            if (auto ok = restart(); !ok) {
                return ok;
            }
        }
    }
    follow_angles(target - before);
    return check_voltages();
}

bool PhasorEngine::Unit::holds_without_injection() const {
    return !injection && (holding.ideal || holding.regulates);
}

PhasorEngine::Unit const* PhasorEngine::unit_named(std::string_view name) const {
    auto const it =
        std::find_if(units_.begin(), units_.end(), [&](Unit const& u) { return u.element->name.name == name; });
    return it == units_.end() ? nullptr : &*it;
}

/// States and currents are in this order: first what holds no voltage, then what does.
void PhasorEngine::add_injections() {
    NetworkAround const around{network_, options_.start_hour_of_day};
    for (OnePort* e : all<OnePort>(network_)) {
        units_.push_back({e, {}, holding_of(*e)});
        if (!e->closed_at_start()) {
            out_.insert(e->name.name);
        }
    }
    for (bool const holds : {false, true}) {
        for (Unit& unit : units_) {
            if (unit.holding.keeps_alive != holds) {
                continue;
            }
            if (auto injection = unit.element->phasor(around)) {
                injection->connect(unit.element->closed_at_start());
                unit.injection = injections_.size();
                injections_.push_back(std::move(injection));
            }
        }
    }
}

void PhasorEngine::follow_angles(double h) {
    for (std::size_t i = 0; i < angles_.size() && h > 0; ++i) {
        Complex const v = dae_->voltage(i, y_);
        double const ahead = v == Complex{} ? 0 : std::remainder(std::arg(v) - angles_[i], 2 * std::numbers::pi);
        double const share = h / (kFrequencyLagS + h);
        angles_[i] += ahead * share;
        slopes_hz_[i] = ahead * (1 - share) / (2 * std::numbers::pi * kFrequencyLagS);
    }
}

Result<void> PhasorEngine::restart() {
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        injections_[k]->decide(t_, dae_->states_of(k, std::span{y_}));
    }
    // Each round moves some generator to or from its limit; more than a few are a network that has no state.
    for (std::size_t round = 0;; ++round) {
        input_changed_ = false;
        if (auto ok = find_state(); !ok) {
            return ok;
        }
        if (round > 2 * units_.size() || !cross_q_limits()) {
            return std::exchange(slopes_jump_, false) ? find_slopes() : Result<void>{};
        }
        if (auto ok = set_topology(); !ok) {
            return ok;
        }
    }
}

/// Consistent voltages, searched from those of before. After a fault those may be too far away: then from full voltages
/// that are turned against them.
Result<void> PhasorEngine::find_state() {
    std::vector<double> const before = y_;
    auto ok = solver_->restart(t_, y_, yp_);
    for (double const turn : {0.0, 0.5, -0.5, 1.0, -1.0, 1.5, -1.5}) {
        if (ok) {
            break;
        }
        y_ = before;
        for (std::size_t i = 0; i < network_.buses.size(); ++i) {
            if (dae_->rule(i).kind != BusRule::Kind::dead) {
                dae_->set_voltage(i, std::polar(1.0, std::arg(dae_->voltage(i, before)) + turn), y_);
            }
        }
        if (solver_->restart(t_, y_, yp_)) {
            return {};
        }
    }
    return ok;
}

/// The solver knows the slopes of states. Those of voltages, which it takes for its first step, are found by a look at
/// a moment later.
Result<void> PhasorEngine::find_slopes() {
    constexpr double kLaterS = 1e-6;
    std::vector<double> y = y_, yp = yp_;
    std::vector<double> const is_state = dae_->differential();
    for (std::size_t i = 0; i < y.size(); ++i) {
        y[i] += is_state[i] != 0 ? kLaterS * yp[i] : 0;
    }
    if (auto ok = solver_->restart(t_ + kLaterS, y, yp); !ok) {
        return ok;
    }
    for (std::size_t i = 0; i < y.size(); ++i) {
        yp_[i] = is_state[i] != 0 ? yp_[i] : (y[i] - y_[i]) / kLaterS;
    }
    return solver_->restart(t_, y_, yp_);
}

Result<void> PhasorEngine::check_voltages() const {
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        double const v = std::abs(dae_->voltage(i, y_));
        if (!(v < 10)) {
            return fail(ExitCode::usage,
                        fmt::format("the voltage of bus '{}' is {} at {} s", network_.buses[i].name.name,
                                    std::isfinite(v) ? shortest(v) + " p.u." : "no number any more", shortest(t_)),
                        "the network has no sensible state there; look at what happened just before");
        }
    }
    return {};
}

Result<std::unique_ptr<Engine>> make_phasor_engine(Network network, PhasorOptions options) {
    return std::make_unique<PhasorEngine>(std::move(network), options);
}

std::vector<std::string> unseen_by_phasors(Network const& n) {
    std::vector<std::string> out;
    for_each_kind(n, [&]<class T>(std::vector<T> const& elements) {
        auto const it = std::find_if(elements.begin(), elements.end(),
                                     [](Element const& e) { return !e.unseen_by_phasors().empty(); });
        if (it != elements.end()) {
            out.push_back(fmt::format("phasors do not know {} '{}'", it->unseen_by_phasors(), it->name.name));
        }
    });
    return out;
}

} // namespace gridspace::sim::phasor
