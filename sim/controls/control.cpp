// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/controls/control.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim {
Control::Control(std::string path, std::string name, Limits const& limits, Grid const& grid, double start)
    : path_{std::move(path)}, name_{std::move(name)}, limits_{limits}, grid_{grid}, value_{start}, target_{start} {
    std::int64_t const points = grid.base.ceil(Rational{1, 1000}).quanta; // not closer than that
    std::int64_t const steps = std::max<std::int64_t>(1, (points + grid.step.quanta - 1) / grid.step.quanta);
    grid_.step = grid.step * steps;
}

void Control::take(Simulation& simulation, SimTime at, std::string_view process, double value, double valid_for_s) {
    holder_ = source_ = process;
    told_ = at;
    lost_at_.reset();
    falls_at_.reset();
    if (valid_for_s > 0) {
        lost_at_ = grid_.base.later(at, valid_for_s);
    }
    if (limits_.hold_s) {
        falls_at_ = grid_.base.later(lost_at_.value_or(at), *limits_.hold_s);
    }
    steer(simulation, at, value);
}

void Control::steer(Simulation& simulation, SimTime at, double target) {
    if (value_ == target_) {
        at_ = at; // nothing was under way
    }
    target_ = target;
    if (!limits_.ramp_per_s) {
        value_ = target;
        at_ = at;
        simulation.request(at, SetParameter{path_, value_}, name_);
    }
}

void Control::ramp(Simulation& simulation, SimTime until) {
    while (value_ != target_) {
        SimTime const next{(at_.quanta / grid_.step.quanta + 1) * grid_.step.quanta};
        if (next > until) {
            return;
        }
        double const far = *limits_.ramp_per_s * grid_.base.seconds(next - at_);
        value_ = target_ > value_ ? std::min(target_, value_ + far) : std::max(target_, value_ - far);
        at_ = next;
        simulation.request(next, SetParameter{path_, value_}, name_);
    }
}

std::optional<SimTime> Control::next_end(SimTime until) const {
    std::optional<SimTime> end = lost_at_;
    if (falls_at_ && (!end || *falls_at_ < *end)) {
        end = falls_at_;
    }
    return end && *end <= until ? end : std::nullopt;
}

std::string Control::lost() {
    lost_at_.reset();
    holder_.clear();
    return fmt::format("{}: nothing new from '{}' since {} s; {}", name_, source_, shortest(grid_.base.seconds(told_)),
                       limits_.hold_s
                           ? fmt::format("held for {} s, then {}", shortest(*limits_.hold_s), shortest(limits_.then))
                           : "held");
}

std::string Control::fall_back(Simulation& simulation) {
    SimTime const at = *falls_at_;
    falls_at_.reset();
    holder_.clear();
    steer(simulation, at, limits_.then);
    return fmt::format("{}: nothing new from '{}' since {} s; it goes to {}", name_, source_,
                       shortest(grid_.base.seconds(told_)), shortest(limits_.then));
}

} // namespace gridspace::sim
