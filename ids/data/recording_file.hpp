// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "ids/data/waveform.hpp"

#include <filesystem>
#include <optional>

namespace gridspace::ids {

/// What a file does not say about itself.
struct RecordingOptions {
    std::optional<double> rate_hz; ///< needed for npy; CSV has a time column
    double frequency_hz{60};
    std::optional<double> event_s; ///< when something happens, from the first sample
};

/// Reads currents (A) from
///  - CSV: a header row; time in seconds first, then 3 columns (one end: a, b, c) or 6 (from a, b, c, to a, b, c, both
///  counted
///    along the line). Equal steps; separators ',' or ';'; lines starting with '#' are comments.
///  - npy (NumPy format 1 to 3): float32 or float64, little endian, C order, shape (n, 3) or (n, 6).
/// Values that are not numbers are kept as NaN, for the detector to treat as lost samples; anything else that is wrong
/// is an error with its line.
[[nodiscard]] Result<LineWaveform> read_recording(std::filesystem::path const& file, RecordingOptions const& options);

} // namespace gridspace::ids
