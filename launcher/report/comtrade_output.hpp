// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "common/result.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/scenario/comtrade_settings.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// `record.comtrade` of a resolved scenario; nothing where there is none.
[[nodiscard]] std::optional<ComtradeSettings> comtrade_settings(config::Node const& scenario);

struct ComtradeOutput {
    std::vector<std::filesystem::path> files; ///< the .cfg, or .cff, of each record
    std::vector<std::string> notes;           ///< what is not in them, or why there are none
};

/// Writes a record in ASCII and one in BINARY around each trigger of a finished run into `folder`: <trigger>_<n>_ascii
/// and <trigger>_<n>_binary. Channels are sampled at the rate of the simulator's signals; a record ends with the run.
[[nodiscard]] Result<ComtradeOutput> write_comtrade_records(Results const& results, config::Node const& scenario,
                                                            ComtradeSettings const& settings,
                                                            std::filesystem::path const& folder);

/// What a run writes by itself: RUN/comtrade, when the scenario asks for it.
[[nodiscard]] Result<ComtradeOutput> write_comtrade_of_run(Results const& results);

} // namespace gridspace::launcher
