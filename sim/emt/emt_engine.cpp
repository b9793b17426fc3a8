// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include "common/text.hpp"
#include "sim/powerflow/power_flow.hpp"
#include "sim/powerflow/three_phase.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <numeric>

namespace gridspace::sim::emt {

EmtEngine::EmtEngine(Network network, NetworkCircuit parts, EmtOptions options)
    : network_{std::move(network)}, parts_{std::move(parts)}, options_{options},
      solver_{parts_.circuit, options_.time_base.seconds(options_.step), options_.team},
      one_ports_{all<OnePort>(network_)}, two_ports_{all<TwoPort>(network_)} {
    plls_.assign(network_.buses.size(), Pll{network_.frequency_hz});
    read_plls_.resize(plls_.size());
    std::iota(read_plls_.begin(), read_plls_.end(), std::size_t{0});
    add_instruments();
    define_signals();
}

Result<void> EmtEngine::initialise() {
    if (is_unbalanced(network_)) {
        return initialise_unbalanced();
    }
    auto const start = balanced_start();
    return start ? begin(start->norton, start_injections(start->bus_v, start->kvar)) : std::unexpected{start.error()};
}

Result<EmtEngine::BalancedStart> EmtEngine::balanced_start() const {
    PowerFlowOptions options;
    options.start_hour_of_day = options_.start_hour_of_day;
    options.enforce_q_limits = true; // as the converters of generators do
    auto const flow = solve_power_flow(network_, SwitchState{network_}, options);
    if (!flow) {
        return std::unexpected{flow.error()};
    }
    BalancedStart out;
    std::complex<double> const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
    for (auto const& bus : flow->buses) {
        out.bus_v.push_back({bus.v, bus.v / turn, bus.v * turn});
    }
    for (std::size_t i = 0; i < parts_.one_ports.size(); ++i) {
        NetworkCircuit::OnePortParts const& parts = parts_.one_ports[i];
        PowerFlow::UnitValue const& unit = flow->units[i];
        std::complex<double> const pu = flow->buses[parts.bus].v;
        if (parts.norton >= 0) {
            std::complex<double> const v = pu * parts_.bus_peak_v[parts.bus], s{unit.p_kw * 1e3, unit.q_kvar * 1e3};
            out.norton.push_back({v, v == 0.0 ? 0.0 : std::conj(s * 2.0 / (3.0 * v))});
        }
        if (PowerModel const* model = model_of(parts)) {
            if (auto ok = model->check_start(std::abs(pu), {unit.p_kw, unit.q_kvar}); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        out.kvar.push_back(unit.q_kvar);
    }
    return out;
}

Result<void> EmtEngine::begin(std::vector<Solver::NortonStart> const& starts,
                              std::vector<BusPhases> const& injections) {
    auto ok = solver_.start(starts, injections);
    return ok ? finish_start() : ok;
}

Result<void> EmtEngine::finish_start() {
    if (auto const floating = solver_.floating_nodes(); !floating.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("nothing connects {} to earth: its voltage is undefined", floating.front()),
                    "earth a star point, or add a load, a shunt or line capacitance there");
    }
    for (NortonPort const& p : solver_.circuit().norton) {
        if (auto ok = p.element->check_start(); !ok) {
            return ok;
        }
    }
    now_ = {};
    start_plls();
    start_instruments();
    return {};
}

void EmtEngine::start_plls() {
    for (std::size_t i = 0; i < plls_.size(); ++i) {
        Space const v = bus_voltage(i);
        plls_[i].start(v.alpha, v.beta);
    }
}

Result<void> EmtEngine::advance(SimTime until) {
    while (now_ < until) {
        // The usual step keeps its exact bits: its factors are there.
        SimSpan const span = std::min(until - now_, options_.step);
        SimTime const next = now_ + span;
        if (auto ok = step(options_.time_base.seconds(next), options_.time_base.seconds(span)); !ok) {
            return ok;
        }
        now_ = next;
    }
    return {};
}

Result<void> EmtEngine::step(double t_end, double h) {
    solver_.each_part([&](std::size_t part) { inject(solver_.injections(part), h); });
    if (auto ok = solver_.advance(t_end, h); !ok) {
        return ok;
    }
    solver_.each_part([&](std::size_t part) {
        step_injections(solver_.injections(part), t_end, h);
        step_plls(part, solver_.parts(), h);
    });
    for (MeteredPlace& i : instruments_) {
        if (i.transformer.dynamic()) {
            i.transformer.step(instrument_input(i), h);
        }
    }
    return {};
}

void EmtEngine::step_plls(std::size_t part, std::size_t parts, double h) {
    std::size_t const count = read_plls_.size();
    for (std::size_t k = count * part / parts; k < count * (part + 1) / parts; ++k) {
        std::size_t const i = read_plls_[k];
        Space const v = bus_voltage(i);
        plls_[i].step(v.alpha, v.beta, h);
    }
}

void EmtEngine::will_read(std::span<std::size_t const> signals) {
    read_plls_.clear();
    for (auto const& [signal, bus] : pll_signals_) {
        if (std::find(signals.begin(), signals.end(), signal) != signals.end() &&
            (read_plls_.empty() || read_plls_.back() != bus)) {
            read_plls_.push_back(bus);
        }
    }
}

Space EmtEngine::bus_voltage(std::size_t bus) const {
    int const node = parts_.bus_node[bus];
    return to_space(solver_.node_voltage(node), solver_.node_voltage(node + 1), solver_.node_voltage(node + 2));
}

Space EmtEngine::switch_space(std::size_t index) const {
    return to_space(solver_.switch_current(index, 0), solver_.switch_current(index, 1),
                    solver_.switch_current(index, 2));
}

std::complex<double> EmtEngine::switch_power(std::size_t bus, std::size_t index) const {
    Space const v = bus_voltage(bus), i = switch_space(index);
    return {1.5e-3 * (v.alpha * i.alpha + v.beta * i.beta + 2 * v.zero * i.zero),
            1.5e-3 * (v.beta * i.alpha - v.alpha * i.beta)};
}

namespace {

/// Waves that the step cannot resolve would appear as others.
Result<void> check_step(Network const& n, Circuit const& c, double step_s) {
    if (step_s * n.frequency_hz * kMinStepsPerPeriod > 1) {
        return fail(ExitCode::usage,
                    fmt::format("a step of {} s is too long for {} Hz: a period needs at least {} steps",
                                shortest(step_s), shortest(n.frequency_hz), kMinStepsPerPeriod),
                    fmt::format("a step of at most {:.3g} s", 1 / (kMinStepsPerPeriod * n.frequency_hz)));
    }
    for (VoltageSource const& s : c.sources) {
        for (VoltageSource::Harmonic const& h : s.harmonics) {
            double const hz = h.order * n.frequency_hz;
            if (2 * step_s * hz >= 1) {
                return fail(ExitCode::usage,
                            fmt::format("harmonic {} of source '{}' has {:.4g} Hz, which steps of {:.4g} s cannot show",
                                        h.order, s.name, hz, step_s),
                            fmt::format("a step below {:.3g} s", 1 / (2 * hz)));
            }
        }
    }
    auto const check_travel = [&](std::string const& line, double tau) -> Result<void> {
        if (tau < step_s) {
            return fail(ExitCode::usage,
                        fmt::format("line '{}': a wave travels along it in {:.3g} us, less than a step of {:.3g} us",
                                    line, tau * 1e6, step_s * 1e6),
                        "use `model: pi` for this line, or a shorter step_s");
        }
        return {};
    };
    Result<void> ok;
    for (std::size_t i = 0; ok && i < c.bergeron.size(); ++i) {
        ok = check_travel(c.bergeron[i].name, std::min(c.bergeron[i].tau1, c.bergeron[i].tau0));
    }
    for (std::size_t i = 0; ok && i < c.marti.size(); ++i) {
        ok = check_travel(c.marti[i].name, std::min(c.marti[i].positive.tau_s, c.marti[i].zero.tau_s));
    }
    return ok;
}

} // namespace

Result<std::unique_ptr<Engine>> make_emt_engine(Network network, EmtOptions options) {
    auto parts = make_circuit(network, options.start_hour_of_day);
    if (!parts) {
        return std::unexpected{parts.error()};
    }
    if (options.step.quanta <= 0) {
        return fail(ExitCode::usage, "the waveform solver needs a step longer than 0");
    }
    double const step_s = options.time_base.seconds(options.step);
    if (auto ok = check_step(network, parts->circuit, step_s); !ok) {
        return std::unexpected{ok.error()};
    }
    return std::make_unique<EmtEngine>(std::move(network), std::move(*parts), options);
}

} // namespace gridspace::sim::emt
