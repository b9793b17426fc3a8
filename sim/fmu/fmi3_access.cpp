// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The functions of FMI 3.0.1 that read and write variables (section 2.2.6.2). Set-points and signals are Float64,
// commands are Boolean, modes are enumerations, which are set as Int64; of the other types an exported network has
// none.
#include "sim/fmu/instance.hpp"

#include <fmt/format.h>

// NOLINTBEGIN(readability-identifier-naming): the names are the standard's
using namespace gridspace;
using namespace gridspace::sim::fmi3;

namespace {

enum class Kind { number, command, mode };

Result<void> check_type(sim::GridModel const& model, Reference reference, Kind kind) {
    bool const right = kind == Kind::command ? model.is_command(reference)
                       : kind == Kind::mode  ? model.is_mode(reference)
                                             : model.is_number(reference);
    return right ? Result<void>{}
                 : fail(ExitCode::usage, fmt::format("there is no {} with value reference {}",
                                                     kind == Kind::command ? "Boolean"
                                                     : kind == Kind::mode  ? "Enumeration"
                                                                           : "Float64",
                                                     reference));
}

Result<void> check_count(std::size_t references, std::size_t values) {
    return references == values
               ? Result<void>{}
               : fail(ExitCode::usage, fmt::format("{} values for {} scalar variables", values, references));
}

template <Kind kKind, class T>
int get(void* instance, char const* function, Reference const* references, std::size_t count, T* values,
        std::size_t value_count) noexcept {
    return guarded(instance, function, {State::instantiated, State::initialization, State::step, State::terminated},
                   false, [&](Instance& i) {
                       auto ok = check_count(count, value_count);
                       for (std::size_t n = 0; ok && n < count; ++n) {
                           if (ok = check_type(*i.model, references[n], kKind); ok) {
                               auto const value = i.model->get(references[n]);
                               ok = value ? Result<void>{} : std::unexpected{value.error()};
                               values[n] = static_cast<T>(value.value_or(0));
                           }
                       }
                       return ok;
                   });
}

template <Kind kKind, class T>
int set(void* instance, char const* function, Reference const* references, std::size_t count, T const* values,
        std::size_t value_count) noexcept {
    return guarded(instance, function, {State::instantiated, State::initialization, State::step}, false,
                   [&](Instance& i) {
                       auto ok = check_count(count, value_count);
                       for (std::size_t n = 0; ok && n < count; ++n) {
                           ok = check_type(*i.model, references[n], kKind);
                           ok = ok ? i.model->set(references[n], static_cast<double>(values[n])) : ok;
                       }
                       return ok;
                   });
}

} // namespace

GRIDSPACE_FMI3 int fmi3GetFloat64(void* instance, Reference const* references, std::size_t count, double* values,
                                  std::size_t value_count) {
    return get<Kind::number>(instance, "fmi3GetFloat64", references, count, values, value_count);
}
GRIDSPACE_FMI3 int fmi3SetFloat64(void* instance, Reference const* references, std::size_t count, double const* values,
                                  std::size_t value_count) {
    return set<Kind::number>(instance, "fmi3SetFloat64", references, count, values, value_count);
}
GRIDSPACE_FMI3 int fmi3GetBoolean(void* instance, Reference const* references, std::size_t count, bool* values,
                                  std::size_t value_count) {
    return get<Kind::command>(instance, "fmi3GetBoolean", references, count, values, value_count);
}
GRIDSPACE_FMI3 int fmi3SetBoolean(void* instance, Reference const* references, std::size_t count, bool const* values,
                                  std::size_t value_count) {
    return set<Kind::command>(instance, "fmi3SetBoolean", references, count, values, value_count);
}

GRIDSPACE_FMI3 int fmi3GetInt64(void* instance, Reference const* references, std::size_t count, std::int64_t* values,
                                std::size_t value_count) {
    return get<Kind::mode>(instance, "fmi3GetInt64", references, count, values, value_count);
}
GRIDSPACE_FMI3 int fmi3SetInt64(void* instance, Reference const* references, std::size_t count,
                                std::int64_t const* values, std::size_t value_count) {
    return set<Kind::mode>(instance, "fmi3SetInt64", references, count, values, value_count);
}

// NOLINTBEGIN(bugprone-macro-parentheses): TYPE is a type
#define GRIDSPACE_NO_VARIABLES(NAME, TYPE)                                                                             \
    GRIDSPACE_FMI3 int fmi3Get##NAME(void* instance, Reference const*, std::size_t count, TYPE*, std::size_t) {        \
        return count == 0 ? 0 : unsupported(instance, "fmi3Get" #NAME);                                                \
    }                                                                                                                  \
    GRIDSPACE_FMI3 int fmi3Set##NAME(void* instance, Reference const*, std::size_t count, TYPE const*, std::size_t) {  \
        return count == 0 ? 0 : unsupported(instance, "fmi3Set" #NAME);                                                \
    }
GRIDSPACE_NO_VARIABLES(Float32, float)
GRIDSPACE_NO_VARIABLES(Int8, std::int8_t)
GRIDSPACE_NO_VARIABLES(UInt8, std::uint8_t)
GRIDSPACE_NO_VARIABLES(Int16, std::int16_t)
GRIDSPACE_NO_VARIABLES(UInt16, std::uint16_t)
GRIDSPACE_NO_VARIABLES(Int32, std::int32_t)
GRIDSPACE_NO_VARIABLES(UInt32, std::uint32_t)
GRIDSPACE_NO_VARIABLES(UInt64, std::uint64_t)
GRIDSPACE_NO_VARIABLES(String, char const*)
// NOLINTEND(bugprone-macro-parentheses)

GRIDSPACE_FMI3 int fmi3GetBinary(void* instance, Reference const*, std::size_t count, std::size_t*,
                                 std::uint8_t const**, std::size_t) {
    return count == 0 ? 0 : unsupported(instance, "fmi3GetBinary");
}
GRIDSPACE_FMI3 int fmi3SetBinary(void* instance, Reference const*, std::size_t count, std::size_t const*,
                                 std::uint8_t const* const*, std::size_t) {
    return count == 0 ? 0 : unsupported(instance, "fmi3SetBinary");
}
GRIDSPACE_FMI3 int fmi3GetClock(void* instance, Reference const*, std::size_t count, bool*) {
    return count == 0 ? 0 : unsupported(instance, "fmi3GetClock");
}
GRIDSPACE_FMI3 int fmi3SetClock(void* instance, Reference const*, std::size_t count, bool const*) {
    return count == 0 ? 0 : unsupported(instance, "fmi3SetClock");
}
// NOLINTEND(readability-identifier-naming)
