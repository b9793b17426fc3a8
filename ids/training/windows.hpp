// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "ids/data/waveform.hpp"
#include "ids/forecaster/model.hpp"

#include <cstdint>
#include <span>
#include <vector>

namespace gridspace::ids {

/// Training pairs, already divided by the scale: `inputs` numbers each, then `outputs` targets.
struct Windows {
    std::size_t inputs{0}, outputs{0};
    std::vector<double> x; ///< count x inputs
    std::vector<double> y; ///< count x outputs

    [[nodiscard]] std::size_t count() const { return inputs == 0 ? 0 : x.size() / inputs; }
};

struct WindowParams {
    int window{20}, channels{1};
    Model::Scale scale{Model::Scale::window_peak};
    double scale_a{1};
    std::size_t count{120'000}; ///< windows drawn; all of them when there are fewer
    double event_share{0.25};   ///< of those, at most this share from the cycle after an event: they are few, and noise
                                ///< is not what they teach
};

/// Draws windows from recordings, from both ends and all phases, with the same probability each. Windows with a value
/// that is not finite are left out.
[[nodiscard]] Windows draw_windows(std::span<LineWaveform const> recordings, WindowParams const& params,
                                   std::uint64_t seed);

} // namespace gridspace::ids
