// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The functions of FMI 3.0.1 by which an instance is made, initialised, stepped and ended (sections 2.3 and 4.2).
#include "sim/fmu/instance.hpp"

#include <fmt/format.h>

// NOLINTBEGIN(readability-identifier-naming): the names are the standard's
using namespace gridspace;
using namespace gridspace::sim::fmi3;

namespace {

constexpr std::initializer_list<State> kAnyState{State::instantiated, State::initialization, State::step,
                                                 State::terminated, State::failed};

/// The description that the importer has read is of this very network.
Result<void> check_token(sim::GridModel const& model, char const* token) {
    if (token != nullptr && model.token() == token) {
        return {};
    }
    return fail(ExitCode::usage,
                fmt::format("the instantiationToken is '{}', and the resources are of '{}'",
                            token == nullptr ? "" : token, model.token()),
                "the parts of the FMU do not belong together: unpack it again");
}

} // namespace

GRIDSPACE_FMI3 char const* fmi3GetVersion() {
    return "3.0";
}

GRIDSPACE_FMI3 int fmi3SetDebugLogging(void* instance, bool, std::size_t, char const* const*) {
    return guarded(instance, "fmi3SetDebugLogging", kAnyState, false,
                   [](Instance&) { return Result<void>{}; }); // errors are always logged, and there is nothing else
}

GRIDSPACE_FMI3 void* fmi3InstantiateCoSimulation(char const*, char const* token, char const* resources, bool, bool,
                                                 bool event_mode_used, bool, fmi::v3::Reference const*,
                                                 std::size_t intermediate_count, void* environment,
                                                 fmi::v3::LogMessage* log, fmi::v3::IntermediateUpdate*) {
    auto* const made = new (std::nothrow) Instance{nullptr, log, environment};
    int const status = guarded(
        made, "fmi3InstantiateCoSimulation", {State::instantiated}, false, [&](Instance& instance) -> Result<void> {
            if (event_mode_used || intermediate_count > 0) {
                return fail(ExitCode::usage, "event mode and intermediate variables are asked for",
                            "modelDescription.xml says that this FMU has neither");
            }
            auto model = sim::GridModel::load(resources == nullptr ? "" : resources);
            if (!model) {
                return std::unexpected{model.error()};
            }
            instance.model = std::move(*model);
            return check_token(*instance.model, token);
        });
    if (status != static_cast<int>(Status::ok)) {
        delete made;
        return nullptr;
    }
    return made;
}

GRIDSPACE_FMI3 void fmi3FreeInstance(void* instance) {
    delete static_cast<Instance*>(instance);
}

GRIDSPACE_FMI3 int fmi3EnterInitializationMode(void* instance, bool, double, double start_s, bool, double) {
    return guarded(instance, "fmi3EnterInitializationMode", {State::instantiated}, true,
                   [&](Instance& i) -> Result<void> {
                       if (start_s != 0) {
                           return fail(ExitCode::usage, fmt::format("the start time is {} s", start_s),
                                       "an exported network starts at 0 s; its profiles begin at the hour of the day "
                                       "that it was exported with");
                       }
                       auto ok = i.model->start();
                       i.state = ok ? State::initialization : i.state;
                       return ok;
                   });
}

GRIDSPACE_FMI3 int fmi3ExitInitializationMode(void* instance) {
    return guarded(instance, "fmi3ExitInitializationMode", {State::initialization}, true, [](Instance& i) {
        i.state = State::step;
        return Result<void>{};
    });
}

GRIDSPACE_FMI3 int fmi3DoStep(void* instance, double from_s, double step_s, bool, bool* needs_event, bool* terminate,
                              bool* early_return, double* reached_s) {
    return guarded(instance, "fmi3DoStep", {State::step}, true, [&](Instance& i) {
        *needs_event = *terminate = *early_return = false;
        auto ok = i.model->step(from_s, step_s);
        *reached_s = i.model->time_s();
        return ok;
    });
}

GRIDSPACE_FMI3 int fmi3Terminate(void* instance) {
    return guarded(instance, "fmi3Terminate", {State::initialization, State::step}, true, [](Instance& i) {
        i.state = State::terminated;
        return Result<void>{};
    });
}

GRIDSPACE_FMI3 int fmi3Reset(void* instance) {
    return guarded(instance, "fmi3Reset", kAnyState, true, [](Instance& i) {
        i.model->reset();
        i.state = State::instantiated;
        return Result<void>{};
    });
}
// NOLINTEND(readability-identifier-naming)
