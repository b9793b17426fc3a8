// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <array>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What detectors and attackers said in a run: topics of type IdsVerdict and AttackLabel, of whatever process.
struct IntrusionRecording {
    struct Phase {
        float raw_a{0}, forecast_a{0}, accepted_a{0}, limit_a{0}, open_forecast_a{0};
        bool judged{false}, flagged{false}, open_flagged{false};
    };
    struct Sample {
        std::int64_t index{0};
        std::array<Phase, 3> phases;
    };
    struct Track { ///< one stream by one detector; samples in order
        std::string detector, stream;
        double rate_hz{0};
        std::vector<Sample> samples;
        [[nodiscard]] double time_s(Sample const& s) const { return static_cast<double>(s.index) / rate_hz; }
    };
    struct Label {
        std::string attack, kind, target;
        std::int64_t index{0};
        std::uint8_t channel{0}; ///< 3: the whole frame
        double true_value{0}, sent_value{0};
        std::int64_t sent_ns{0}; ///< when the last of its message was
    };
    std::vector<Track> tracks; ///< by detector and stream
    std::vector<Label> labels;

    [[nodiscard]] bool empty() const { return tracks.empty() && labels.empty(); }
    [[nodiscard]] Track const* find(std::string const& detector, std::string const& stream) const;
};

[[nodiscard]] Result<IntrusionRecording> read_intrusion_recording(std::filesystem::path const& mcap);

/// The labels alone, one after the other: memory does not grow with the recording. Gives what is wrong with a recording
/// that was cut, whose prefix was read; empty when it is whole.
[[nodiscard]] Result<std::string>
read_attack_labels(std::filesystem::path const& mcap,
                   std::function<void(IntrusionRecording::Label const&)> const& on_label);

} // namespace gridspace::launcher
