// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/data/waveform.hpp"

#include <array>

namespace gridspace::ids {

/// Ranges from which a synthetic recording is drawn. Amplitudes relative to the nominal peak.
struct SyntheticParams {
    double rate_hz{4800}, frequency_hz{60}, duration_s{0.5};
    double nominal_peak_a{10};
    std::array<double, 2> event_s{0.12, 0.22}; ///< when the event happens
    std::array<double, 2> load{0.35, 1.15};
    std::array<double, 2> noise_percent{0, 0.5}; ///< standard deviation, of the nominal peak
    double off_nominal_share{0.5};               ///< share of recordings with another frequency than nominal
    double frequency_spread_hz{0.5};
    double harmonics_percent{3};           ///< 3rd, 5th, 7th: each 0 to this
    double ct_error_percent{0.3};          ///< standard deviation of the ratio error
    std::array<double, 2> fault{1.4, 40};  ///< peak of the fault current; the largest is the bolted fault
    std::array<double, 2> x_over_r{3, 12}; ///< of the network; fault resistance takes it down as it lowers the current
    std::array<double, 2> load_x_over_r{0.3, 3}; ///< of everything that is not a fault
    double quantum_a{0.001};
    double radial_share{0.3}; ///< internal faults fed from one end only
};

/// A recording in closed form: in each phase and end a sinusoid per interval, and at each change a decaying offset that
/// keeps the current continuous, as in a circuit of resistances and inductances. The same seed and number give the same
/// samples.
[[nodiscard]] LineWaveform synthesise(SyntheticParams const& params, Situation situation, std::uint64_t seed,
                                      std::uint64_t number);

} // namespace gridspace::ids
