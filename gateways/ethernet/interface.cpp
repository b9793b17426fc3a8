// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/interface.hpp"

#include "common/log.hpp"
#include "common/text.hpp"
#include "common/unique_fd.hpp"

#include <algorithm>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <net/if.h>
#include <netinet/in.h>
#include <sstream>
#include <sys/ioctl.h>
#include <sys/socket.h>
#include <thread>

namespace gridspace::ethernet {
namespace {

/// A name that fits struct ifreq: longer ones cannot exist, and copying them blindly has been a vulnerability
/// elsewhere.
bool fits(std::string const& name) {
    return !name.empty() && name.size() < IFNAMSIZ && name.find('\0') == std::string::npos;
}

bool query(std::string const& name, unsigned long request, ifreq& out, int family = AF_UNIX) {
    UniqueFd const socket{::socket(family, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    out = {};
    std::memcpy(out.ifr_name, name.c_str(), name.size() + 1);
    return socket && ::ioctl(socket.get(), request, &out) == 0;
}

} // namespace

std::string_view state_name(LinkState state) noexcept {
    constexpr std::string_view kNames[] = {"up", "down", "missing", "renamed"};
    return kNames[static_cast<std::size_t>(state)];
}

LinkState link_state(std::string const& interface, unsigned index) {
    ifreq request{};
    if (fits(interface) && query(interface, SIOCGIFFLAGS, request)) {
        auto const flags = static_cast<unsigned>(request.ifr_flags);
        return (flags & (IFF_UP | IFF_RUNNING)) == (IFF_UP | IFF_RUNNING) ? LinkState::up : LinkState::down;
    }
    char name[IFNAMSIZ];
    return index != 0 && ::if_indextoname(index, name) != nullptr ? LinkState::renamed : LinkState::missing;
}

void wait_for_interface(std::string const& interface, std::chrono::milliseconds patience) {
    constexpr auto kPeriod = std::chrono::milliseconds{50}, kUnsaid = std::chrono::milliseconds{500};
    auto const began = std::chrono::steady_clock::now();
    auto present = began; // since when
    bool said = false;
    while (true) {
        LinkState const state = link_state(interface);
        auto const now = std::chrono::steady_clock::now();
        if (state == LinkState::up || now - began >= patience) {
            return;
        }
        if (state == LinkState::missing) {
            present = now;
            if (!said && now - began >= kUnsaid) {
                said = true;
                log::info("waits for the interface '{}'", interface);
            }
        } else if (now - present >= kUnsaid) {
            log::warning("the interface '{}' is down or has no carrier: nothing is sent or received until that changes",
                         interface);
            return;
        }
        std::this_thread::sleep_for(kPeriod);
    }
}

Result<unsigned> interface_index(std::string const& interface) {
    unsigned const index = fits(interface) ? ::if_nametoindex(interface.c_str()) : 0;
    if (index == 0) {
        return fail(ExitCode::environment, fmt::format("there is no network interface '{}'", interface.substr(0, 64)),
                    fmt::format("there are: {}", join(interfaces(), ", ")));
    }
    return index;
}

Result<iec61850::Mac> interface_mac(std::string const& interface) {
    auto const index = interface_index(interface);
    if (!index) {
        return std::unexpected{index.error()};
    }
    ifreq request{};
    if (!query(interface, SIOCGIFHWADDR, request)) {
        return fail(ExitCode::environment,
                    fmt::format("interface '{}' does not tell its address: {}", interface, std::strerror(errno)));
    }
    iec61850::Mac mac;
    std::copy_n(reinterpret_cast<std::uint8_t const*>(request.ifr_hwaddr.sa_data), 6, mac.octets.begin());
    return mac;
}

std::optional<std::array<std::uint8_t, 4>> interface_ipv4(std::string const& interface) {
    ifreq request{};
    if (!fits(interface) || !query(interface, SIOCGIFADDR, request, AF_INET)) {
        return std::nullopt;
    }
    std::array<std::uint8_t, 4> out{};
    std::memcpy(out.data(), &reinterpret_cast<sockaddr_in const&>(request.ifr_addr).sin_addr, out.size());
    return out;
}

std::optional<std::uint64_t> interface_received(std::string const& interface) {
    // Of the calling thread's network namespace; /sys may still show another one's.
    std::ifstream table{"/proc/thread-self/net/dev"};
    for (std::string line; std::getline(table, line);) {
        std::size_t const colon = line.find(':');
        if (colon == std::string::npos || trim(line.substr(0, colon)) != interface) {
            continue;
        }
        std::istringstream numbers{line.substr(colon + 1)};
        std::uint64_t octets = 0, frames = 0;
        return numbers >> octets >> frames ? std::optional{frames} : std::nullopt;
    }
    return std::nullopt;
}

std::vector<std::string> interfaces() {
    std::vector<std::string> out;
    if (auto* const list = ::if_nameindex()) {
        for (auto const* entry = list; entry->if_index != 0; ++entry) {
            out.emplace_back(entry->if_name);
        }
        ::if_freenameindex(list);
    }
    return out;
}

} // namespace gridspace::ethernet
