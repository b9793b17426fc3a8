// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/phasor_engine.hpp"

#include "common/text.hpp"
#include "sim/network/earth_connection.hpp"
#include "sim/phasor/phasor_engine_impl.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <utility>

namespace gridspace::sim::phasor {
namespace {

/// Time constant of the frequency of a bus.
constexpr double kFrequencyLagS = 0.02;

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
    for (std::size_t m = 0; m < machines_.size(); ++m) {
        machines_[m]->set_start_power(Complex{flow->machines[m].p_kw, flow->machines[m].q_kvar} / network_.power_kva);
    }
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        injections_[k]->start(0, flow->buses[injections_[k]->bus()].v, dae_->states_of(k, std::span{y_}));
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
    for (MachineInjection const* m : machines_) {
        if (auto ok = m->check_field(dae_->states_of(index_of_injection(m), std::span<double const>{y_})); !ok) {
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

namespace {

class Around final : public Surroundings {
  public:
    Around(Network const& n, double start_hour_of_day) : n_{n}, start_hour_of_day_{start_hour_of_day} {}
    [[nodiscard]] double base_kva() const override { return n_.power_kva; }
    [[nodiscard]] std::size_t bus(Ref const& bus) const override { return index_of(n_.buses, bus.name); }
    [[nodiscard]] double voltage_v(Ref const& bus) const override { return find(n_.buses, bus.name)->voltage_v; }
    [[nodiscard]] Scale scale(Ref const& profile) const override { return scale_of(n_, profile, start_hour_of_day_); }

  private:
    Network const& n_;
    double start_hour_of_day_;
};

} // namespace

std::size_t PhasorEngine::index_of_injection(PhasorInjection const* injection) const {
    for (std::size_t k = 0; k < injections_.size(); ++k) {
        if (injections_[k].get() == injection) {
            return k;
        }
    }
    return injections_.size();
}

void PhasorEngine::add_unit(Ref const& name, std::unique_ptr<PhasorInjection> injection, std::string_view section,
                            Kind const* kind) {
    units_[name.name] = {injection.get(), section, kind};
    injections_.push_back(std::move(injection));
}

void PhasorEngine::add_injections() {
    Around const around{network_, options_.start_hour_of_day};
    for (OnePort const* e : one_ports(network_)) {
        if (auto injection = e->phasor(around)) {
            injection->connect(e->closed_at_start());
            add_unit(e->name, std::move(injection), e->kind().section, &e->kind());
        }
        if (!e->closed_at_start()) {
            out_.insert(e->name.name);
        }
    }
    for (std::size_t i = 0; i < network_.sources.size(); ++i) {
        Source const& source = network_.sources[i];
        if (source.r_ohm != 0 || source.l_mh != 0) {
            auto injection = std::make_unique<SourceInjection>(network_, source, bus_of(source.bus));
            sources_[i] = injection.get();
            injections_.push_back(std::move(injection));
        }
    }
    for (Machine const& machine : network_.machines) {
        auto injection = std::make_unique<MachineInjection>(network_, machine, bus_of(machine.bus));
        machines_.push_back(injection.get());
        add_unit(machine.name, std::move(injection), "machines");
    }
    for (Generator const& g : network_.generators) {
        if (g.role == GeneratorRole::pq) {
            add_unit(g.name, std::make_unique<GivenPower>(g, bus_of(g.bus), network_.power_kva), "generators");
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
            return std::exchange(slopes_jump_, false) ? find_slopes() : Result<void>{};
        }
        if (auto ok = set_topology(); !ok) {
            return ok;
        }
    }
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
    for_each_kind(n, [&]<class T>(std::vector<T> const& elements) {
        note(
            elements, [](OnePort const& e) { return e.unbalanced(); },
            fmt::format("powers by phase: they take a third of the sum for each of {}", T::kKind.word));
    });
    return out;
}

} // namespace gridspace::sim::phasor
