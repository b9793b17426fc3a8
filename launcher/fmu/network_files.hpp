// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/diagnostics.hpp"
#include "fmi/archive_writer.hpp"

#include <filesystem>
#include <optional>
#include <vector>

namespace gridspace::launcher {

/// A network with all that it reads, to be put into one folder: the first is the network, what it extends laid into it,
/// the others are its profiles. Of a network that load_network() has read without a mistake.
[[nodiscard]] std::optional<std::vector<fmi::ArchiveFile>> network_files(std::filesystem::path const& network,
                                                                         config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
