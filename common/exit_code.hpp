// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace {

/// How every program of Gridspace ends (docs/reference/exit_codes.md).
enum class ExitCode : int {
    ok = 0,
    expectation_failed = 1, ///< the run finished, and an expectation of its scenario did not hold
    usage = 2,              ///< command line or configuration
    environment = 3,        ///< a capability, interface, port, file or package is missing
    child_died = 4,         ///< a process of the run ended before its time
    stall = 5,              ///< somebody was waited for longer than the deadline
    interrupted = 130,      ///< Ctrl-C
};

} // namespace gridspace
