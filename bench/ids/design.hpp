// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/line_relay.hpp"
#include "common/result.hpp"
#include "ids/detector/detector_config.hpp"
#include "ids/forecaster/model_file.hpp"
#include "ids/training/training_config.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace {

struct Design {
    std::string name;
    ids::Model model;
    ids::DetectorConfig config;
};

/// A relay with one of the designs in front of it.
struct GuardedRelay {
    Design const& design;
    ids::DetectorParams detector;
    relay::RelayParams relay;
};

/// The first one is no detector. `models`: the folder of mlp_20_10_1.json and ar_20.json.
[[nodiscard]] Result<std::vector<Design>> designs(std::filesystem::path const& models, double nominal_peak_a);

[[nodiscard]] relay::RelayParams relay_params(relay::ElementParams::Kind kind, ids::TrainingConfig const& config);

} // namespace gridspace
