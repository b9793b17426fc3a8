// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/kernel_drops.hpp"

#include <fmt/format.h>
#include <fstream>
#include <sstream>
#include <string>

namespace gridspace::launcher {

std::uint64_t kernel_drops(std::istream& softnet_stat) {
    std::uint64_t sum = 0;
    for (std::string line; std::getline(softnet_stat, line);) {
        std::istringstream numbers{line};
        std::uint64_t processed = 0, dropped = 0;
        if (numbers >> std::hex >> processed >> dropped) {
            sum += dropped;
        }
    }
    return sum;
}

std::uint64_t kernel_drops() {
    std::ifstream file{"/proc/net/softnet_stat"};
    return kernel_drops(file);
}

std::uint64_t kernel_backlog() {
    std::ifstream file{"/proc/sys/net/core/netdev_max_backlog"};
    std::uint64_t frames = 0;
    file >> frames;
    return frames;
}

std::optional<Error> lost_in_kernel(std::uint64_t dropped, std::uint64_t backlog) {
    if (dropped == 0) {
        return std::nullopt;
    }
    return Error{ExitCode::environment,
                 fmt::format("the kernel has dropped {} frames on this machine's virtual cables during the run: more "
                             "waited at a processor than net.core.netdev_max_backlog ({}) lets",
                             dropped, backlog),
                 fmt::format("sysctl -w net.core.netdev_max_backlog={}, as root", kEnoughBacklog)};
}

} // namespace gridspace::launcher
