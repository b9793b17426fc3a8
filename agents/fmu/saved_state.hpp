// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"

#include <cstddef>
#include <filesystem>
#include <optional>
#include <vector>

namespace gridspace::agents {

/// The state of an FMU at a communication point, in a file that outlives the process.
struct SavedState {
    SimTime time;
    std::vector<std::byte> octets;
};

/// Replaces the file as a whole: who is killed meanwhile leaves the old one or the new one.
[[nodiscard]] Result<void> save(SavedState const& state, std::filesystem::path const& file);
/// Nothing when there is no file.
[[nodiscard]] Result<std::optional<SavedState>> load_state(std::filesystem::path const& file);

} // namespace gridspace::agents
