// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/recordings.hpp"

namespace gridspace::cli {
namespace {

constexpr std::uint64_t kUnseen = 1'000'000; ///< recordings that are trained on are numbered from 0

} // namespace

Result<std::vector<ids::LineWaveform>> all_recordings(ids::TrainingConfig const& config, std::uint64_t seed,
                                                      bool unseen,
                                                      std::function<void(std::size_t, std::size_t)> const& progress) {
    static_cast<void>(progress);
    if (config.simulated) {
        return fail(ExitCode::usage, "data.simulated needs the electromagnetic solver, which this build does not have",
                    "use data.synthetic or data.files");
    }
    return ids::gather_recordings(config, seed, unseen ? kUnseen : 0);
}

} // namespace gridspace::cli
