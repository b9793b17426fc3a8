// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstddef>
#include <cstdint>
#include <minizip/unzip.h>
#include <span>

namespace gridspace::fmi {

/// A zip file in memory, as minizip wants to read one.
struct ZipInMemory {
    std::span<std::byte const> octets;
    std::uint64_t at{0};
    bool cut_short{false}; ///< more was asked for than there is
};
/// A reader of `memory`, which must outlive it; nullptr when it is no zip file. unzClose() ends it.
[[nodiscard]] unzFile open_zip(ZipInMemory& memory);

} // namespace gridspace::fmi
