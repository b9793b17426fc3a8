// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Loaded before our programs where they run under qemu-user (LD_PRELOAD), and nowhere else: a board has a kernel of its
// own. qemu-user knows no IP_MULTICAST_IF and says ENOPROTOOPT; Fast DDS then has no socket to announce itself with,
// and is never seen by anybody. The interface that the option would choose is the one that the default multicast route
// chooses.
#include <cerrno>
#include <dlfcn.h>
#include <netinet/in.h>
#include <sys/socket.h>

extern "C" int setsockopt(int fd, int level, int option, void const* value, socklen_t size) noexcept {
    using Function = int (*)(int, int, int, void const*, socklen_t);
    static auto const real = reinterpret_cast<Function>(dlsym(RTLD_NEXT, "setsockopt"));
    int const result = real(fd, level, option, value, size);
    if (result < 0 && errno == ENOPROTOOPT && level == IPPROTO_IP && option == IP_MULTICAST_IF) {
        return 0;
    }
    return result;
}
