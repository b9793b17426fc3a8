// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/dataflow.hpp"
#include "launcher/scenario/scenario.hpp"

#include <cstddef>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// Where the processes of a run look for each other on one of its networks, as "address:port" of UDP, by process; those
/// that have to do with each other according to the plan, and no others. Of each pair the one with fewer acquaintances
/// looks for the other, so that nobody announces itself to hundreds. Empty where a process of somebody else exchanges
/// topics: how that is found is not known, so everybody is announced to everybody by multicast.
///
/// With multicast alone each of n participants answers each discovery by announcing itself to all n: n^3 datagrams.
class DiscoveryPeers {
  public:
    DiscoveryPeers(Scenario const& scenario, Dataflow const& flow, std::vector<Port> const& ports);
    /// `management`: the network of the clock, otherwise the studied one, in this DDS domain.
    [[nodiscard]] std::vector<std::string> of(std::string const& process, bool management, std::int64_t domain) const;
    /// How many have to do with it.
    [[nodiscard]] std::size_t acquaintances(std::string const& process) const;

  private:
    struct Place {
        std::string host;
        std::vector<std::string> looks_for; ///< processes
    };
    std::vector<std::string> at(std::string const& host, std::string const& from, bool management,
                                std::int64_t domain) const;
    std::vector<Port> const& ports_;
    std::map<std::string, std::set<std::string>> known_; ///< who has to do with whom
    std::map<std::string, Place> places_;                ///< by process; empty: multicast
    std::map<std::string, int> processes_on_host_;       ///< by host
};

} // namespace gridspace::launcher
