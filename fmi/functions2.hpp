// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/shared_object.hpp"

#include <cstddef>

/// The functions of FMI 2.0.4 that are used here, with the types that its section 2.1.2 gives them on every platform:
/// void* for instances and states, unsigned int for value references, double, int (also for Booleans), char const*.
namespace gridspace::fmi::v2 {

using Component = void*;
using State = void*;
using Reference = unsigned int;

/// Section 2.1.5: what the FMU may call. It keeps the pointer to it.
struct CallbackFunctions {
    void (*logger)(void* environment, char const* instance, int status, char const* category, char const* message, ...);
    void* (*allocate_memory)(std::size_t count, std::size_t size);
    void (*free_memory)(void* memory);
    void (*step_finished)(void* environment, int status);
    void* environment;
};
inline constexpr int kCoSimulation = 1;       // fmi2Type
inline constexpr int kLastSuccessfulTime = 2; // fmi2StatusKind
inline constexpr int kTerminated = 3;

template <class T>
using Get = int(Component, Reference const*, std::size_t, T*);
template <class T>
using Set = int(Component, Reference const*, std::size_t, T const*);

struct Functions {
    Component (*instantiate)(char const* name, int type, char const* guid, char const* resources,
                             CallbackFunctions const* callbacks, int visible, int logging){};
    void (*free_instance)(Component){};
    int (*setup_experiment)(Component, int has_tolerance, double tolerance, double start, int has_stop, double stop){};
    int (*enter_initialization_mode)(Component){};
    int (*exit_initialization_mode)(Component){};
    int (*terminate)(Component){};
    Get<double>* get_real{};
    Get<int>* get_integer{};
    Get<int>* get_boolean{};
    Get<char const*>* get_string{};
    Set<double>* set_real{};
    Set<int>* set_integer{};
    Set<int>* set_boolean{};
    Set<char const*>* set_string{};
    int (*do_step)(Component, double time, double step, int no_rollback){};
    int (*get_real_status)(Component, int kind, double*){};
    int (*get_boolean_status)(Component, int kind, int*){};
    // only of an FMU that says so
    int (*get_state)(Component, State*){};
    int (*set_state)(Component, State){};
    int (*free_state)(Component, State*){};
    int (*serialized_size)(Component, State, std::size_t*){};
    int (*serialize)(Component, State, char*, std::size_t){};
    int (*deserialize)(Component, char const*, std::size_t, State*){};
};

inline Functions find_functions(SharedObject& object, CoSimulation const& can) {
    Functions f;
    object.find(f.instantiate, "fmi2Instantiate");
    object.find(f.free_instance, "fmi2FreeInstance");
    object.find(f.setup_experiment, "fmi2SetupExperiment");
    object.find(f.enter_initialization_mode, "fmi2EnterInitializationMode");
    object.find(f.exit_initialization_mode, "fmi2ExitInitializationMode");
    object.find(f.terminate, "fmi2Terminate");
    object.find(f.get_real, "fmi2GetReal");
    object.find(f.get_integer, "fmi2GetInteger");
    object.find(f.get_boolean, "fmi2GetBoolean");
    object.find(f.get_string, "fmi2GetString");
    object.find(f.set_real, "fmi2SetReal");
    object.find(f.set_integer, "fmi2SetInteger");
    object.find(f.set_boolean, "fmi2SetBoolean");
    object.find(f.set_string, "fmi2SetString");
    object.find(f.do_step, "fmi2DoStep");
    object.find(f.get_real_status, "fmi2GetRealStatus");
    object.find(f.get_boolean_status, "fmi2GetBooleanStatus");
    if (can.can_get_and_set_state) {
        object.find(f.get_state, "fmi2GetFMUstate");
        object.find(f.set_state, "fmi2SetFMUstate");
        object.find(f.free_state, "fmi2FreeFMUstate");
    }
    if (can.can_serialize_state) {
        object.find(f.serialized_size, "fmi2SerializedFMUstateSize");
        object.find(f.serialize, "fmi2SerializeFMUstate");
        object.find(f.deserialize, "fmi2DeSerializeFMUstate");
    }
    return f;
}

} // namespace gridspace::fmi::v2
