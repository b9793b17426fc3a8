// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

#include <filesystem>

namespace gridspace::launcher {

/// The network of a run as far as figures speak of it: the copy of its file in the run folder with the changes of the
/// resolved scenario; of a network in another format the changes alone.
[[nodiscard]] config::Node network_of_run(std::filesystem::path const& run, config::Node const& scenario);

/// Its nominal frequency, Hz, as the monitor is given it, whatever the format of the network; 60 where nobody says.
[[nodiscard]] double frequency_of_run(std::filesystem::path const& run);

} // namespace gridspace::launcher
