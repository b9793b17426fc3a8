// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>

namespace gridspace::relay {

/// Phases a, b, c.
using Abc = std::array<double, 3>;

/// IEC 61850-7-3 validity of a measured value.
enum class Validity : std::uint8_t { good, questionable, invalid };

/// smpSynch of IEC 61850-9-2: how the clock behind the sample counter is synchronised.
enum class Synch : std::uint8_t { none = 0, local = 1, global = 2 };

/// What one merging unit said about one instant.
struct EndSample {
    Abc i_a{};           ///< instantaneous primary amperes, in the direction of the CT
    Abc v_v{};           ///< volts to earth, where voltages are asked for
    bool present{false}; ///< false: the frame was lost, or came after the partner timeout
    Validity validity{Validity::good};
    Synch synch{Synch::global};
    bool test{false};      ///< the test bit of the quality
    bool simulated{false}; ///< the simulation bit of the frame
};

/// The two ends of a line at one instant. `index` counts samples from a common zero and never wraps
/// (second * rate + smpCnt).
struct LineSample {
    std::int64_t index{0};
    EndSample from, to;
};

} // namespace gridspace::relay
