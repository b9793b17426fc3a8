// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/scenario.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// An IPv4 network, "10.10.0.0/24".
struct Subnet {
    std::uint32_t base{0};
    int prefix{24};
    [[nodiscard]] std::uint32_t hosts() const {
        return prefix >= 31 ? 0 : prefix == 0 ? ~0U - 1 : (1U << (32 - prefix)) - 2;
    }
    [[nodiscard]] bool overlaps(Subnet const& other) const;
    [[nodiscard]] std::string host(std::uint32_t number) const; ///< "10.10.0.1" for 1
};
[[nodiscard]] std::optional<Subnet> parse_subnet(std::string_view text);

/// A host's port on a link. Everything is fixed by the order in the scenario, so that frames repeat from run to run.
struct Port {
    std::string host, link;
    std::string interface; ///< inside the host
    std::string mac;
    std::string address; ///< IPv4; empty on a link without IP
    int prefix{0};
    std::string plug{}; ///< a real interface of this machine in the place of the cable to the host
};

/// The management network: clock, acknowledgements, recording and health; not part of the scenario.
inline constexpr std::string_view kManagementLink = "mgmt0";
[[nodiscard]] Subnet management_subnet();

/// The switch's end of the cable of the n-th port, in the namespace of the switches.
[[nodiscard]] inline std::string switch_port_name(std::size_t n) {
    return "p" + std::to_string(n);
}

/// The ports of all hosts, the management network first.
[[nodiscard]] std::vector<Port> plan_ports(Scenario const& scenario);

void check_addresses(Scenario const& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
