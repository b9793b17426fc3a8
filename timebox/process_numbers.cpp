// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/process_numbers.hpp"

#include <algorithm>
#include <array>
#include <cerrno>
#include <csignal>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::timebox {
namespace {

bool write_file(char const* path, char const* text) {
    int const file = ::open(path, O_WRONLY | O_CLOEXEC);
    bool const done = file >= 0 && ::write(file, text, std::strlen(text)) == static_cast<ssize_t>(std::strlen(text));
    ::close(file);
    return done;
}

/// An ordinary user needs a user namespace for that, in which he is who he was.
bool separate() {
    constexpr int kOwn = CLONE_NEWPID | CLONE_NEWNS;
    if (::unshare(kOwn) == 0) {
        return true;
    }
    std::array<char, 64> users{}, groups{};
    std::snprintf(users.data(), users.size(), "%u %u 1", ::geteuid(), ::geteuid());
    std::snprintf(groups.data(), groups.size(), "%u %u 1", ::getegid(), ::getegid());
    return ::unshare(CLONE_NEWUSER | kOwn) == 0 && write_file("/proc/self/setgroups", "deny") &&
           write_file("/proc/self/uid_map", users.data()) && write_file("/proc/self/gid_map", groups.data());
}

/// A child of this process's parent, in the namespaces of this process's children.
pid_t fork_sibling() {
    return static_cast<pid_t>(::syscall(SYS_clone, CLONE_PARENT | SIGCHLD, nullptr, nullptr, nullptr, nullptr));
}

/// Number 1. `ready`: signalled when the program may begin.
[[noreturn]] void keep(int life, int ready) {
    ::signal(SIGCHLD, SIG_IGN); // orphans are not waited for
    for (int const signal : {SIGINT, SIGTERM, SIGHUP, SIGQUIT}) {
        ::signal(signal, SIG_IGN); // of a terminal: the program decides
    }
    // A program that looks by number into /proc finds the box's processes. Where /proc may not be mounted, those of the
    // machine, and /proc/self is right all the same.
    ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr);
    ::mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC, nullptr);
    ::prctl(PR_SET_NAME, "gridspace-box");
    char octet = 0;
    (void)!::write(ready, &octet, 1);
    ::dup2(life, 0);
    ::close_range(1, ~0U, 0);
    life = 0;
    while (::read(life, &octet, 1) < 0 && errno == EINTR) {
    }
    ::_exit(0);
}

} // namespace

void ProcessNumbers::end() {
    life.reset();
    if (keeper > 0) {
        ::kill(keeper, SIGKILL);
        keeper = 0;
    }
}

int fork_numbered(ProcessNumbers& numbers, std::span<pid_t> children) {
    std::fill(children.begin(), children.end(), -1);
    std::array<int, 2> life{-1, -1}, ready{-1, -1}, said{-1, -1};
    if (::pipe2(life.data(), O_CLOEXEC) != 0 || ::pipe2(ready.data(), O_CLOEXEC) != 0 ||
        ::pipe2(said.data(), O_CLOEXEC) != 0) {
        return -1;
    }
    numbers.life = UniqueFd{life[1]};
    UniqueFd const hears{life[0]}, from{said[0]}, ready_from{ready[0]};
    UniqueFd to{said[1]}, ready_to{ready[1]};
    pid_t const between = ::fork();
    if (between == 0) {
        pid_t const first = separate() ? fork_sibling() : -1;
        if (first == 0) {
            ::close(numbers.life.get());
            keep(hears.get(), ready_to.get());
        }
        ready_to.reset();
        char octet = 0;
        if (first < 0 || ::read(ready_from.get(), &octet, 1) != 1) {
            ::_exit(1);
        }
        (void)!::write(to.get(), &first, sizeof first);
        for (std::size_t i = 0; i < children.size(); ++i) {
            pid_t const child = fork_sibling();
            if (child == 0) {
                return static_cast<int>(i);
            }
            (void)!::write(to.get(), &child, sizeof child);
        }
        ::_exit(0);
    }
    to.reset();
    ready_to.reset();
    auto const next = [&] {
        pid_t out = -1;
        return ::read(from.get(), &out, sizeof out) == sizeof out ? out : pid_t{-1};
    };
    pid_t const first = between > 0 ? next() : -1;
    for (std::size_t i = 0; first > 0 && i < children.size(); ++i) {
        children[i] = next();
    }
    while (between > 0 && ::waitpid(between, nullptr, 0) < 0 && errno == EINTR) {
    }
    if (first > 0) {
        numbers.keeper = first;
        return -1;
    }
    for (std::size_t i = 0; i < children.size(); ++i) {
        children[i] = ::fork();
        if (children[i] == 0) {
            return static_cast<int>(i);
        }
    }
    return -1;
}

} // namespace gridspace::timebox
