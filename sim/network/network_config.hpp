// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "sim/network/network.hpp"

#include <filesystem>
#include <optional>

namespace gridspace::sim {

/// The keys of a network file (`gridspace_network: 1`).
void describe(config::Fields& f, Network& network);

/// Reads a network file and what it extends, or a MATPOWER case (*.m), and checks it (check_network). What is wrong is
/// in `diagnostics`; nothing is returned when there are errors. `named_at`: where the file's name was written.
[[nodiscard]] std::optional<Network> load_network(std::filesystem::path const& file, config::Diagnostics& diagnostics,
                                                  config::SourceMark named_at = {});

/// The same from a tree that is already merged (a scenario's overrides applied).
[[nodiscard]] std::optional<Network> read_network(config::Node const& root, config::Diagnostics& diagnostics);

} // namespace gridspace::sim
