// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/model_run.hpp"

#include "agents/fmu/fmu_values.hpp"
#include "fmi/stepper.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::agents {

ModelRun::ModelRun(Settings settings, std::unique_ptr<fmi::Instance> instance, CallGuard& guard)
    : settings_{std::move(settings)}, guard_{guard}, instance_{std::move(instance)} {
    for (mapping::Field const& field : settings_.table.variables) {
        values_.push_back({field.type, 0, 0, {}});
    }
}

Result<bool> ModelRun::resume() {
    auto const saved = load_state(settings_.state_file);
    if (!saved) {
        return std::unexpected{saved.error()};
    }
    if (!*saved) {
        return false;
    }
    if (auto ok = instance_->deserialize((*saved)->octets); !ok) {
        return std::unexpected{ok.error()};
    }
    at_ = (*saved)->time;
    return true;
}

Result<bool> ModelRun::exchange(SimTime point) {
    guard_.now(settings_.base.seconds(point));
    if (ended_) {
        return false;
    }
    if (!at_) {
        if (auto ok = start(point); !ok) {
            return std::unexpected{ok.error()};
        }
    } else {
        auto const goes_on = step_to(point);
        if (!goes_on || !*goes_on) {
            return goes_on;
        }
        if (auto ok = take_inputs(); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    if (auto ok = give_outputs(point); !ok) {
        return std::unexpected{ok.error()};
    }
    if (!settings_.state_file.empty()) {
        auto octets = instance_->serialize();
        auto const kept = octets ? save({point, std::move(*octets)}, settings_.state_file)
                                 : Result<void>{std::unexpected{octets.error()}};
        if (!kept) {
            return std::unexpected{kept.error()};
        }
    }
    return true;
}

Result<void> ModelRun::start(SimTime point) {
    for (FmuTable::Start const& one : settings_.table.start) {
        if (auto ok = instance_->set(variable(one.variable), one.value); !ok) {
            return ok;
        }
    }
    auto ok = instance_->enter_initialization(settings_.base.seconds(point), settings_.config.tolerance);
    ok = ok ? take_inputs() : ok;
    ok = ok ? instance_->exit_initialization() : ok;
    at_ = point;
    return ok;
}

Result<void> ModelRun::take_inputs() {
    for (auto const& [at, value] : inputs_) {
        if (auto ok = instance_->set(variable(at), value); !ok) {
            return ok;
        }
    }
    return {};
}

/// Period by period: after a pause, or with a state of before, the FMU makes up for the time that has passed.
Result<bool> ModelRun::step_to(SimTime point) {
    while (*at_ < point) {
        auto const done = fmi::advance(*instance_, *settings_.description.co_simulation, settings_.description.file,
                                       settings_.base.seconds(*at_), settings_.config.period_s.to_double());
        if (!done) {
            return std::unexpected{done.error()};
        }
        if (done->terminated) {
            ended_ = true;
            return false;
        }
        at_ = *at_ + settings_.period;
    }
    return true;
}

Result<void> ModelRun::give_outputs(SimTime point) {
    for (std::size_t const at : settings_.table.read) {
        auto value = instance_->get(variable(at));
        if (!value) {
            return std::unexpected{value.error()};
        }
        if (auto const* real = std::get_if<double>(&*value); real != nullptr && !std::isfinite(*real)) {
            return fail(ExitCode::child_died,
                        fmt::format("{}: its variable '{}' is {} at {} s", settings_.description.file,
                                    variable(at).name, *real, settings_.base.seconds(point)),
                        "a number that is not finite steers nothing: look at its inputs");
        }
        outputs_[at] = std::move(*value);
        values_[at] = to_mapping(outputs_[at], settings_.table.variables[at].type);
    }
    return {};
}

} // namespace gridspace::agents
