// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace::bus {

/// Debian's Fast DDS is built with its assertions, and each lock that it takes asks the kernel which thread this is:
/// two of three system calls of a lockstep run. A program that has this in it answers such a question from memory, once
/// the kernel has said it to the thread: `syscall` of the C library is replaced, and passes everything else on. To be
/// called by whoever uses the library, so that the linker takes it in.
void remember_thread_ids();

} // namespace gridspace::bus
