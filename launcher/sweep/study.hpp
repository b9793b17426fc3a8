// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "launcher/sweep/distribution.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

using config::Ref;

inline constexpr std::size_t kMaxStudyRuns = 100'000; ///< points times repetitions

/// One thing that varies: a column of the table.
struct Parameter {
    Ref name;
    std::vector<Ref> paths;                   ///< "processes.ev1.requested_h": all of them get the value
    std::vector<config::Node> values;         ///< of a list, a range, files or a table; none where it is drawn
    std::optional<Distribution> distribution; ///< or it is drawn
    double round_to{0};                       ///< draws are multiples of this; 0: as they come
};

/// A study file: many runs of one scenario.
struct Study {
    std::filesystem::path file;
    std::string name, description;
    std::filesystem::path scenario; ///< absolute
    config::SourceMark scenario_mark;
    config::Node set; ///< path -> value, of all runs
    std::vector<Parameter> parameters;
    config::SourceMark parameters_mark;

    enum class Combine { cross, zip } combine{Combine::cross};
    struct Sampling {
        bool latin_hypercube{true};
        std::int64_t samples{0}; ///< draws; with `zip` as many as there are values
        std::int64_t seed{1};
    } sampling;
    std::vector<Ref> where; ///< conditions that a point must meet
    std::int64_t repetitions{1};

    std::optional<std::vector<Ref>> expectations; ///< of the scenario, that are judged; none given: all
    config::Node results;                         ///< further ones, written as in a scenario's `expect:`
    std::vector<std::filesystem::path> depends_on;
};

/// The keys of a study file, for its schema.
void describe_study_keys(config::Fields& fields);

/// Reads a study file; what is wrong with it alone is in `diagnostics`, and nothing is returned then. Whether it fits
/// its scenario is found by plan_study().
[[nodiscard]] std::optional<Study> load_study(std::filesystem::path const& file, config::Diagnostics& diagnostics);

/// Whether a parameter of `vary` is drawn from a distribution.
[[nodiscard]] bool is_drawn(config::Node const& parameter);

/// The same of a study that somebody else has put together.
[[nodiscard]] std::optional<Study> read_study(config::Node const& root, std::filesystem::path const& file,
                                              config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
