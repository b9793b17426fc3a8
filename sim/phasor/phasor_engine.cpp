// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/phasor_engine.hpp"

#include "common/text.hpp"
#include "sim/network/earth_connection.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim::phasor {
namespace {

/// Time constant of the frequency of a bus.
constexpr double kFrequencyLagS = 0.02;

} // namespace

PhasorEngine::PhasorEngine(Network network, PhasorOptions options)
    : network_{std::move(network)}, options_{options}, switches_{network_} {
    add_components();
    dae_ = std::make_unique<NetworkDae>(components_, network_.buses.size());
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
    for (std::size_t m = 0; m < machines_.size(); ++m) {
        machines_[m]->set_start_power(Complex{flow->machines[m].p_kw, flow->machines[m].q_kvar} / network_.power_kva);
    }
    for (std::size_t k = 0; k < components_.size(); ++k) {
        components_[k]->start(0, flow->buses[components_[k]->bus()].v, dae_->states_of(k, std::span{y_}));
    }
    for (Generator const& g : network_.generators) {
        std::size_t const bus = bus_of(g.bus);
        double const v = std::abs(flow->buses[bus].v);
        if (g.role == GeneratorRole::pv && std::abs(v - g.voltage_setpoint_pu) > 1e-9) {
            at_q_limit_[bus] = v < g.voltage_setpoint_pu ? 1 : -1; // as the power flow found it
        }
    }
    if (auto ok = set_topology(); !ok) {
        return ok;
    }
    for (MachineComponent const* m : machines_) {
        if (auto ok = m->check_field(dae_->states_of(component_index(m), std::span<double const>{y_})); !ok) {
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
        if (next <= t_) {
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
                if (k < components_.size()) {
                    components_[k]->on_event(dae_->states_of(k, std::span{y_}));
                } else {
                    limits = true;
                    reach_q_limit(k - components_.size());
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

Scale PhasorEngine::scale_of(Ref const& name) const {
    Profile const* profile = find(network_.profiles, name.name);
    if (profile == nullptr) {
        return [](double) { return 1.0; };
    }
    return [profile, start = options_.start_hour_of_day](double t) { return profile_value(*profile, t / 3600, start); };
}

std::size_t PhasorEngine::component_index(Component const* component) const {
    for (std::size_t k = 0; k < components_.size(); ++k) {
        if (components_[k].get() == component) {
            return k;
        }
    }
    return components_.size();
}

void PhasorEngine::add_components() {
    double const base = network_.power_kva;
    for (Load const& load : network_.loads) {
        auto* c = add(std::make_unique<LoadComponent>(load, bus_of(load.bus), base, scale_of(load.scale)));
        loads_[load.name.name] = c;
        switchable_[load.name.name] = [c] { c->set_connected(false); };
    }
    for (Pv const& pv : network_.pv) {
        auto* c = add(std::make_unique<PvComponent>(pv, bus_of(pv.bus), base, scale_of(pv.scale)));
        switchable_[pv.name.name] = [c] { c->set_connected(false); };
    }
    for (Ev const& ev : network_.evs) {
        auto* c = add(std::make_unique<EvComponent>(ev, bus_of(ev.bus), base));
        evs_[ev.name.name] = c;
        switchable_[ev.name.name] = [c] { c->set_connected(false); };
    }
    for (Battery const& b : network_.batteries) {
        auto* c = add(std::make_unique<BatteryComponent>(b, bus_of(b.bus), base, scale_of(b.scale)));
        batteries_[b.name.name] = c;
        switchable_[b.name.name] = [c] { c->set_connected(false); };
    }
    for (Source const& source : network_.sources) {
        if (source.r_ohm != 0 || source.l_mh != 0) {
            add(std::make_unique<SourceComponent>(network_, source, bus_of(source.bus)));
        }
    }
    for (Machine const& machine : network_.machines) {
        auto* c = add(std::make_unique<MachineComponent>(network_, machine, bus_of(machine.bus)));
        machines_.push_back(c);
        switchable_[machine.name.name] = [c] { c->set_connected(false); };
    }
    for (Generator const& g : network_.generators) {
        if (g.role == GeneratorRole::pq) {
            auto* c = add(std::make_unique<FixedPowerComponent>(g.name.name, Complex{g.p_kw, g.q_kvar} / base,
                                                                g.rating_kva / base, bus_of(g.bus), base));
            switchable_[g.name.name] = [c] { c->set_connected(false); };
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
    // Each round moves some generator to or from its limit; more than a few are a network that has no state.
    for (std::size_t round = 0;; ++round) {
        input_changed_ = false;
        if (auto ok = solver_->restart(t_, y_, yp_); !ok) {
            return ok;
        }
        if (round > 2 * network_.generators.size() || !cross_q_limits()) {
            return {};
        }
        if (auto ok = set_topology(); !ok) {
            return ok;
        }
    }
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
    auto const note = [&](auto const& elements, auto const& has, std::string_view words) {
        auto const it = std::find_if(elements.begin(), elements.end(), has);
        if (it != elements.end()) {
            out.push_back(fmt::format("phasors do not know {} '{}'", words, it->name.name));
        }
    };
    note(n.sources, [](Source const& s) { return !s.harmonics.empty(); }, "the harmonics of source");
    note(
        n.transformers, [](Transformer const& t) { return t.saturation.has_value(); }, "the saturation of transformer");
    note(n.lines, [](Line const& l) { return l.model == LineModel::bergeron; }, "the travelling waves of line");
    note(
        n.line_types, [](LineType const& t) { return !t.phase_r_ohm_per_km.empty(); },
        "unequal phases: they transpose the lines of type");
    note(
        n.loads, [](Load const& l) { return !l.phase_p_kw.empty(); },
        "loads by phase: they take a third of the sum for each of load");
    return out;
}

} // namespace gridspace::sim::phasor
