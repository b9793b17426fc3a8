// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace::bus {

/// Between cork() and uncork(), what this thread writes to the same destination is gathered and goes out as one RTPS
/// message of several submessages, in one datagram. In lockstep a tick's samples and its clock or acknowledgement
/// travel together: half the system calls and wake-ups. Calls do not nest; uncork() without cork() does nothing.
/// Leaving the bus (the end of a Participant) uncorks.
void cork();
void uncork();

} // namespace gridspace::bus
