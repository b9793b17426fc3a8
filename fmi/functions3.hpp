// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/shared_object.hpp"
#include "fmi/types3.hpp"

#include <cstddef>
#include <cstdint>

/// The functions of FMI 3.0.1 that are used here.
namespace gridspace::fmi::v3 {

template <class T>
using Get = int(Instance, Reference const*, std::size_t, T*, std::size_t);
template <class T>
using Set = int(Instance, Reference const*, std::size_t, T const*, std::size_t);

struct Functions {
    Instance (*instantiate)(char const* name, char const* token, char const* resources, bool visible, bool logging,
                            bool event_mode_used, bool early_return_allowed, Reference const* intermediate,
                            std::size_t intermediate_count, void* environment, LogMessage* log,
                            IntermediateUpdate* update){};
    void (*free_instance)(Instance){};
    int (*enter_initialization_mode)(Instance, bool has_tolerance, double tolerance, double start, bool has_stop,
                                     double stop){};
    int (*exit_initialization_mode)(Instance){};
    int (*terminate)(Instance){};
    Get<float>* get_float32{};
    Get<double>* get_float64{};
    Get<std::int8_t>* get_int8{};
    Get<std::uint8_t>* get_uint8{};
    Get<std::int16_t>* get_int16{};
    Get<std::uint16_t>* get_uint16{};
    Get<std::int32_t>* get_int32{};
    Get<std::uint32_t>* get_uint32{};
    Get<std::int64_t>* get_int64{};
    Get<std::uint64_t>* get_uint64{};
    Get<bool>* get_boolean{};
    Get<char const*>* get_string{};
    Set<float>* set_float32{};
    Set<double>* set_float64{};
    Set<std::int8_t>* set_int8{};
    Set<std::uint8_t>* set_uint8{};
    Set<std::int16_t>* set_int16{};
    Set<std::uint16_t>* set_uint16{};
    Set<std::int32_t>* set_int32{};
    Set<std::uint32_t>* set_uint32{};
    Set<std::int64_t>* set_int64{};
    Set<std::uint64_t>* set_uint64{};
    Set<bool>* set_boolean{};
    Set<char const*>* set_string{};
    int (*do_step)(Instance, double time, double step, bool no_rollback, bool* needs_event, bool* terminate,
                   bool* early_return, double* reached){};
    // only of an FMU that says so
    int (*get_state)(Instance, State*){};
    int (*set_state)(Instance, State){};
    int (*free_state)(Instance, State*){};
    int (*serialized_size)(Instance, State, std::size_t*){};
    int (*serialize)(Instance, State, std::uint8_t*, std::size_t){};
    int (*deserialize)(Instance, std::uint8_t const*, std::size_t, State*){};
};

inline Functions find_functions(SharedObject& object, CoSimulation const& can) {
    Functions f;
    object.find(f.instantiate, "fmi3InstantiateCoSimulation");
    object.find(f.free_instance, "fmi3FreeInstance");
    object.find(f.enter_initialization_mode, "fmi3EnterInitializationMode");
    object.find(f.exit_initialization_mode, "fmi3ExitInitializationMode");
    object.find(f.terminate, "fmi3Terminate");
    object.find(f.get_float32, "fmi3GetFloat32");
    object.find(f.get_float64, "fmi3GetFloat64");
    object.find(f.get_int8, "fmi3GetInt8");
    object.find(f.get_uint8, "fmi3GetUInt8");
    object.find(f.get_int16, "fmi3GetInt16");
    object.find(f.get_uint16, "fmi3GetUInt16");
    object.find(f.get_int32, "fmi3GetInt32");
    object.find(f.get_uint32, "fmi3GetUInt32");
    object.find(f.get_int64, "fmi3GetInt64");
    object.find(f.get_uint64, "fmi3GetUInt64");
    object.find(f.get_boolean, "fmi3GetBoolean");
    object.find(f.get_string, "fmi3GetString");
    object.find(f.set_float32, "fmi3SetFloat32");
    object.find(f.set_float64, "fmi3SetFloat64");
    object.find(f.set_int8, "fmi3SetInt8");
    object.find(f.set_uint8, "fmi3SetUInt8");
    object.find(f.set_int16, "fmi3SetInt16");
    object.find(f.set_uint16, "fmi3SetUInt16");
    object.find(f.set_int32, "fmi3SetInt32");
    object.find(f.set_uint32, "fmi3SetUInt32");
    object.find(f.set_int64, "fmi3SetInt64");
    object.find(f.set_uint64, "fmi3SetUInt64");
    object.find(f.set_boolean, "fmi3SetBoolean");
    object.find(f.set_string, "fmi3SetString");
    object.find(f.do_step, "fmi3DoStep");
    if (can.can_get_and_set_state) {
        object.find(f.get_state, "fmi3GetFMUState");
        object.find(f.set_state, "fmi3SetFMUState");
        object.find(f.free_state, "fmi3FreeFMUState");
    }
    if (can.can_serialize_state) {
        object.find(f.serialized_size, "fmi3SerializedFMUStateSize");
        object.find(f.serialize, "fmi3SerializeFMUState");
        object.find(f.deserialize, "fmi3DeserializeFMUState");
    }
    return f;
}

} // namespace gridspace::fmi::v3
