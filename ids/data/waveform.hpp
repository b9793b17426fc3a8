// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

namespace gridspace::ids {

using Abc = std::array<double, 3>;

/// What happens to the grid in a recording.
enum class Situation : std::uint8_t {
    quiet,
    load_step,
    line_trip,
    generator_trip,
    swing,
    external_3ph,
    external_1ph,
    internal_3ph,
    internal_2ph,
    internal_1ph,
};
[[nodiscard]] char const* name_of(Situation situation);
[[nodiscard]] inline bool is_internal_fault(Situation s) {
    return s >= Situation::internal_3ph;
}

/// Sampled currents of a line, A, both ends counted along the line. `to` is empty when only one end is known.
struct LineWaveform {
    std::string name;
    double rate_hz{4800}, frequency_hz{60};
    std::vector<Abc> from, to;
    Situation situation{Situation::quiet};
    std::int64_t event{-1}; ///< the first sample after the event; -1: none, or not known

    [[nodiscard]] std::size_t size() const { return from.size(); }
};

} // namespace gridspace::ids
