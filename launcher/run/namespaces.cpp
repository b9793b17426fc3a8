// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/namespaces.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/prctl.h>
#include <sys/syscall.h>
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

/// The child must not outlive its parent, whatever happens to that.
void follow_parent(pid_t parent) {
    ::prctl(PR_SET_PDEATHSIG, SIGKILL);
    ::prctl(PR_SET_NAME, "gridspace-run");
    ::setpgid(0, 0); // Ctrl-C is for the parent, which ends this in order
    (void)parent;
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
    pid_t const parent = ::getpid();
    int ready[2];
    if (::pipe2(ready, O_CLOEXEC) != 0) {
        return fail(ExitCode::environment, fmt::format("no pipe: {}", std::strerror(errno)));
    }
    // As fork(), with new namespaces. This process has one thread.
    auto const pid = static_cast<pid_t>(::syscall(SYS_clone, flags, nullptr, nullptr, nullptr, nullptr));
    if (pid < 0) {
        int const why = errno;
        ::close(ready[0]);
        ::close(ready[1]);
        return fail(ExitCode::environment, fmt::format("cannot make namespaces: {}", std::strerror(why)),
                    root ? "is this a container without CAP_SYS_ADMIN?"
                         : "unprivileged user namespaces are switched off here; try as root");
    }
    if (pid == 0) {
        follow_parent(parent);
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
        [[maybe_unused]] auto const written = ::write(ready[1], &answer, 1);
        ::close(ready[1]);
        ::_exit(ok ? body() : static_cast<int>(ExitCode::environment));
    }
    ::close(ready[1]);
    char answer = 'n';
    ssize_t const size = ::read(ready[0], &answer, 1);
    ::close(ready[0]);
    if (size != 1 || answer != 'y') {
        ::kill(pid, SIGKILL);
        return fail(ExitCode::environment, "the namespaces of the run could not be prepared",
                    "`gridspace doctor` looks at what the kernel allows");
    }
    return pid;
}

Result<pid_t> start_without_namespaces(std::function<int()> const& body) {
    pid_t const parent = ::getpid();
    pid_t const pid = ::fork();
    if (pid < 0) {
        return fail(ExitCode::environment, fmt::format("cannot fork: {}", std::strerror(errno)));
    }
    if (pid == 0) {
        follow_parent(parent);
        ::prctl(PR_SET_CHILD_SUBREAPER, 1);
        ::_exit(body());
    }
    return pid;
}

} // namespace gridspace::launcher
