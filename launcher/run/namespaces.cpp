// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/namespaces.hpp"

#include "common/unique_fd.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <poll.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

bool write_file(char const* path, std::string const& text) {
    int const fd = ::open(path, O_WRONLY | O_CLOEXEC);
    bool const ok = fd >= 0 && ::write(fd, text.data(), text.size()) == static_cast<ssize_t>(text.size());
    if (fd >= 0) {
        ::close(fd);
    }
    return ok;
}

/// The child must not outlive its parent, whatever happens to that. `to_parent` is the writing end of a pipe that only
/// the parent reads: when nobody does any more, the parent died before the kernel knew whom to end with it. (Its
/// process id says nothing to the first process of a PID namespace: 0 is all it sees of anybody outside.)
void follow_parent(int to_parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    pollfd nobody_reads{to_parent, 0, 0};
    if (::poll(&nobody_reads, 1, 0) > 0 && (nobody_reads.revents & POLLERR) != 0) {
        ::_exit(static_cast<int>(ExitCode::interrupted));
    }
    ::prctl(PR_SET_NAME, "gridspace-run");
    ::setpgid(0, 0); // Ctrl-C is for the parent, which ends this in order
}

} // namespace

Result<pid_t> start_in_namespaces(std::function<int()> const& body) {
    bool const root = ::geteuid() == 0;
    uid_t const uid = ::geteuid();
    gid_t const gid = ::getegid();
    unsigned long flags = CLONE_NEWNET | CLONE_NEWNS | CLONE_NEWPID | SIGCHLD;
    if (!root) {
        flags |= CLONE_NEWUSER;
    }
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", std::strerror(errno)));
    }
    UniqueFd from_child{ends[0]}, to_parent{ends[1]};
    // As fork(), with new namespaces. This process has one thread.
    auto const pid = static_cast<pid_t>(::syscall(SYS_clone, flags, nullptr, nullptr, nullptr, nullptr));
    if (pid < 0) {
        int const why = errno;
        return fail(ExitCode::environment, fmt::format("cannot make namespaces: {}", std::strerror(why)),
                    root ? "is this a container without CAP_SYS_ADMIN?"
                         : "unprivileged user namespaces are switched off here; try as root");
    }
    if (pid == 0) {
        from_child.reset();
        follow_parent(to_parent.get());
        bool ok = true;
        if (!root) {
            ok = write_file("/proc/self/setgroups", "deny") &&
                 write_file("/proc/self/uid_map", fmt::format("0 {} 1", uid)) &&
                 write_file("/proc/self/gid_map", fmt::format("0 {} 1", gid));
        }
        ok = ok && ::mount(nullptr, "/", nullptr, MS_REC | MS_PRIVATE, nullptr) == 0;
        ::mount("proc", "/proc", "proc", MS_NOSUID | MS_NODEV | MS_NOEXEC,
                nullptr); // so that its tools see its processes
        char const answer = ok ? 'y' : 'n';
        [[maybe_unused]] auto const written = ::write(to_parent.get(), &answer, 1);
        to_parent.reset();
        ::_exit(ok ? body() : static_cast<int>(ExitCode::environment));
    }
    to_parent.reset();
    char answer = 'n';
    ssize_t const size = ::read(from_child.get(), &answer, 1);
    if (size != 1 || answer != 'y') {
        ::kill(pid, SIGKILL);
        ::waitpid(pid, nullptr, 0);
        return fail(ExitCode::environment, "the namespaces of the run could not be prepared",
                    "`gridspace doctor` looks at what the kernel allows");
    }
    return pid;
}

Result<pid_t> start_without_namespaces(std::function<int()> const& body) {
    int ends[2];
    if (::pipe2(ends, O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", std::strerror(errno)));
    }
    UniqueFd from_child{ends[0]}, to_parent{ends[1]};
    pid_t const pid = ::fork();
    if (pid < 0) {
        return fail(ExitCode::environment, fmt::format("cannot fork: {}", std::strerror(errno)));
    }
    if (pid == 0) {
        from_child.reset();
        follow_parent(to_parent.get());
        to_parent.reset(); // the parent goes on when it has the child's word, and that is its end of the pipe
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);
        ::_exit(body());
    }
    to_parent.reset();
    char end = 0;
    [[maybe_unused]] auto const size = ::read(from_child.get(), &end, 1);
    return pid;
}

} // namespace gridspace::launcher
