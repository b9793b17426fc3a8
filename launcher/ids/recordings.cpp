// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/recordings.hpp"

#include "launcher/ids/exploration.hpp"

#include <fmt/format.h>
#include <iterator>

namespace gridspace::cli {
namespace {

constexpr std::uint64_t kUnseen = 1'000'000; ///< recordings that are trained on are numbered from 0

} // namespace

Result<std::vector<ids::LineWaveform>> all_recordings(ids::TrainingConfig const& config, std::uint64_t seed,
                                                      bool unseen,
                                                      std::function<void(std::size_t, std::size_t)> const& progress) {
    if (unseen && config.synthetic_recordings == 0 && !config.simulated) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' learns from files only: nobody can draw others of their kind", config.name),
                    "name recordings that it has not learnt from");
    }
    ids::TrainingConfig drawn = config;
    if (unseen) {
        drawn.files.clear(); // they have been seen
    }
    auto out = ids::gather_recordings(drawn, seed, unseen ? kUnseen : 0);
    if (!out || !config.simulated) {
        return out;
    }
    auto const exploration = Exploration::create(*config.simulated, config.rate_hz);
    if (!exploration) {
        return std::unexpected{exploration.error()};
    }
    auto simulated = exploration->all(seed, unseen ? kUnseen : 0, config.training.threads, progress);
    if (!simulated) {
        return std::unexpected{simulated.error()};
    }
    std::move(simulated->begin(), simulated->end(), std::back_inserter(*out));
    return out;
}

} // namespace gridspace::cli
