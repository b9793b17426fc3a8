// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace {

/// From now on this process may make the system calls of common/privileges/allowed_calls.hpp and no others, all its
/// threads. Another call ends the process by SIGSYS, after a line on standard error that names it; one that this build
/// has never heard of fails with ENOSYS, as on a kernel without it. Threads may be started, namespaces not made. False
/// where the kernel has no seccomp filters (qemu-user). Under a sanitizer what its reports need is allowed too.
bool allow_only_known_calls() noexcept;

/// Also no raw sockets and no entering of namespaces: for who has none of its own. (Who exchanges raw frames opens its
/// port again when the interface comes back.)
bool forbid_raw_sockets() noexcept;

} // namespace gridspace
