// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/emt_engine_impl.hpp"

#include "common/text.hpp"
#include "sim/components/faces/converter.hpp"
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
      solver_{parts_.circuit, options_.time_base.seconds(options_.step)}, one_ports_{one_ports(network_)} {
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
    PowerFlowOptions options;
    options.start_hour_of_day = options_.start_hour_of_day;
    options.enforce_q_limits = true; // as the converters of generators do
    auto const flow = solve_power_flow(network_, SwitchState{network_}, options);
    if (!flow) {
        return std::unexpected{flow.error()};
    }
    std::vector<Solver::MachineStart> starts;
    for (std::size_t m = 0; m < network_.machines.size(); ++m) {
        std::size_t const bus = index_of(network_.buses, network_.machines[m].bus.name);
        std::complex<double> const v = flow->buses[bus].v * parts_.bus_peak_v[bus];
        std::complex<double> const s{flow->machines[m].p_kw * 1e3, flow->machines[m].q_kvar * 1e3};
        starts.push_back({v, v == 0.0 ? 0.0 : std::conj(s * 2.0 / (3.0 * v))});
    }
    std::complex<double> const turn = std::polar(1.0, 2 * std::numbers::pi / 3);
    std::vector<BusPhases> bus_v;
    for (auto const& bus : flow->buses) {
        bus_v.push_back({bus.v, bus.v / turn, bus.v * turn});
    }
    std::vector<double> generator_kvar;
    for (std::size_t g = 0; g < flow->generators.size(); ++g) {
        auto const& unit = flow->generators[g];
        Generator const& generator = network_.generators[g];
        double const kva = std::hypot(unit.p_kw, unit.q_kvar), most = kConverterOverload * generator.rating_kva;
        double const v = std::abs(flow->buses[index_of(network_.buses, generator.bus.name)].v);
        if (generator.role == GeneratorRole::pv && most > 0 && kva > most * v) {
            return fail(
                ExitCode::usage,
                fmt::format("generator '{}' would have to give {:.4g} kVA at the start, more than the {:.4g} kVA "
                            "that its converter can ({} of rating_kva)",
                            generator.name.name, kva, most * v, kConverterOverload),
                "give it a larger rating_kva, reactive limits, or less power");
        }
        generator_kvar.push_back(unit.q_kvar);
    }
    return begin(starts, start_injections(bus_v, generator_kvar));
}

Result<void> EmtEngine::initialise_unbalanced() {
    ThreePhaseOptions options;
    options.start_hour_of_day = options_.start_hour_of_day;
    auto const flow = solve_three_phase(network_, SwitchState{network_}, options);
    if (!flow) {
        return std::unexpected{flow.error()};
    }
    std::vector<BusPhases> bus_v;
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        BusPhases v = flow->buses[i];
        for (auto& phase : v) {
            phase *= std::numbers::sqrt2 / parts_.bus_peak_v[i];
        }
        bus_v.push_back(v);
    }
    return begin({}, start_injections(bus_v, std::vector<double>(network_.generators.size(), 0.0)));
}

Result<void> EmtEngine::begin(std::vector<Solver::MachineStart> const& starts,
                              std::vector<BusPhases> const& injections) {
    if (auto ok = solver_.start(starts, injections); !ok) {
        return ok;
    }
    if (auto const floating = solver_.floating_nodes(); !floating.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("nothing connects {} to earth: its voltage is undefined", floating.front()),
                    "earth a star point, or add a load, a shunt or line capacitance there");
    }
    for (EmtMachine const& m : solver_.machines()) {
        auto const& avr = m.data().avr;
        double const efd = m.state()[machines::kEfd];
        if (avr && (efd > avr->efd_max_pu || efd < avr->efd_min_pu)) {
            auto const i = static_cast<std::size_t>(&m - solver_.machines().data());
            return fail(
                ExitCode::usage,
                fmt::format(
                    "machine '{}' needs a field voltage of {:.3f} p.u. at the start, outside its limits {} to {}",
                    network_.machines[i].name.name, efd, shortest(avr->efd_min_pu), shortest(avr->efd_max_pu)),
                "ask it for less reactive power (voltage_setpoint_pu), or widen efd_min_pu and efd_max_pu");
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
    for (std::size_t f = 0; f < converters_.size(); ++f) {
        auto const i = parts_.injections[f].by_phase ? phase_currents_[f].currents(h) : converters_[f].currents(h);
        std::copy(i.begin(), i.end(), solver_.injected().begin() + static_cast<std::ptrdiff_t>(3 * f));
    }
    if (auto ok = solver_.advance(t_end, h); !ok) {
        return ok;
    }
    for (std::size_t const i : read_plls_) {
        Space const v = bus_voltage(i);
        plls_[i].step(v.alpha, v.beta, h);
    }
    step_injections(t_end, h);
    for (Instrument& i : instruments_) {
        if (i.transformer.dynamic()) {
            i.transformer.step(instrument_input(i), h);
        }
    }
    return {};
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
Result<void> check_step(Network const& n, double step_s) {
    if (step_s * n.frequency_hz * kMinStepsPerPeriod > 1) {
        return fail(ExitCode::usage,
                    fmt::format("a step of {} s is too long for {} Hz: a period needs at least {} steps",
                                shortest(step_s), shortest(n.frequency_hz), kMinStepsPerPeriod),
                    fmt::format("a step of at most {:.3g} s", 1 / (kMinStepsPerPeriod * n.frequency_hz)));
    }
    for (Source const& s : n.sources) {
        for (Source::Harmonic const& h : s.harmonics) {
            double const hz = static_cast<double>(h.order) * n.frequency_hz;
            if (2 * step_s * hz >= 1) {
                return fail(ExitCode::usage,
                            fmt::format("harmonic {} of source '{}' has {:.4g} Hz, which steps of {:.4g} s cannot show",
                                        h.order, s.name.name, hz, step_s),
                            fmt::format("a step below {:.3g} s", 1 / (2 * hz)));
            }
        }
    }
    return {};
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
    if (auto ok = check_step(network, step_s); !ok) {
        return std::unexpected{ok.error()};
    }
    for (BergeronLine const& line : parts->circuit.bergeron) {
        double const tau = std::min(line.tau1, line.tau0);
        if (tau < step_s) {
            return fail(ExitCode::usage,
                        fmt::format("line '{}': a wave travels along it in {:.3g} us, less than a step of {:.3g} us",
                                    line.name, tau * 1e6, step_s * 1e6),
                        "use `model: pi` for this line, or a shorter step_s");
        }
    }
    return std::make_unique<EmtEngine>(std::move(network), std::move(*parts), options);
}

} // namespace gridspace::sim::emt
