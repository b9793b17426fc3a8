// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/team.hpp"
#include "sim/emt/bergeron.hpp"
#include "sim/emt/nodal_system.hpp"

#include <complex>
#include <limits>
#include <memory>
#include <span>
#include <vector>

namespace gridspace::sim::emt {

/// Fixed-step simulation of a circuit: trapezoidal rule, two backward Euler half steps after every discontinuity, poles
/// that open at the exact zero of their current inside a step (docs/design/emt.md). A step allocates nothing; an event
/// may.
class Solver {
  public:
    /// `step_s` is the usual step; others cost a factorisation. `team`: who does the parts of a large circuit at once;
    /// nobody: one after the other. The results are the same.
    Solver(Circuit circuit, double step_s, std::shared_ptr<Team> team = nullptr);

    /// Steady state at time 0 with these terminal voltages (V peak) and currents (A peak, into the network; positive
    /// sequence phasors) of Norton elements, and injected currents (A peak, by phase), by injection; every other
    /// element follows from the network equations.
    struct NortonStart {
        std::complex<double> v, i;
    };
    [[nodiscard]] Result<void> start(std::vector<NortonStart> const& norton,
                                     std::vector<std::array<std::complex<double>, 3>> const& injections = {},
                                     bool unbalanced = false);
    /// The steady state that start() has found: voltage of a node (V peak), and what it made of a Norton element.
    [[nodiscard]] std::complex<double> start_voltage(int node) const;
    [[nodiscard]] NortonStart start_of(std::size_t norton) const { return started_[norton]; }

    /// Simulates from t() to `t_end`, which is `h` away.
    [[nodiscard]] Result<void> advance(double t_end, double h);

    // Switching: takes effect at t().
    void close_switch(std::size_t index);
    void open_switch(std::size_t index, Opening const& how);
    void open_switch(std::size_t index) { open_switch(index, Opening{}); }
    void apply_fault(std::size_t fault);
    /// Every phase of the fault ends at its next current zero.
    void clear_fault(std::size_t fault);
    /// The circuit, for changes of elements and new ones; then rebuild().
    [[nodiscard]] Circuit& circuit() { return circuit_; }
    [[nodiscard]] Circuit const& circuit() const { return circuit_; }
    /// After changes of the circuit. New elements start without current; indices do not change.
    void rebuild();
    // Before rebuild(), where an element's change must not leave what would have to die away:
    /// An inductor's current goes with its flux.
    void keep_flux(int branch, double l_before_h, double l_h);
    /// An inductor begins with the flux, and a capacitor with the voltage, that it would have if it had always been
    /// there: beside an RL branch with the same voltage.
    void start_inductor(int branch, int beside);
    void start_capacitor(int branch, int beside);
    /// Splits an RL branch in two at a share of its length, with the same current in both; returns the second part's
    /// index.
    [[nodiscard]] int split_rl(int branch, double share, std::string const& name);
    /// Cuts a travelling-wave line in two at a share of its length, with the waves that are on their way. A piece that
    /// a wave passes in less than a step becomes an RL branch, with its capacitance at the cut.
    struct WaveParts {
        int near_index{0}, far_index{0}; ///< of Bergeron lines or rl branches
        bool near_is_wave{true}, far_is_wave{true};
    };
    [[nodiscard]] WaveParts split_wave(int line, double share, std::string const& name);
    /// The same for a coupled inductive branch.
    [[nodiscard]] int split_coupled(int branch, double share, std::string const& name);
    void set_source_frequency(std::size_t source, double frequency_hz);
    void set_source_amplitude(std::size_t source, double amplitude_v);

    [[nodiscard]] double t() const { return t_; }
    [[nodiscard]] double node_voltage(int node) const {
        return state_.v[static_cast<std::size_t>(system_->topology.slot[static_cast<std::size_t>(node)])];
    }
    [[nodiscard]] double current(CurrentTerm const& term, int phase) const;
    [[nodiscard]] double switch_current(std::size_t index, int phase) const;
    [[nodiscard]] double fault_current(std::size_t index, int phase) const;
    [[nodiscard]] bool pole_closed(std::size_t index, int phase) const {
        return bits_.closed[index][static_cast<std::size_t>(phase)];
    }
    [[nodiscard]] bool opening(std::size_t index) const; ///< commanded, and not yet open
    /// When the last pole opened; NaN before.
    [[nodiscard]] double opened_at(std::size_t index) const { return switches_[index].opened_at; }
    /// Injected currents, A, that hold until changed: 3 per injection.
    [[nodiscard]] std::vector<double>& injected() { return injected_; }
    /// Unknown nodes that nothing connects to earth, at the start.
    [[nodiscard]] std::vector<std::string> floating_nodes() const;
    [[nodiscard]] int unknowns() const { return system_->topology.unknowns; }
    [[nodiscard]] bool dense() const { return system_->dense; }
    /// Parts that are stepped at the same time.
    [[nodiscard]] std::size_t parts() const { return system_ == nullptr ? 1 : system_->shares.parts.size(); }
    /// The injections at the nodes of a part, in ascending order. Who steps what feeds them in these parts finds their
    /// voltages in the cache of the same processor.
    [[nodiscard]] std::span<int const> injections(std::size_t part) const {
        return system_ == nullptr ? all_injections_ : system_->shares.parts[part].injections.index;
    }

