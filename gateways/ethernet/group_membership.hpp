// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "gateways/iec61850/routable.hpp"

#include <string>
#include <vector>

namespace gridspace::ethernet {

/// Membership of an interface in groups of IPv4: the kernel informs routers and switches (IGMP), which then forward
/// what is sent to the groups. It ends with the object.
class GroupMembership {
  public:
    /// Says in the log what the kernel refuses.
    void join(std::string const& interface, iec61850::Ipv4 const& group);

  private:
    std::vector<UniqueFd> sockets_; ///< one for each: the kernel allows few groups on one
};

} // namespace gridspace::ethernet
