// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/ids/scan/capture_scan.hpp"

#include <string>
#include <vector>

namespace gridspace::scan {

/// The tables of a scan, as text; the first row is the header.
using Rows = std::vector<std::vector<std::string>>;
[[nodiscard]] Rows stream_rows(CaptureScan const& scan);
[[nodiscard]] Rows line_rows(CaptureScan const& scan);
[[nodiscard]] Rows alarm_rows(CaptureScan const& scan);

/// What was left out, and why.
[[nodiscard]] std::vector<std::string> notes_of(CaptureScan const& scan);

/// Counted over all senders of a stream.
struct Counts {
    std::uint64_t frames{0}, lost{0}, duplicates{0}, out_of_order{0}, restarts{0}, states{0};
};
[[nodiscard]] Counts counts_of(StreamScan const& stream);

} // namespace gridspace::scan