    /// Does this for each part, at the same time where there are several.
    template <class Job>
    void each_part(Job const& job) {
        if (parts() == 1) {
            job(std::size_t{0});
        } else {
            team_->run([&](int part) { job(static_cast<std::size_t>(part)); });
        }
    }

  private:
    std::vector<std::complex<double>> start_v_; ///< by slot
    std::vector<NortonStart> started_;
    /// What a trial step changes, apart from the Norton elements.
    struct Dynamics {
        std::vector<double> v; ///< by slot
        std::vector<double> rl_v, rl_i, capacitor_v, capacitor_i, coupled_v, coupled_i, winding_v, winding_i;
        std::vector<double> core_flux, core_v, core_i;
        std::vector<double> wave_i, marti_i; ///< 6 per line
        std::vector<std::size_t> wave_marks; ///< of waves_, when saved
    };
    struct SwitchControl {
        static constexpr double kNever = std::numeric_limits<double>::infinity();
        std::array<bool, 3> armed{};
        std::array<double, 3> part_at{kNever, kNever, kNever};
        double chop_a{0};
        bool at_once{false};
        double opened_at{std::numeric_limits<double>::quiet_NaN()};
    };
    struct Crossing {
        double share{2};
        bool found{false};
    };

    [[nodiscard]] Result<void> segment(double t_end, double h);
    void substep(double t_end, double h, Rule rule, StepCoefficients const& c);
    // Of one share (Shares), which may run in parallel with others:
    void histories(std::size_t share, double t_end, Rule rule, StepCoefficients const& c);
    void predict(std::size_t share, double t_end, double h, Rule rule);
    void correct(std::size_t share);
    void finish(std::size_t share, Rule rule, StepCoefficients const& c);
    void currents(Share const& share, StepCoefficients const& c);
    void waves(Share const& share, Rule rule, StepCoefficients const& c);
    void cores(Share const& share, Rule rule, StepCoefficients const& c);
    template <class Job>
    void with_solution(Job const& job);
    // Between those:
    void source_voltages(double t);
    void fill_rest();
    void solve_rest();
    void resize();
    [[nodiscard]] Result<void> use(double h);
    void part_contacts();
    void switched();
    /// The first zero of an armed current or knee of a core in the segment that was just tried.
    [[nodiscard]] Crossing first_crossing(bool look_at_cores);
    void open_crossed(double share);
    void remember_currents(std::vector<double>& out) const;
    [[nodiscard]] bool watching() const;
    [[nodiscard]] Result<void> check() const;

    Circuit circuit_;
    double step_s_;
    std::shared_ptr<Team> team_;
    double t_{0};
    double damping_s_{0}; ///< for so long backward Euler steps follow a discontinuity
    bool modified_{true}; ///< bits_ are not those of system_
    SwitchBits bits_;
    std::vector<SwitchControl> switches_;
    std::vector<std::array<bool, 3>> fault_armed_;
    bool armed_{false}, waiting_{false};
    Dynamics state_, saved_;
    std::vector<BergeronWaves> waves_;
    std::vector<MartiWaves> marti_;
    std::vector<double> wave_history_, marti_history_, rl_history_, capacitor_history_, coupled_history_,
        winding_history_, core_history_, norton_i_, correction_, injected_;
    std::vector<std::vector<double>> rhs_; ///< by share, and of the rest; each has its own unknowns
    std::vector<int> all_injections_;
    std::vector<double> watched_before_, watched_after_; ///< currents of armed poles at both ends of a segment
    std::vector<double> core_share_;       ///< by core: where in the segment its flux passes a knee; 2: nowhere
    std::vector<signed char> core_beyond_; ///< and the slope that it enters there
    StepCoefficients usual_, other_;
    StepCoefficients const* coefficients_{nullptr};
    std::vector<std::shared_ptr<NodalSystem>> cache_; ///< of the usual step
    std::shared_ptr<NodalSystem> odd_;                ///< of another step
    NodalSystem* system_{nullptr};
    std::uint64_t uses_{0};
    std::vector<double> source_phase_, source_since_; ///< phase at, s
    double limit_v_{0};                               ///< voltages beyond are divergence

    /// Nothing is cut shorter than this share of the usual step.
    static constexpr double kDampedSteps = 2; ///< one leaves 4 % of what a chopped current rings with
    static constexpr double kMinSegment = 1e-5;
    /// Cores that change slope to and fro at one instant keep theirs for a segment after so many changes.
    static constexpr int kMaxChangesAtOnce = 12;
};

} // namespace gridspace::sim::emt
