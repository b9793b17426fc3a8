// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>

namespace gridspace::cli {

/// manifest.json of a run folder; not an object where there is none.
[[nodiscard]] nlohmann::ordered_json manifest_of(std::filesystem::path const& folder);

/// How far the run came, simulated seconds; 0 when it does not say.
[[nodiscard]] double reached_of(nlohmann::ordered_json const& manifest);

/// A text of its `clock`.
[[nodiscard]] std::string clock_of(nlohmann::ordered_json const& manifest, char const* key);

/// Seconds since 1970; nothing for a recording without a manifest.
[[nodiscard]] std::optional<std::int64_t> epoch_of(nlohmann::ordered_json const& manifest);

/// A run folder's recording; a file is taken as it is.
[[nodiscard]] std::filesystem::path recording_of(std::filesystem::path const& run);

} // namespace gridspace::cli
