// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::fmi {

enum class Version : std::uint8_t { fmi2, fmi3 };

/// Type of a variable. FMI 2.0 has four: Real is float64, Integer int32.
enum class Type : std::uint8_t {
    float32,
    float64,
    int8,
    uint8,
    int16,
    uint16,
    int32,
    uint32,
    int64,
    uint64,
    boolean,
    string,
    binary,
    enumeration,
    clock
};
enum class Causality : std::uint8_t {
    structural_parameter,
    parameter,
    calculated_parameter,
    input,
    output,
    local,
    independent
};
enum class Variability : std::uint8_t { constant, fixed, tunable, discrete, continuous };
enum class Initial : std::uint8_t { none, exact, approx, calculated };

[[nodiscard]] std::string_view name_of(Version version) noexcept; ///< "2.0"
[[nodiscard]] std::string_view name_of(Type type) noexcept;       ///< "float64"
[[nodiscard]] std::string_view name_of(Causality causality) noexcept;
[[nodiscard]] std::string_view name_of(Variability variability) noexcept;
[[nodiscard]] bool is_number(Type type) noexcept; ///< integers, floats and enumerations

struct Variable {
    std::string name;
    std::uint32_t reference{0};
    Type type{Type::float64};
    Causality causality{Causality::local};
    Variability variability{Variability::continuous};
    Initial initial{Initial::none};
    std::string unit, description;
    std::optional<std::string> start;   ///< as written
    std::optional<double> min{}, max{}; ///< of those that are written; not read
    std::vector<std::string> items{};   ///< the same, of an enumeration: its words, by their values from 1 on
    bool is_array{false};

    /// Before the initialisation a value may be given.
    [[nodiscard]] bool takes_start() const noexcept;
};

/// What an FMU for co-simulation can do.
struct CoSimulation {
    std::string identifier{}; ///< of its binaries
    bool variable_step{false};
    bool can_get_and_set_state{false};
    bool can_serialize_state{false};
    bool has_event_mode{false};
    bool needs_execution_tool{false};
    std::optional<double> fixed_internal_step_s{};
};

/// modelDescription.xml, as far as it is used here.
struct ModelDescription {
    std::string file; ///< of the FMU, for messages
    Version version{Version::fmi3};
    std::string version_text; ///< "3.0.1"
    std::string name, token;  ///< token: the GUID of FMI 2.0
    std::string description, model_version, author, tool, generated, license;
    bool model_exchange{false}, scheduled_execution{false};
    std::optional<CoSimulation> co_simulation;
    std::optional<double> start_s, stop_s, step_s, tolerance; ///< of its default experiment
    std::vector<Variable> variables;

    [[nodiscard]] Variable const* find(std::string_view variable) const;
    /// The interface, or why there is none that can be used here.
    [[nodiscard]] Result<CoSimulation> usable() const;
};

/// `file`: what messages call the FMU. Mistakes name the line.
[[nodiscard]] Result<ModelDescription> parse_model_description(std::string_view xml, std::string const& file);

/// Of an FMU on disk; nothing of it is run.
class Archive;
[[nodiscard]] Result<ModelDescription> read_model_description(Archive const& archive, std::string const& file);

/// Platforms that the FMU has binaries for: "x86_64-linux", "win64".
[[nodiscard]] std::vector<std::string> platforms(Archive const& archive);
/// Where the binary for this machine is in the FMU ("binaries/x86_64-linux/Model.so"), or that there is none.
[[nodiscard]] Result<std::string> binary_of(Archive const& archive, ModelDescription const& description);

} // namespace gridspace::fmi
