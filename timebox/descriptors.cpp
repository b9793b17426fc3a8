// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/descriptors.hpp"

#include "timebox/simulated_clock.hpp"

#include <algorithm>
#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>

namespace gridspace::timebox {
namespace {

std::optional<std::int64_t> in_ms(std::uint64_t argument) {
    auto const ms = static_cast<int>(argument);
    return ms < 0 ? std::nullopt : std::optional{std::int64_t{ms} * 1'000'000};
}

std::optional<std::int64_t> in_timespec(pid_t tid, std::uint64_t pointer) {
    return pointer == 0 ? std::nullopt : std::optional{to_ns(value_at<timespec>(tid, pointer))};
}

void add_set(pid_t tid, int count, std::uint64_t pointer, short events, std::vector<Interest>& out) {
    if (pointer == 0) {
        return;
    }
    std::vector<std::uint64_t> words((static_cast<std::size_t>(count) + 63) / 64);
    if (!read_memory(tid, pointer, words.data(), words.size() * 8)) {
        return;
    }
    for (int fd = 0; fd < count; ++fd) {
        if (((words[static_cast<std::size_t>(fd) / 64] >> (static_cast<unsigned>(fd) % 64U)) & 1U) != 0) {
            out.push_back({fd, events});
        }
    }
}

} // namespace

DescriptorWait wait_of(pid_t tid, Call const& call) {
    constexpr std::uint64_t kMaxDescriptors = 65'536;
    auto const& a = call.arguments;
    DescriptorWait out;
    switch (call.number) {
    case SYS_poll:
    case SYS_ppoll: {
        std::vector<pollfd> list(std::min(a[1], kMaxDescriptors));
        if (!list.empty() && read_memory(tid, a[0], list.data(), list.size() * sizeof(pollfd))) {
            for (pollfd const& p : list) {
                if (p.fd >= 0) {
                    out.interests.push_back({p.fd, p.events});
                }
            }
        }
        out.timeout_argument = 2;
        out.timeout_is_pointer = call.number == SYS_ppoll;
        out.timeout_ns = out.timeout_is_pointer ? in_timespec(tid, a[2]) : in_ms(a[2]);
        break;
    }
    case SYS_select:
    case SYS_pselect6: {
        auto const count = static_cast<int>(std::min(a[0], kMaxDescriptors));
        add_set(tid, count, a[1], POLLIN, out.interests);
        add_set(tid, count, a[2], POLLOUT, out.interests);
        add_set(tid, count, a[3], POLLPRI, out.interests);
        out.timeout_argument = 4;
        out.timeout_is_pointer = true;
        if (a[4] != 0 && call.number == SYS_select) {
            auto const t = value_at<timeval>(tid, a[4]);
            out.timeout_ns = static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_usec * 1000;
        } else {
            out.timeout_ns = in_timespec(tid, a[4]);
        }
        break;
    }
    default: // epoll: its own descriptor is readable when one of its list is ready
        out.interests.push_back({static_cast<int>(a[0]), POLLIN});
        out.timeout_argument = 3;
        out.timeout_is_pointer = call.number != SYS_epoll_wait && call.number != SYS_epoll_pwait;
        out.timeout_ns = out.timeout_is_pointer ? in_timespec(tid, a[3]) : in_ms(a[3]);
    }
    return out;
}

Descriptors::Descriptors(pid_t process) : process_{static_cast<int>(::syscall(SYS_pidfd_open, process, 0))} {}

UniqueFd Descriptors::copy_of(int fd) const {
    return UniqueFd{static_cast<int>(::syscall(SYS_pidfd_getfd, process_.get(), fd, 0))};
}

bool Descriptors::poll(std::span<Interest const> interests, int timeout_ms) const {
    std::vector<UniqueFd> copies;
    std::vector<pollfd> list;
    for (Interest const& i : interests) {
        copies.push_back(copy_of(i.fd));
        if (!copies.back()) {
            return true; // the call itself will say what is wrong with it
        }
        list.push_back({copies.back().get(), i.events, 0});
    }
    return ::poll(list.data(), list.size(), timeout_ms) > 0;
}

bool Descriptors::any_ready(std::span<Interest const> interests) const {
    return !interests.empty() && poll(interests, 0);
}

bool Descriptors::wait_outside(std::span<Interest const> interests, int timeout_ms) const {
    return poll(interests, timeout_ms);
}

bool does_not_block(UniqueFd const& file) {
    return !file || (::fcntl(file.get(), F_GETFL) & O_NONBLOCK) != 0;
}

bool is_ready(UniqueFd const& file, short event) {
    pollfd entry{file.get(), event, 0};
    return !file || ::poll(&entry, 1, 0) > 0;
}

std::optional<std::int64_t> receive_timeout_ns(UniqueFd const& file) {
    return timeout_ns(file, SO_RCVTIMEO);
}

std::optional<std::int64_t> timeout_ns(UniqueFd const& file, int option) {
    timeval t{};
    socklen_t size = sizeof t;
    if (!file || ::getsockopt(file.get(), SOL_SOCKET, option, &t, &size) != 0 || (t.tv_sec == 0 && t.tv_usec == 0)) {
        return std::nullopt;
    }
    return static_cast<std::int64_t>(t.tv_sec) * 1'000'000'000 + t.tv_usec * 1000;
}

} // namespace gridspace::timebox
