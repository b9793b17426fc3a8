// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fmu/instance.hpp"

#include <array>

namespace gridspace::sim::fmi3 {

char const* name_of(State state) noexcept {
    constexpr std::array kNames{"Instantiated", "Initialization Mode", "Step Mode", "Terminated", "an error"};
    return kNames[static_cast<std::size_t>(state)];
}

void Instance::say(Status status, std::string const& message) const noexcept {
    if (log != nullptr) {
        log(environment, static_cast<int>(status), "logStatusError", message.c_str());
    }
}

std::string refused_in(char const* function, State state) {
    return std::string{function} + " is called in the state of " + name_of(state) +
           ", where the standard does not allow it";
}

int unsupported(void* instance, char const* function) noexcept {
    return guarded(instance, function,
                   {State::instantiated, State::initialization, State::step, State::terminated, State::failed}, false,
                   [&](Instance&) {
                       return Result<void>{fail(ExitCode::usage, std::string{function} + " is not supported",
                                                "modelDescription.xml tells what this FMU can")};
                   });
}

} // namespace gridspace::sim::fmi3
