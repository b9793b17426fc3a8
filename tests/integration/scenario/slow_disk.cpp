// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Preloaded by slow_disk_test.py: the recorder's disk takes GRIDSPACE_TEST_FSYNC_S seconds to have everything.
#include <cstdlib>
#include <cstring>
#include <dlfcn.h>
#include <unistd.h>

extern "C" int fsync(int fd) {
    using Original = int (*)(int);
    static auto const original = reinterpret_cast<Original>(dlsym(RTLD_NEXT, "fsync"));
    char const* const seconds = std::getenv("GRIDSPACE_TEST_FSYNC_S");
    char const* const process = std::getenv("GRIDSPACE_PROCESS");
    bool const is_recorder = process != nullptr && std::strcmp(process, "recorder") == 0;
    for (int left = seconds == nullptr || !is_recorder ? 0 : std::atoi(seconds); left > 0;) {
        left = static_cast<int>(::sleep(static_cast<unsigned>(left)));
    }
    return original(fd);
}
