// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gridspace {

struct CompareOptions {
    double tolerance{0};                  ///< of numbers: absolute, or relative to the larger one
    std::vector<std::string> signals;     ///< patterns; when given, only recorded signals are compared
    std::vector<std::string> skip_topics; ///< e.g. the clock's own when the ticks differ
};

struct Difference {
    std::string topic, process;
    std::uint64_t time_ns{0};
    std::string what; ///< "v_pu is 0.98 and 0.97"
};

struct Comparison {
    std::uint64_t samples{0};            ///< compared
    std::vector<Difference> differences; ///< the first of each topic, earliest first
    std::vector<std::string> notes;
    [[nodiscard]] bool identical() const { return differences.empty(); }
};

/// Compares two recordings sample by sample, octet by octet (or number by number, with a tolerance).
/// Compares two captures frame by frame: interface, time, octets. One difference at most, the first, in `into`; returns
/// how many frames are equal.
[[nodiscard]] Result<std::uint64_t> compare_captures(std::filesystem::path const& a, std::filesystem::path const& b,
                                                     Comparison& into);

[[nodiscard]] Result<Comparison> compare_recordings(std::filesystem::path const& a, std::filesystem::path const& b,
                                                    CompareOptions const& options);

} // namespace gridspace
