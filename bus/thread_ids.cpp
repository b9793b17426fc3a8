// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/thread_ids.hpp"

#include <array>
#include <cstdarg>
#include <dlfcn.h>
#include <pthread.h>
#include <sys/syscall.h>

namespace {

using Syscall = long (*)(long, ...);

thread_local long known_id = 0;

Syscall of_the_c_library() {
    static auto const found = reinterpret_cast<Syscall>(::dlsym(RTLD_NEXT, "syscall"));
    return found;
}

} // namespace

namespace gridspace::bus {

void remember_thread_ids() {
    // The thread that goes on in a forked process has another one there.
    static int const registered = ::pthread_atfork(nullptr, nullptr, [] { known_id = 0; });
    (void)registered;
}

} // namespace gridspace::bus

/// As syscall(2).
// NOLINTNEXTLINE(readability-identifier-naming,cert-dcl50-cpp): the C library's own name and way
extern "C" __attribute__((visibility("default"))) long syscall(long number, ...) noexcept {
    if (number == SYS_gettid && known_id != 0) {
        return known_id;
    }
    std::array<long, 6> a{}; // no call has more; what it does not have is never looked at
    va_list list;            // NOLINT(cppcoreguidelines-pro-type-vararg)
    va_start(list, number);
    for (long& argument : a) {
        argument = va_arg(list, long);
    }
    va_end(list);
    long const answer = of_the_c_library()(number, a[0], a[1], a[2], a[3], a[4], a[5]);
    if (number == SYS_gettid) {
        known_id = answer;
    }
    return answer;
}
