// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace::bus {

/// While it lives, what its thread writes to one destination is gathered, and leaves as one RTPS message of several
/// submessages, in one datagram, when it ends. In lockstep a tick's samples and its clock or acknowledgement travel
/// together: half the system calls and wake-ups. One at a time in a thread. It ends in the thread where it began, and
/// before the participants whose messages it holds.
class SendTogether {
  public:
    SendTogether();
    ~SendTogether();
    SendTogether(SendTogether const&) = delete;
    SendTogether& operator=(SendTogether const&) = delete;
};

} // namespace gridspace::bus
