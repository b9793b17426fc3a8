// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace::cli {

struct LatencyQuestion {
    double period_us{0}; ///< between two instants that are waited for
    double seconds{0};   ///< for each way to wait
    bool json{false};
};

/// `gridspace doctor --latency`: how late this machine wakes a process up, for each way to wait. The exit code.
int show_latency(LatencyQuestion const& asked);

} // namespace gridspace::cli
