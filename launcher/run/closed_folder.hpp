// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>

namespace gridspace::launcher {

/// A run folder is data, also one that somebody else has filled: whatever reads or writes in it asks first whether
/// it is closed. Then nothing in it leads out of it, and nothing in it makes a reader wait: the error names the first
/// symbolic link to elsewhere (or to nothing), pipe or device. It cannot answer for a folder that somebody else changes
/// at the same time.
[[nodiscard]] Result<void> check_closed(std::filesystem::path const& folder);

} // namespace gridspace::launcher
