// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/descriptors.hpp"

#include "timebox/simulated_clock.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <fcntl.h>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/select.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <sys/time.h>
#include <utility>

namespace gridspace::timebox {
namespace {

constexpr std::uint64_t kMaxDescriptors = 65'536;

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
    auto const& a = call.arguments;
    DescriptorWait out;
    switch (call.number) {
    case SYS_poll:
    case SYS_ppoll:
        out.timeout_ns = call.number == SYS_ppoll ? in_timespec(tid, a[2]) : in_ms(a[2]);
        out.signal_mask_at = call.number == SYS_ppoll ? a[3] : 0;
        break;
    case SYS_select:
    case SYS_pselect6:
        // The sixth argument of pselect6 points to a pointer (select(2), C library/kernel differences).
        out.signal_mask_at = call.number == SYS_pselect6 && a[5] != 0 ? value_at<std::uint64_t>(tid, a[5]) : 0;
        if (a[4] != 0 && call.number == SYS_select) {
            auto const t = value_at<timeval>(tid, a[4]);
            out.timeout_ns = to_ns(t);
        } else {
            out.timeout_ns = in_timespec(tid, a[4]);
        }
        break;
    default:
        out.timeout_ns = call.number == SYS_epoll_pwait2 ? in_timespec(tid, a[3]) : in_ms(a[3]);
        out.signal_mask_at = call.number == SYS_epoll_wait ? 0 : a[4];
    }
    return out;
}

std::vector<Interest> interests_of(pid_t tid, Call const& call) {
    auto const& a = call.arguments;
    std::vector<Interest> out;
    switch (call.number) {
    case SYS_poll:
    case SYS_ppoll: {
        std::vector<pollfd> list(std::min(a[1], kMaxDescriptors));
        if (!list.empty() && read_memory(tid, a[0], list.data(), list.size() * sizeof(pollfd))) {
            for (pollfd const& p : list) {
                if (p.fd >= 0) {
                    out.push_back({p.fd, p.events});
                }
            }
        }
        break;
    }
    case SYS_select:
    case SYS_pselect6: {
        auto const count = static_cast<int>(std::min(a[0], kMaxDescriptors));
        add_set(tid, count, a[1], POLLIN, out);
        add_set(tid, count, a[2], POLLOUT, out);
        add_set(tid, count, a[3], POLLPRI, out);
        break;
    }
    default: // epoll: its own descriptor is readable when one of its list is ready
        out.push_back({static_cast<int>(a[0]), POLLIN});
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

namespace {

/// poll(2), also of what is not open.
struct Looked {
    std::vector<UniqueFd> copies;
    std::vector<pollfd> list; ///< of the copies
    void add(UniqueFd copy, short events) {
        list.push_back({copy.get(), events, 0});
        copies.push_back(std::move(copy));
    }
    void look() { (void)::poll(list.data(), list.size(), 0); }
};

std::int64_t look_at_list(pid_t tid, Call const& call, Descriptors const& descriptors, bool over) {
    if (call.arguments[1] > kMaxDescriptors) {
        return -EINVAL;
    }
    std::vector<pollfd> list(call.arguments[1]);
    std::size_t const octets = list.size() * sizeof(pollfd);
    if (octets > 0 && !read_memory(tid, call.arguments[0], list.data(), octets)) {
        return -EFAULT;
    }
    Looked looked;
    for (pollfd const& entry : list) {
        looked.add(entry.fd >= 0 ? descriptors.copy_of(entry.fd) : UniqueFd{}, entry.events);
    }
    looked.look();
    std::int64_t ready = 0;
    for (std::size_t i = 0; i < list.size(); ++i) {
        bool const open = looked.list[i].fd >= 0;
        list[i].revents = open ? looked.list[i].revents : list[i].fd >= 0 ? short{POLLNVAL} : short{0};
        ready += list[i].revents != 0 ? 1 : 0;
    }
    bool const ends = octets > 0 && (ready > 0 || over);
    return ends && !write_memory(tid, call.arguments[0], list.data(), octets) ? -EFAULT : ready;
}

/// What makes a descriptor of each set ready (select(2), correspondence with poll).
constexpr std::array<short, 3> kOfSets{POLLRDNORM | POLLRDBAND | POLLIN | POLLHUP | POLLERR,
                                       POLLWRBAND | POLLWRNORM | POLLOUT | POLLERR, POLLPRI};

std::int64_t look_at_sets(pid_t tid, Call const& call, Descriptors const& descriptors, bool over) {
    auto const count = static_cast<std::size_t>(std::min(call.arguments[0], kMaxDescriptors));
    std::int64_t ready = 0;
    std::array<std::vector<std::uint64_t>, 3> found;
    for (std::size_t set = 0; set < found.size(); ++set) {
        std::uint64_t const at = call.arguments[1 + set];
        if (at == 0) {
            continue;
        }
        std::vector<std::uint64_t> asked((count + 63) / 64);
        if (!asked.empty() && !read_memory(tid, at, asked.data(), asked.size() * 8)) {
            return -EFAULT;
        }
        found[set].resize(asked.size());
        for (std::size_t fd = 0; fd < count; ++fd) {
            std::uint64_t const bit = std::uint64_t{1} << (fd % 64);
            if ((asked[fd / 64] & bit) == 0) {
                continue;
            }
            UniqueFd const copy = descriptors.copy_of(static_cast<int>(fd));
            if (!copy) {
                return -EBADF;
            }
            pollfd one{copy.get(), kOfSets[set], 0};
            if (::poll(&one, 1, 0) > 0 && (one.revents & kOfSets[set]) != 0) {
                found[set][fd / 64] |= bit;
                ++ready;
            }
        }
    }
    for (std::size_t set = 0; set < found.size() && (ready > 0 || over); ++set) { // they are what it asks for, too
        if (!found[set].empty() &&
            !write_memory(tid, call.arguments[1 + set], found[set].data(), found[set].size() * 8)) {
            return -EFAULT;
        }
    }
    return ready;
}

std::int64_t look_at_epoll(pid_t tid, Call const& call, Descriptors const& descriptors) {
    constexpr int kMostEvents = 4096;
    UniqueFd const copy = descriptors.copy_of(static_cast<int>(call.arguments[0]));
    int const most = std::min(static_cast<int>(call.arguments[2]), kMostEvents);
    std::vector<epoll_event> events(static_cast<std::size_t>(std::max(most, 1)));
    int const ready = ::epoll_wait(copy.get(), events.data(), most, 0);
    if (ready < 0) {
        return -errno;
    }
    auto const octets = static_cast<std::size_t>(ready) * sizeof(epoll_event);
    return octets > 0 && !write_memory(tid, call.arguments[1], events.data(), octets) ? -EFAULT : ready;
}

} // namespace

std::int64_t Descriptors::look(pid_t tid, Call const& call, bool over) const {
    switch (call.number) {
    case SYS_poll:
    case SYS_ppoll:
        return look_at_list(tid, call, *this, over);
    case SYS_select:
    case SYS_pselect6:
        return look_at_sets(tid, call, *this, over);
    default:
        return look_at_epoll(tid, call, *this);
    }
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
    return to_ns(t);
}

} // namespace gridspace::timebox
