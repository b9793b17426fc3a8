// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/controls/control_config.hpp"
#include "sim/runtime/simulation.hpp"

namespace gridspace::sim {

/// One quantity of one element that may be steered: who holds it, where it is and where it goes. What it wants of the
/// element are requests to the simulation. A ramp is a staircase: a point at each step, at most one in a millisecond.
class Control {
  public:
    struct Limits {
        config::NumberSpec allowed{};
        std::optional<double> ramp_per_s;
        std::optional<double> hold_s;
        double then{0};
    };
    struct Grid {
        TimeBase base;
        SimSpan step;
        SimTime end{INT64_MAX}; ///< of the run
    };
    /// `path` as `set:` of an event writes it; `start`: the value before anybody has steered.
    Control(std::string path, std::string name, Limits const& limits, Grid const& grid, double start);

    [[nodiscard]] std::string const& name() const { return name_; }
    [[nodiscard]] Limits const& limits() const { return limits_; }
    /// Whose set-point holds now; empty: nobody's.
    [[nodiscard]] std::string const& holder() const { return holder_; }

    /// A set-point that takes effect at `at`; follow() has come as far. `valid_for_s`: 0 says nothing.
    void take(Simulation& simulation, SimTime at, std::string_view process, double value, double valid_for_s);
    /// Ramp, loss of the source and fallback up to `until`. `tell(SimTime, event, text)` hears of the two latter.
    template <class Tell>
    void follow(Simulation& simulation, SimTime until, Tell&& tell) {
        while (std::optional<SimTime> const end = next_end(until)) {
            ramp(simulation, *end);
            if (lost_at_ == end) {
                tell(*end, "control_lost", lost());
            }
            if (falls_at_ == end) {
                tell(*end, "control_fallback", fall_back(simulation));
            }
        }
        ramp(simulation, until);
    }

  private:
    [[nodiscard]] std::optional<SimTime> next_end(SimTime until) const;
    void steer(Simulation& simulation, SimTime at, double target);
    void ramp(Simulation& simulation, SimTime until);
    [[nodiscard]] std::string lost();
    [[nodiscard]] std::string fall_back(Simulation& simulation);

    std::string path_, name_;
    Limits limits_;
    Grid grid_;
    double value_, target_;
    SimTime at_;   ///< when value_ was so
    SimTime told_; ///< when the last set-point took effect
    std::string holder_, source_;
    std::optional<SimTime> lost_at_, falls_at_;
};

} // namespace gridspace::sim
