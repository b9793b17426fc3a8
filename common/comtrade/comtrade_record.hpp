// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/comtrade/comtrade_header.hpp"
#include "common/result.hpp"

#include <filesystem>
#include <vector>

namespace gridspace {

/// A whole disturbance record: for each channel of the header one value per row. A value that is not a number is
/// missing. Multipliers and ranges of the header are filled in by what the format needs.
struct ComtradeRecord {
    ComtradeHeader header;
    std::vector<std::vector<double>> analog; ///< [channel][row]
    std::vector<std::vector<bool>> digital;  ///< [channel][row]

    [[nodiscard]] std::size_t rows() const;
};

enum class ComtradeFiles {
    pair,  ///< BASE.cfg and BASE.dat
    single ///< BASE.cff, with all parts in one (C37.111-2013)
};

/// Writes a record. ASCII stores whole numbers of up to five digits, BINARY of 16 bits: a channel keeps 1e-5 or 3e-5 of
/// its largest value. Returns the .cfg, or the .cff.
[[nodiscard]] Result<std::filesystem::path> write_comtrade(std::filesystem::path const& base, ComtradeRecord record,
                                                           ComtradeFormat format,
                                                           ComtradeFiles files = ComtradeFiles::pair);

} // namespace gridspace
