// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/status.hpp"
#include "fmi/types3.hpp"
#include "sim/fmu/grid_model.hpp"

#include <exception>
#include <initializer_list>
#include <memory>
#include <new>
#include <string>

#define GRIDSPACE_FMI3 extern "C" __attribute__((visibility("default")))

/// What the functions of FMI 3.0 share: an instance with its state, and the boundary that no exception crosses.
namespace gridspace::sim::fmi3 {

using fmi::Status;
using fmi::v3::Reference;

/// States of section 4.2.1 (co-simulation without event mode).
enum class State { instantiated, initialization, step, terminated, failed };
[[nodiscard]] char const* name_of(State state) noexcept;

struct Instance {
    std::unique_ptr<GridModel> model;
    fmi::v3::LogMessage* log{nullptr};
    void* environment{nullptr};
    State state{State::instantiated};

    /// To the log of the importer, whatever logging it asked for: what goes wrong is never silent.
    void say(Status status, std::string const& message) const noexcept;
};

[[nodiscard]] std::string refused_in(char const* function, State state);
/// Says that this FMU has no such function, as its description says.
int unsupported(void* instance, char const* function) noexcept;

/// Runs the body of a function of the standard in one of the states in which it may be called. A failure, or an
/// exception, becomes a message and fmi3Error; `ends`: after it the instance can only be reset or freed.
template <class Body>
int guarded(void* pointer, char const* function, std::initializer_list<State> allowed, bool ends,
            Body const& body) noexcept {
    auto* const instance = static_cast<Instance*>(pointer);
    if (instance == nullptr) {
        return static_cast<int>(Status::error);
    }
    try {
        bool may_be_called = false;
        for (State const state : allowed) {
            may_be_called = may_be_called || instance->state == state;
        }
        if (!may_be_called) {
            instance->say(Status::error, refused_in(function, instance->state));
            return static_cast<int>(Status::error);
        }
        Result<void> const done = body(*instance);
        if (done) {
            return static_cast<int>(Status::ok);
        }
        instance->say(Status::error, describe(done.error()));
    } catch (std::bad_alloc const&) {
        instance->say(Status::error, "out of memory");
    } catch (std::exception const& e) {
        instance->say(Status::error, e.what());
    }
    if (ends) {
        instance->state = State::failed;
    }
    return static_cast<int>(Status::error);
}

} // namespace gridspace::sim::fmi3
