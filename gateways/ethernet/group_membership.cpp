// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/group_membership.hpp"

#include "common/log.hpp"
#include "gateways/ethernet/interface.hpp"

#include <cerrno>
#include <cstring>
#include <netinet/in.h>
#include <sys/socket.h>

namespace gridspace::ethernet {

void GroupMembership::join(std::string const& interface, iec61850::Ipv4 const& group) {
    UniqueFd socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    ip_mreqn request{};
    std::memcpy(&request.imr_multiaddr, group.data(), group.size());
    request.imr_ifindex = static_cast<int>(interface_index(interface).value_or(0));
    if (!socket || ::setsockopt(socket.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request) != 0) {
        log::warning("'{}' is no member of the group {}.{}.{}.{}: {}; what a router would forward does not come",
                     interface, group[0], group[1], group[2], group[3], std::strerror(errno));
        return;
    }
    sockets_.push_back(std::move(socket));
}

} // namespace gridspace::ethernet
