// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// `gridspace ids …`, as functions that return an exit code.
namespace gridspace::cli {

struct IdsTrainArguments {
    std::filesystem::path config, output; ///< output: instead of the configuration's
    std::optional<std::int64_t> seed;
    bool json{false}, quiet{false};
};
int ids_train(IdsTrainArguments const& arguments);

struct IdsEvaluateArguments {
    std::filesystem::path model;
    std::vector<std::filesystem::path> data; ///< CSV, npy, or a training configuration
    double percent{2}, nominal_peak_a{0};
    std::optional<double> rate_hz, event_s;
    std::string threshold{"larger_peak"}; ///< for the attacks
    std::int64_t seed{1};
    bool attacks{true}, json{false};
};
int ids_evaluate(IdsEvaluateArguments const& arguments);

struct IdsStudyArguments {
    std::filesystem::path config, out{"ids_study"};
    std::vector<int> windows{5, 10, 20, 40}, hidden{5, 10, 20};
    bool json{false};
};
int ids_study(IdsStudyArguments const& arguments);

} // namespace gridspace::cli
