// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "ids/data/recording_file.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/training/train.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace gridspace::ids {

/// Runs of our own simulator, explored at random.
struct SimulatedParams {
    std::filesystem::path network;
    std::string from_ct, to_ct, line; ///< the protected line and the instrument transformers of its ends
    std::int64_t runs{0};
    double duration_s{0.6};
    Rational step_s{1, 38400};
    std::array<double, 2> event_s{0.25, 0.35};
    std::array<double, 2> fault_resistance_ohm{0.01, 5}; ///< log-uniform
    std::array<double, 2> noise_percent{0, 0.5};         ///< standard deviation, of nominal_peak_a
    std::array<double, 2> load_factor{0.6, 1.4};
    double ct_error_percent{0.3}, harmonics_percent{1};
    double nominal_peak_a{0};
};

/// `gridspace ids train CONFIG.yaml`.
struct TrainingConfig {
    std::string name;
    std::int64_t seed{1};
    std::filesystem::path output;
    double rate_hz{4800}, frequency_hz{60};
    std::int64_t window{20}, hidden{0}, channels{1};
    Model::Scale scale{Model::Scale::window_peak};
    double scale_a{0.1};
    TrainParams training;
    std::int64_t windows{120'000};
    double event_share{0.25};

    struct File {
        std::filesystem::path file;
        RecordingOptions options;
    };
    std::vector<File> files;
    SyntheticParams synthetic;
    std::int64_t synthetic_recordings{0};
    std::optional<SimulatedParams> simulated;
};
void describe(config::Fields& f, TrainingConfig& config);

/// The file, or nothing with what is wrong in `diagnostics`.
[[nodiscard]] std::optional<TrainingConfig> load_training_config(std::filesystem::path const& file,
                                                                 config::Diagnostics& diagnostics);

/// The synthetic recordings and the files of a configuration; `number_offset` makes others from the same seed.
[[nodiscard]] Result<std::vector<LineWaveform>> gather_recordings(TrainingConfig const& config, std::uint64_t seed,
                                                                  std::uint64_t number_offset = 0);

/// The model that is to be trained, without layers.
[[nodiscard]] Model blank_model(TrainingConfig const& config);

} // namespace gridspace::ids
