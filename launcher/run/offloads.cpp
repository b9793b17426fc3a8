// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/offloads.hpp"

#include <array>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <linux/ethtool.h>
#include <linux/sockios.h>
#include <net/if.h>
#include <sched.h>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

/// In a process of its own, which is in the namespace; errno, or 0.
int switch_off(int netns, std::string const& interface) {
    if (::setns(netns, CLONE_NEWNET) != 0) {
        return errno;
    }
    int const fd = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
    if (fd < 0) {
        return errno;
    }
    for (std::uint32_t const command : std::array<std::uint32_t, 3>{ETHTOOL_STXCSUM, ETHTOOL_STSO, ETHTOOL_SGSO}) {
        ethtool_value off{command, 0};
        ifreq request{};
        std::strncpy(request.ifr_name, interface.c_str(), IFNAMSIZ - 1);
        request.ifr_data = reinterpret_cast<char*>(&off);
        if (::ioctl(fd, SIOCETHTOOL, &request) != 0 && errno != EOPNOTSUPP) {
            return errno;
        }
    }
    return 0;
}

} // namespace

Result<void> finish_frames_before_sending(int netns, std::string const& interface) {
    pid_t const pid = ::fork();
    if (pid == 0) {
        ::_exit(switch_off(netns, interface) & 0xFF);
    }
    int status = 0;
    if (pid < 0 || ::waitpid(pid, &status, 0) != pid) {
        return fail(ExitCode::environment,
                    fmt::format("no process for the settings of '{}': {}", interface, std::strerror(errno)));
    }
    int const error = WIFEXITED(status) ? WEXITSTATUS(status) : EINTR;
    if (error != 0) {
        return fail(ExitCode::environment,
                    fmt::format("cannot switch the offloads of '{}' off: {}", interface, std::strerror(error)),
                    "a place in a cable that carries IP needs it");
    }
    return {};
}

} // namespace gridspace::launcher
