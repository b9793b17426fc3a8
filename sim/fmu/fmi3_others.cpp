// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The functions of FMI 3.0.1 that an FMU exports whatever it can: those of other interface types, of states, clocks and
// derivatives. The description says that there are none; who calls one all the same gets a message and fmi3Error.
#include "sim/fmu/instance.hpp"

#include <cstddef>
#include <cstdint>

// NOLINTBEGIN(readability-identifier-naming): the names are the standard's
using namespace gridspace::sim::fmi3;
using gridspace::fmi::v3::LogMessage;

namespace {

/// Before there is an instance.
void* no_interface(void* environment, LogMessage* log, char const* interface) noexcept {
    Instance const nobody{nullptr, log, environment};
    nobody.say(Status::error, interface);
    return nullptr;
}

} // namespace

GRIDSPACE_FMI3 void* fmi3InstantiateModelExchange(char const*, char const*, char const*, bool, bool, void* environment,
                                                  LogMessage* log) {
    return no_interface(environment, log, "this FMU is for co-simulation: model exchange is not supported");
}
GRIDSPACE_FMI3 void* fmi3InstantiateScheduledExecution(char const*, char const*, char const*, bool, bool,
                                                       void* environment, LogMessage* log, void (*)(void*), void (*)(),
                                                       void (*)()) {
    return no_interface(environment, log, "this FMU is for co-simulation: scheduled execution is not supported");
}

#define GRIDSPACE_UNSUPPORTED(NAME, ...)                                                                               \
    GRIDSPACE_FMI3 int NAME(void* instance __VA_OPT__(, ) __VA_ARGS__) {                                               \
        return unsupported(instance, #NAME);                                                                           \
    }

// Saved states: the solvers cannot give theirs away.
GRIDSPACE_UNSUPPORTED(fmi3GetFMUState, void**)
GRIDSPACE_UNSUPPORTED(fmi3SetFMUState, void*)
GRIDSPACE_UNSUPPORTED(fmi3FreeFMUState, void**)
GRIDSPACE_UNSUPPORTED(fmi3SerializedFMUStateSize, void*, std::size_t*)
GRIDSPACE_UNSUPPORTED(fmi3SerializeFMUState, void*, std::uint8_t*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3DeserializeFMUState, std::uint8_t const*, std::size_t, void**)

// Dependencies and derivatives.
GRIDSPACE_UNSUPPORTED(fmi3GetNumberOfVariableDependencies, Reference, std::size_t*)
GRIDSPACE_UNSUPPORTED(fmi3GetVariableDependencies, Reference, std::size_t*, Reference*, std::size_t*, int*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetDirectionalDerivative, Reference const*, std::size_t, Reference const*, std::size_t,
                      double const*, std::size_t, double*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetAdjointDerivative, Reference const*, std::size_t, Reference const*, std::size_t,
                      double const*, std::size_t, double*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetOutputDerivatives, Reference const*, std::size_t, std::int32_t const*, double*,
                      std::size_t)

// Structural parameters, events and clocks.
GRIDSPACE_UNSUPPORTED(fmi3EnterConfigurationMode)
GRIDSPACE_UNSUPPORTED(fmi3ExitConfigurationMode)
GRIDSPACE_UNSUPPORTED(fmi3EnterEventMode)
GRIDSPACE_UNSUPPORTED(fmi3EnterStepMode)
GRIDSPACE_UNSUPPORTED(fmi3EvaluateDiscreteStates)
GRIDSPACE_UNSUPPORTED(fmi3UpdateDiscreteStates, bool*, bool*, bool*, bool*, bool*, double*)
GRIDSPACE_UNSUPPORTED(fmi3GetIntervalDecimal, Reference const*, std::size_t, double*, int*)
GRIDSPACE_UNSUPPORTED(fmi3GetIntervalFraction, Reference const*, std::size_t, std::uint64_t*, std::uint64_t*, int*)
GRIDSPACE_UNSUPPORTED(fmi3GetShiftDecimal, Reference const*, std::size_t, double*)
GRIDSPACE_UNSUPPORTED(fmi3GetShiftFraction, Reference const*, std::size_t, std::uint64_t*, std::uint64_t*)
GRIDSPACE_UNSUPPORTED(fmi3SetIntervalDecimal, Reference const*, std::size_t, double const*)
GRIDSPACE_UNSUPPORTED(fmi3SetIntervalFraction, Reference const*, std::size_t, std::uint64_t const*,
                      std::uint64_t const*)
GRIDSPACE_UNSUPPORTED(fmi3SetShiftDecimal, Reference const*, std::size_t, double const*)
GRIDSPACE_UNSUPPORTED(fmi3SetShiftFraction, Reference const*, std::size_t, std::uint64_t const*, std::uint64_t const*)
GRIDSPACE_UNSUPPORTED(fmi3ActivateModelPartition, Reference, double)

// Model exchange.
GRIDSPACE_UNSUPPORTED(fmi3EnterContinuousTimeMode)
GRIDSPACE_UNSUPPORTED(fmi3CompletedIntegratorStep, bool, bool*, bool*)
GRIDSPACE_UNSUPPORTED(fmi3SetTime, double)
GRIDSPACE_UNSUPPORTED(fmi3SetContinuousStates, double const*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetContinuousStateDerivatives, double*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetEventIndicators, double*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetContinuousStates, double*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetNominalsOfContinuousStates, double*, std::size_t)
GRIDSPACE_UNSUPPORTED(fmi3GetNumberOfEventIndicators, std::size_t*)
GRIDSPACE_UNSUPPORTED(fmi3GetNumberOfContinuousStates, std::size_t*)
// NOLINTEND(readability-identifier-naming)
