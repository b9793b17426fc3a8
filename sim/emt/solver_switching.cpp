// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/solver.hpp"

#include <algorithm>
#include <cmath>

/// Poles, fault phases and iron cores: when they change state inside a step, and what that does.
namespace gridspace::sim::emt {
namespace {

/// A pole without current opens at once; rounding noise is no current.
constexpr double kNoCurrentA = 1e-7;

} // namespace

bool Solver::watching() const {
    return armed_ || !circuit_.cores.empty();
}

void Solver::remember_currents(std::vector<double>& out) const {
    double* o = out.data();
    for (std::size_t s = 0; s < switches_.size(); ++s) {
        for (int k = 0; k < 3; ++k) {
            *o++ = switches_[s].armed[static_cast<std::size_t>(k)] ? switch_current(s, k) : 0;
        }
    }
    for (std::size_t f = 0; f < fault_armed_.size(); ++f) {
        for (int k = 0; k < 3; ++k) {
            *o++ = fault_armed_[f][static_cast<std::size_t>(k)] ? fault_current(f, k) : 0;
        }
    }
}

namespace {

/// Where a current that was `before` and is `after` falls to `chop` or passes through zero, as a share of the segment;
/// 2 when it does not.
double end_share(double before, double after, double chop = 0) {
    if (std::abs(before) <= std::max(chop, kNoCurrentA)) {
        return 0;
    }
    bool const ends = before * after <= 0 || std::abs(after) <= chop;
    return ends ? (before - std::copysign(chop, before)) / (before - after) : 2;
}

/// Where the flux of a core leaves its segment; 2 when it does not.
double knee_share(double before, double after, double knee, int segment) {
    double const level = segment == 0 ? (after > 0 ? knee : -knee) : segment * knee;
    bool const leaves = segment == 0 ? std::abs(after) > knee : segment * after < knee;
    return leaves ? std::clamp((level - before) / (after - before), 0.0, 1.0) : 2;
}

} // namespace

Solver::Crossing Solver::first_crossing(bool look_at_cores) {
    Crossing first;
    auto const consider = [&](double share) {
        if (share <= 1 && share < first.share) {
            first = {share, true};
        }
    };
    std::size_t o = 0;
    for (SwitchControl const& s : switches_) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (s.armed[k]) {
                consider(end_share(watched_before_[o], watched_after_[o], s.chop_a));
            }
        }
    }
    for (auto const& armed : fault_armed_) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (armed[k]) {
                consider(end_share(watched_before_[o], watched_after_[o]));
            }
        }
    }
    for (std::size_t c = 0; c < circuit_.cores.size(); ++c) {
        double const before = saved_.core_flux[c], after = state_.core_flux[c];
        signed char const slope = bits_.segment[c];
        core_share_[c] = look_at_cores ? knee_share(before, after, circuit_.cores[c].knee, slope) : 2;
        core_beyond_[c] = static_cast<signed char>(slope != 0 ? 0 : after > 0 ? 1 : -1);
        consider(core_share_[c]);
    }
    return first;
}

void Solver::open_crossed(double share) {
    constexpr double kTogether = 1e-9; // currents that are each other's negative cross at one instant
    std::size_t o = 0;
    auto const ends = [&](bool armed, double chop_a) {
        return armed && end_share(watched_before_[o], watched_after_[o], chop_a) <= share + kTogether;
    };
    armed_ = false;
    for (std::size_t s = 0; s < switches_.size(); ++s) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (ends(switches_[s].armed[k], switches_[s].chop_a)) {
                switches_[s].armed[k] = false;
                bits_.closed[s][k] = false;
                auto const& closed = bits_.closed[s];
                if (!closed[0] && !closed[1] && !closed[2]) {
                    switches_[s].opened_at = t_;
                }
            }
            armed_ = armed_ || switches_[s].armed[k];
        }
    }
    for (std::size_t f = 0; f < fault_armed_.size(); ++f) {
        for (std::size_t k = 0; k < 3; ++k, ++o) {
            if (ends(fault_armed_[f][k], 0)) {
                fault_armed_[f][k] = false;
                bits_.faulted[f][k] = false;
            }
            armed_ = armed_ || fault_armed_[f][k];
        }
    }
    for (std::size_t c = 0; c < circuit_.cores.size(); ++c) {
        if (core_share_[c] <= share + kTogether) {
            bits_.segment[c] = core_beyond_[c];
        }
    }
    switched();
}

void Solver::switched() {
    damping_s_ = kDampedSteps * step_s_;
    modified_ = true;
}

void Solver::part_contacts() {
    if (!waiting_) {
        return;
    }
    waiting_ = false;
    for (std::size_t i = 0; i < switches_.size(); ++i) {
        SwitchControl& s = switches_[i];
        auto& closed = bits_.closed[i];
        for (std::size_t k = 0; k < 3; ++k) {
            if (s.part_at[k] <= t_ + kMinSegment * step_s_) {
                s.part_at[k] = SwitchControl::kNever;
                if (s.at_once) {
                    closed[k] = false;
                    s.opened_at = closed == std::array{false, false, false} ? t_ : s.opened_at;
                    switched();
                } else {
                    s.armed[k] = closed[k];
                    armed_ = true;
                }
            }
            waiting_ = waiting_ || s.part_at[k] < SwitchControl::kNever;
        }
    }
}

void Solver::open_switch(std::size_t index, Opening const& how) {
    SwitchControl& s = switches_[index];
    for (std::size_t k = 0; k < 3; ++k) {
        if (how.poles[k] && bits_.closed[index][k] && s.part_at[k] == SwitchControl::kNever && !s.armed[k]) {
            s.part_at[k] = t_ + how.after_s;
            s.chop_a = how.chop_a;
            s.at_once = how.at_once;
            waiting_ = true;
        }
    }
}

void Solver::close_switch(std::size_t index) {
    SwitchControl& s = switches_[index];
    s.part_at.fill(SwitchControl::kNever);
    s.armed = {};
    if (bits_.closed[index] != std::array{true, true, true}) {
        bits_.closed[index] = {true, true, true};
        switched();
    }
}

bool Solver::opening(std::size_t index) const {
    SwitchControl const& s = switches_[index];
    return std::ranges::any_of(s.part_at, [](double at) { return at < SwitchControl::kNever; }) ||
           s.armed != std::array{false, false, false};
}

void Solver::apply_fault(std::size_t fault) {
    bits_.faulted[fault] = circuit_.faults[fault].phases;
    fault_armed_[fault] = {};
    switched();
}

void Solver::clear_fault(std::size_t fault) {
    fault_armed_[fault] = bits_.faulted[fault];
    armed_ = true;
}

} // namespace gridspace::sim::emt
