// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/discovery_peers.hpp"

#include "launcher/scenario/run_on.hpp"

#include <algorithm>
#include <set>

namespace gridspace::launcher {
namespace {

constexpr std::size_t kFew = 16; ///< so many are looked for from both sides: they meet half a second sooner

/// Recorders and monitors listen to everybody, and everybody to the simulator's clock.
bool concerns_everybody(Scenario const& scenario, Process const& process) {
    return &process == scenario.simulator() || !process.settings->is_member() ||
           process.program.name == "gridspace-recorder";
}

std::map<std::string, std::set<std::string>> acquaintances_in(Scenario const& scenario, Dataflow const& flow) {
    std::map<std::string, std::set<std::string>> known;
    auto const introduce = [&](std::string const& a, std::string const& b) {
        if (a != b) {
            known[a].insert(b);
            known[b].insert(a);
        }
    };
    for (auto const& [topic, writers] : flow.writers) {
        auto const readers = flow.readers.find(topic);
        for (Dataflow::Endpoint const& writer : writers) {
            for (Dataflow::Endpoint const& reader :
                 readers == flow.readers.end() ? std::vector<Dataflow::Endpoint>{} : readers->second) {
                introduce(writer.process, reader.process);
            }
        }
    }
    for (bus::MemberPlan const& member : flow.members) { // acknowledgements
        for (std::string const& up : member.upstream) {
            introduce(member.name, up);
        }
    }
    for (Process const& hub : scenario.processes) {
        for (Process const& other : scenario.processes) {
            if (concerns_everybody(scenario, hub)) {
                introduce(hub.name.name, other.name.name);
            }
        }
    }
    return known;
}

bool finds_others_in_its_own_way(Scenario const& scenario, Process const& process) {
    return is_external(process) || (process.is_foreign() && (!process.settings->writes(scenario, process).empty() ||
                                                             !process.settings->reads(scenario, process).empty()));
}

} // namespace

DiscoveryPeers::DiscoveryPeers(Scenario const& scenario, Dataflow const& flow, std::vector<Port> const& ports)
    : ports_{ports}, known_{acquaintances_in(scenario, flow)} {
    if (std::any_of(scenario.processes.begin(), scenario.processes.end(),
                    [&](Process const& p) { return finds_others_in_its_own_way(scenario, p); })) {
        return;
    }
    for (Process const& process : scenario.processes) {
        ++processes_on_host_[process.host.name];
        Place& place = places_[process.name.name];
        place.host = process.host.name;
        if (auto const it = known_.find(process.name.name); it != known_.end()) {
            std::copy_if(it->second.begin(), it->second.end(), std::back_inserter(place.looks_for),
                         [&](std::string const& other) {
                             return acquaintances(other) >= it->second.size() || it->second.size() <= kFew;
                         });
        }
    }
}

std::size_t DiscoveryPeers::acquaintances(std::string const& process) const {
    auto const it = known_.find(process);
    return it == known_.end() ? 0 : it->second.size();
}

std::vector<std::string> DiscoveryPeers::at(std::string const& host, std::string const& from, bool management,
                                            std::int64_t domain) const {
    std::vector<std::string> out;
    for (Port const& port : ports_) {
        bool const reachable = std::any_of(ports_.begin(), ports_.end(), [&](Port const& own) {
            return own.host == from && own.link == port.link && !own.address.empty();
        });
        if (port.host != host || port.address.empty() || (port.link == kManagementLink) != management || !reachable) {
            continue;
        }
        // The first participant of a process is on the management network, the second on the studied one. What is taken
        // by another process of the host moves on to the next number.
        int const first = management ? 0 : 1;
        for (int i = 0; i < processes_on_host_.at(host); ++i) {
            out.push_back(bus::discovery_address(port.address, domain, first + i));
        }
    }
    return out;
}

std::vector<std::string> DiscoveryPeers::of(std::string const& process, bool management, std::int64_t domain) const {
    auto const place = places_.find(process);
    if (place == places_.end()) {
        return {};
    }
    std::set<std::string> hosts;
    for (std::string const& other : place->second.looks_for) {
        hosts.insert(places_.at(other).host);
    }
    if (hosts.empty()) { // nobody at all would mean everybody, by multicast
        hosts.insert(place->second.host);
    }
    std::vector<std::string> out;
    for (std::string const& host : hosts) {
        std::vector<std::string> const there = at(host, place->second.host, management, domain);
        out.insert(out.end(), there.begin(), there.end());
    }
    return out;
}

} // namespace gridspace::launcher
