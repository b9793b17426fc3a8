// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Preloaded by tick_length_test.py: every process of a run sleeps for up to GRIDSPACE_TEST_DELAY_US now and then,
// before it sends and behind what it waits for, another time in every process and every run.
#include <cstdlib>
#include <dlfcn.h>
#include <random>
#include <sys/epoll.h>
#include <sys/socket.h>
#include <unistd.h>

namespace {

void dawdle() {
    static char const* const longest = std::getenv("GRIDSPACE_TEST_DELAY_US");
    static thread_local std::minstd_rand random{std::random_device{}()};
    constexpr unsigned kOneIn = 16;
    if (longest != nullptr && random() % kOneIn == 0) {
        ::usleep(static_cast<useconds_t>(random() % static_cast<unsigned>(std::atoi(longest))));
    }
}

template <class Function>
Function original(char const* name) {
    return reinterpret_cast<Function>(dlsym(RTLD_NEXT, name));
}

} // namespace

extern "C" ssize_t sendto(int fd, void const* data, size_t size, int flags, sockaddr const* to, socklen_t length) {
    static auto const call = original<decltype(&sendto)>("sendto");
    dawdle();
    return call(fd, data, size, flags, to, length);
}

extern "C" ssize_t sendmsg(int fd, msghdr const* message, int flags) {
    static auto const call = original<decltype(&sendmsg)>("sendmsg");
    dawdle();
    return call(fd, message, flags);
}

extern "C" int sendmmsg(int fd, mmsghdr* messages, unsigned count, int flags) {
    static auto const call = original<decltype(&sendmmsg)>("sendmmsg");
    dawdle();
    return call(fd, messages, count, flags);
}

extern "C" int epoll_wait(int fd, epoll_event* events, int most, int timeout) {
    static auto const call = original<decltype(&epoll_wait)>("epoll_wait");
    int const count = call(fd, events, most, timeout);
    dawdle();
    return count;
}
