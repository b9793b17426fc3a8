// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What a study keeps of a run: RUN.json next to its scenario.
struct RunRecord {
    int exit{0};       ///< of `gridspace run`
    std::string cause; ///< why it is not 0
    double wall_s{0};  ///< of everything, from the start of its process to the end
    double simulated_s{0};
    std::uint64_t overruns{0};
    struct Value {
        std::string name, verb, unit;
        std::optional<double> value, low, high;
        std::optional<bool> passed; ///< none: shown, not judged
        bool advisory{false};
    };
    std::vector<Value> values;
    bool is_kept{false}; ///< its run folder is there

    [[nodiscard]] char const* state() const; ///< "passed", "failed" (an expectation), "ended_early"
    /// The same run again would give the same. A run that was interrupted, that died or that stalled is tried again.
    [[nodiscard]] bool is_final() const { return exit >= 0 && exit <= 2; }
    [[nodiscard]] Value const* find(std::string const& name) const;
};

/// Reads what a run has left: report/summary.json, and where it has written none the end of what it printed. An exit
/// code of 0 or 1 without a summary is a failure of its own.
[[nodiscard]] RunRecord collect_run(std::filesystem::path const& run_folder, std::filesystem::path const& output,
                                    int exit, double wall_s);

/// Nothing when there is no such file, or what is in it is not whole.
[[nodiscard]] std::optional<RunRecord> read_record(std::filesystem::path const& file);
[[nodiscard]] Result<void> write_record(std::filesystem::path const& file, RunRecord const& record);

} // namespace gridspace::launcher
