// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/ids/scan/line_watch.hpp"
#include "launcher/ids/scan/stream_watch.hpp"

#include <filesystem>

namespace gridspace::scan {

struct ScanOptions {
    std::filesystem::path file;
    KnownStreams known{{}, {}};
    ForecastSettings forecast;
    struct Line {
        std::string from, to; ///< names in the files of streams, or svIDs
    };
    std::vector<Line> lines;
    std::vector<std::string> streams; ///< only these; empty: all
    std::string only;                 ///< only this interface of the capture, or these of a link ("process_bus")
    bool check_clock{false};          ///< GOOSE: |t - time of the capture| of a new state
};

struct CaptureScan {
    std::uint64_t frames{0}, other{0};
    std::uint64_t no_ethernet{0};  ///< of interfaces of another link type; not looked at
    std::uint64_t cut{0};          ///< of which the capture kept only the beginning
    std::uint64_t beyond_table{0}; ///< of more streams or interfaces than are watched
    bool truncated{false};
    std::int64_t first_ns{0}, last_ns{0};
    iec61850::DecodeCounters errors;
    std::vector<StreamScan> streams; ///< by place and name
    std::vector<LineScan> lines;

    [[nodiscard]] double seconds(Place at) const { return static_cast<double>(at.time_ns - first_ns) * 1e-9; }
    [[nodiscard]] bool has_alarms() const;
};

/// Where a frame was seen: "process_bus" for the ports of a link of ours, which all hear the same, and otherwise the
/// interface.
[[nodiscard]] std::string vantage_of(std::string const& interface);

/// Reads a capture twice: to learn what there is, and to judge it. Fails when it holds nothing to judge.
[[nodiscard]] Result<CaptureScan> scan_capture(ScanOptions const& options);

} // namespace gridspace::scan
