// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/stepper.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::fmi {

Result<Advance> advance(Instance& instance, CoSimulation const& can, std::string const& fmu, double from_s,
                        double step_s) {
    constexpr int kMostSteps = 100'000; // of one period
    bool const may_roll_back = can.can_get_and_set_state && can.variable_step;
    double const end_s = from_s + step_s;
    double const least_s = step_s / (1 << kHalvings);
    double const close_s = step_s * 1e-9; // what is left is rounding
    double piece_s = step_s;
    Advance out{.reached_s = from_s};
    while (end_s - out.reached_s > close_s) {
        if (out.steps + out.discarded >= kMostSteps) {
            return fail(ExitCode::child_died,
                        fmt::format("{}: more than {} steps from {} s to {} s", fmu, kMostSteps, from_s, end_s));
        }
        double const at_s = out.reached_s;
        double const now_s = std::min(piece_s, out.steps == 0 ? step_s : end_s - at_s);
        if (may_roll_back) {
            if (auto ok = instance.keep_state(); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        auto const step = instance.do_step(at_s, now_s, may_roll_back);
        if (!step) {
            return std::unexpected{step.error()};
        }
        if (step->terminated) {
            out.terminated = true;
            out.reached_s = step->reached_s;
            return out;
        }
        if (step->discarded) {
            ++out.discarded;
            piece_s = now_s / 2;
            if (!may_roll_back || piece_s < least_s) {
                return fail(ExitCode::child_died,
                            fmt::format("{}: the step from {} s to {} s was discarded; it came to {} s", fmu, at_s,
                                        at_s + now_s, step->reached_s),
                            may_roll_back ? fmt::format("not even a step of {} s is possible there", now_s)
                                          : "it cannot set its state back and repeat the step with a smaller one "
                                            "(canGetAndSetFMUState, canHandleVariableCommunicationStepSize): a shorter "
                                            "period_s may help");
            }
            if (auto ok = instance.restore_state(); !ok) {
                return std::unexpected{ok.error()};
            }
            continue;
        }
        if (!(step->reached_s > at_s)) {
            return fail(ExitCode::child_died,
                        fmt::format("{}: a step from {} s ended early at {} s", fmu, at_s, step->reached_s),
                        "its time has to go on");
        }
        ++out.steps;
        out.reached_s = step->reached_s;
    }
    out.reached_s = end_s;
    return out;
}

} // namespace gridspace::fmi
