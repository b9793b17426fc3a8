// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Preloaded by clock_jump_test.py: for the process that GRIDSPACE_TEST_CLOCK_PROCESS names, the wall clock is an hour
// ahead as soon as the file of GRIDSPACE_TEST_CLOCK exists.
#include <cstdlib>
#include <cstring>
#include <ctime>
#include <dlfcn.h>
#include <unistd.h>

extern "C" int clock_gettime(clockid_t clock, timespec* out) noexcept {
    using Original = int (*)(clockid_t, timespec*);
    static auto const original = reinterpret_cast<Original>(dlsym(RTLD_NEXT, "clock_gettime"));
    int const result = original(clock, out);
    if (clock == CLOCK_REALTIME && result == 0) {
        char const* const file = std::getenv("GRIDSPACE_TEST_CLOCK");
        char const* const wanted = std::getenv("GRIDSPACE_TEST_CLOCK_PROCESS");
        char const* const process = std::getenv("GRIDSPACE_PROCESS");
        if (file != nullptr && wanted != nullptr && process != nullptr && std::strcmp(wanted, process) == 0 &&
            access(file, F_OK) == 0) {
            out->tv_sec += 3600;
        }
    }
    return result;
}
