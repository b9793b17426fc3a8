// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/induction_machine/induction_equations.hpp"

#include <algorithm>
#include <cmath>

/// An induction machine in the phasor simulation: its stator without transients, v = rs i + j psi. The rest of the
/// order stays: three with one cage, five with two.
namespace gridspace::sim {
namespace {

class InductionInjection final : public PhasorInjection {
  public:
    InductionInjection(InductionMachine const& machine, Surroundings const& around)
        : PhasorInjection{around.bus(machine.bus)}, machine_{machine}, prefix_{signal_prefix(machine)},
          to_network_{machine.rating_kva / around.base_kva()}, w0_{around.omega()} {}

    [[nodiscard]] std::size_t states() const override { return machine_.states(); }
    void start(double, Complex v, Complex, std::span<double> x) override {
        induction::State const start = machine_.steady_state(v);
        std::copy_n(start.begin(), x.size(), x.begin());
        start_v_ = std::abs(v);
    }
    [[nodiscard]] Result<void> check_start(std::span<double const>) const override {
        return machine_.check_start(start_v_);
    }
    Complex flow(double, std::span<double const> states, Complex v, std::span<double> dx) const override {
        induction::State const x = state_of(states);
        Complex const i = current(x, v);
        induction::State d{};
        machine_.derivative(x, i, w0_, d);
        std::copy_n(d.begin(), dx.size(), dx.begin());
        return -i * to_network_;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override {
        std::vector<SignalDef> out{{prefix_ + ".p_kw", "kW"}, {prefix_ + ".q_kvar", "kvar"}};
        for (SignalDef const& own : induction::signals()) {
            out.push_back({prefix_ + "." + own.name, own.unit});
        }
        return out;
    }
    [[nodiscard]] double value(std::size_t index, double, std::span<double const> states, Complex v) const override {
        induction::State const x = state_of(states);
        Complex const i = current(x, v), s = v * std::conj(i) * machine_.rating_kva();
        return index == 0 ? s.real() : index == 1 ? s.imag() : induction::signal(index - 2, machine_, x, i);
    }
    bool set(double, std::string_view, double value) override {
        machine_.set_load_kw(value);
        return true;
    }

  private:
    static induction::State state_of(std::span<double const> states) {
        induction::State x{};
        std::copy(states.begin(), states.end(), x.begin());
        return x;
    }
    [[nodiscard]] Complex current(induction::State const& x, Complex v) const {
        return connected() && v != Complex{} ? (v - Complex{0, 1} * machine_.flux(x)) /
                                                   Complex{machine_.resistance(), machine_.subtransient_reactance()}
                                             : Complex{};
    }
    induction::Machine machine_;
    std::string prefix_;
    double to_network_; ///< own rating over the network's base
    double w0_;
    double start_v_{0};
};

} // namespace

std::unique_ptr<PhasorInjection> InductionMachine::phasor(Surroundings const& around) const {
    return std::make_unique<InductionInjection>(*this, around);
}

} // namespace gridspace::sim
