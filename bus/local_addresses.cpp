// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/local_addresses.hpp"

#include "common/log.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <fmt/format.h>
#include <ifaddrs.h>
#include <net/if.h>
#include <thread>

namespace gridspace::bus {
namespace {

using Clock = std::chrono::steady_clock;

struct InterfaceAddress {
    std::string interface, address;
};

/// IPv4 addresses of the interfaces that run: Fast DDS uses no others, and a link that has just been set up runs a
/// moment later.
std::vector<InterfaceAddress> interface_addresses() {
    std::vector<InterfaceAddress> out;
    ifaddrs* list = nullptr;
    if (::getifaddrs(&list) != 0) {
        return out;
    }
    for (ifaddrs const* i = list; i != nullptr; i = i->ifa_next) {
        if (i->ifa_addr == nullptr || i->ifa_addr->sa_family != AF_INET ||
            (i->ifa_flags & (IFF_UP | IFF_RUNNING)) != (IFF_UP | IFF_RUNNING)) {
            continue;
        }
        std::array<char, INET_ADDRSTRLEN> text{};
        auto const* address = reinterpret_cast<sockaddr_in const*>(i->ifa_addr);
        ::inet_ntop(AF_INET, &address->sin_addr, text.data(), text.size());
        out.push_back({i->ifa_name, text.data()});
    }
    ::freeifaddrs(list);
    return out;
}

} // namespace

Result<void> wait_for_addresses(std::vector<std::string> const& addresses, std::chrono::milliseconds patience) {
    constexpr auto kPeriod = std::chrono::milliseconds{50}, kUnsaid = std::chrono::milliseconds{500};
    auto const began = Clock::now();
    bool said = false;
    while (true) {
        std::vector<InterfaceAddress> const here = interface_addresses();
        std::vector<std::string> missing;
        for (std::string const& address : addresses) {
            if (std::none_of(here.begin(), here.end(),
                             [&](InterfaceAddress const& held) { return held.address == address; })) {
                missing.push_back(address);
            }
        }
        if (missing.empty()) {
            return {};
        }
        auto const waited = Clock::now() - began;
        if (waited >= patience) {
            std::vector<std::string> listed;
            for (InterfaceAddress const& held : here) {
                listed.push_back(fmt::format("{} {}", held.interface, held.address));
            }
            return fail(ExitCode::environment,
                        fmt::format("no interface has the address {}{}", join(missing, ", "),
                                    patience > kUnsaid
                                        ? fmt::format(", also after {} s", patience / std::chrono::seconds{1})
                                        : ""),
                        listed.empty() ? "no interface is up and has a carrier"
                                       : "the interfaces that are up and have a carrier have " + join(listed, ", "));
        }
        if (!said && waited >= kUnsaid) {
            said = true;
            log::info("waits for an interface with the address {}", join(missing, ", "));
        }
        std::this_thread::sleep_for(kPeriod);
    }
}

} // namespace gridspace::bus
