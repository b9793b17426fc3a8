// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/graph/graph_model.hpp"

#include "bus/topics.hpp"
#include "monitor/graph/match.hpp"

#include <algorithm>
#include <set>
#include <tuple>
#include <utility>

namespace gridspace::graph {
namespace {

/// Names and texts of one list, and kinds of endpoints of one topic: enough for people, and bounded for those who
/// invent.
constexpr std::size_t kMost = 64;

void add_once(std::vector<std::string>& list, std::string const& text) {
    if (list.size() < kMost && std::find(list.begin(), list.end(), text) == list.end()) {
        list.push_back(text);
    }
}

Topic topic_of(std::string const& network, std::string const& name, std::vector<Endpoint> const& endpoints) {
    Topic topic{name, network, {}, bus::is_management_topic(name), 0, 0};
    for (Endpoint const& e : endpoints) {
        (e.endpoint.writer ? topic.writers : topic.readers) += 1;
        if (topic.type.empty() || e.endpoint.writer) {
            topic.type = e.endpoint.type;
        }
    }
    return topic;
}

/// Of one topic, by process and whether it writes.
using Edges = std::map<std::pair<std::string, bool>, Edge>;

Edges edges_of(Topic const& topic, std::vector<Endpoint> const& endpoints) {
    Edges edges;
    for (Endpoint const& e : endpoints) {
        Edge& edge = edges[{e.process, e.endpoint.writer}];
        edge.process = e.process;
        edge.topic = topic.name;
        edge.network = topic.network;
        edge.writes = e.endpoint.writer;
        ++edge.endpoints;
    }
    return edges;
}

/// Writers or readers of a topic that match, or do not match, for the same reasons.
struct Kind {
    bus::DiscoveredEndpoint like;
    std::set<std::string> processes;
};

/// Of two hundred members that acknowledge to each other there is one; those beyond kMost are not looked at.
std::vector<Kind> kinds_of(std::vector<Endpoint> const& endpoints, bool writers) {
    std::vector<Kind> out;
    for (Endpoint const& e : endpoints) {
        if (e.endpoint.writer != writers) {
            continue;
        }
        auto const same = [&](Kind const& kind) {
            return kind.like.type == e.endpoint.type && kind.like.keyed == e.endpoint.keyed &&
                   kind.like.qos == e.endpoint.qos;
        };
        auto kind = std::find_if(out.begin(), out.end(), same);
        if (kind == out.end() && out.size() < kMost) {
            kind = out.insert(kind, {e.endpoint, {}});
        }
        if (kind != out.end()) {
            kind->processes.insert(e.process);
        }
    }
    return out;
}

/// Which of them have somebody at the other end, and why others have not.
void match(std::vector<Endpoint> const& endpoints, std::map<std::string, Process> const& processes, Edges& edges) {
    auto const is_monitor = [&](std::string const& name) {
        auto const process = processes.find(name);
        return process != processes.end() && process->second.program == "gridspace-monitor";
    };
    std::vector<Kind> const writers = kinds_of(endpoints, true), readers = kinds_of(endpoints, false);
    for (Kind const& w : writers) {
        for (Kind const& r : readers) {
            auto const reasons = mismatch(w.like, r.like);
            auto const note = [&](std::string const& process, bool writes, std::set<std::string> const& others,
                                  std::string const& before, std::string const& after) {
                Edge& edge = edges[{process, writes}];
                edge.matched = edge.matched || reasons.empty();
                for (auto other = others.begin(); other != others.end() && !reasons.empty(); ++other) {
                    if (is_monitor(writes ? *other : process)) {
                        continue; // whoever looks on is no fault of what it looks at
                    }
                    if (edge.problems.size() >= kMost) {
                        break;
                    }
                    for (std::string const& reason : reasons) {
                        add_once(edge.problems, before + *other + after + reason);
                    }
                }
            };
            for (std::string const& process : w.processes) {
                note(process, true, r.processes, "", " does not get it: ");
            }
            for (std::string const& process : r.processes) {
                note(process, false, w.processes, "gets nothing from ", ": ");
            }
        }
    }
}

} // namespace

char const* name_of(ProcessState state) {
    switch (state) {
    case ProcessState::expected:
        return "expected";
    case ProcessState::alive:
        return "alive";
    case ProcessState::ended:
        return "ended";
    case ProcessState::lost:
        return "lost";
    }
    return "unknown";
}

void GraphModel::expect(Process process) {
    expected_[process.name] = std::move(process);
    ++revision_;
}

void GraphModel::wire(WireEdge edge) {
    wires_.push_back(std::move(edge));
    ++revision_;
}

void GraphModel::participant_found(std::string const& network, bus::DiscoveredParticipant const& participant) {
    std::erase_if(participants_, [&](auto const& entry) { // an older incarnation that has gone
        return !entry.second.here && entry.second.network == network &&
               entry.second.info.peer.process == participant.peer.process;
    });
    participants_.insert_or_assign(participant.id, Participant{network, participant, true, false});
    ++revision_;
}

void GraphModel::participant_gone(std::string const& id, bool clean) {
    if (auto const it = participants_.find(id); it != participants_.end()) {
        it->second.here = false;
        it->second.clean = clean;
        std::erase_if(endpoints_, [&](auto const& entry) { return entry.second.endpoint.participant == id; });
        auto const is_gone_stranger = [&](auto const& entry) {
            return !entry.second.here && !expected_.contains(entry.second.info.peer.process);
        };
        if (is_gone_stranger(*it) &&
            static_cast<std::size_t>(std::ranges::count_if(participants_, is_gone_stranger)) > kMaxGone) {
            participants_.erase(it);
        }
        ++revision_;
    }
}

std::vector<std::string> GraphModel::bearers(std::string const& network, bus::Peer const& peer) const {
    std::vector<std::string> out;
    for (auto const& [id, participant] : participants_) {
        bus::Peer const& other = participant.info.peer;
        if (participant.here && participant.network == network && other.process == peer.process &&
            other.incarnation == peer.incarnation) {
            out.push_back(participant.info.addresses.empty() ? "nowhere" : participant.info.addresses.front());
        }
    }
    return out;
}

void GraphModel::process_died(std::string const& process) {
    std::vector<std::string> ids;
    for (auto const& [id, participant] : participants_) {
        if (participant.info.peer.process == process && participant.here) {
            ids.push_back(id);
        }
    }
    for (std::string const& id : ids) {
        participant_gone(id, false);
    }
}

bool GraphModel::endpoint_found(std::string const& network, bus::DiscoveredEndpoint const& endpoint) {
    if (endpoints_.size() >= kMaxEndpoints && !endpoints_.contains(endpoint.id)) {
        return false;
    }
    endpoints_[endpoint.id] = {endpoint, network, {}};
    ++revision_;
    return true;
}

void GraphModel::endpoint_gone(std::string const& id) {
    if (endpoints_.erase(id) > 0) {
        ++revision_;
    }
}

bool GraphModel::has_writer(std::string const& network, std::string const& topic, std::string const& type) const {
    return std::ranges::any_of(endpoints_, [&](auto const& entry) {
        auto const& [endpoint, where, process] = entry.second;
        return endpoint.writer && where == network && endpoint.topic == topic && endpoint.type == type;
    });
}

std::vector<bus::DiscoveredEndpoint> GraphModel::writers_of(std::string const& network,
                                                            std::string const& topic) const {
    std::vector<bus::DiscoveredEndpoint> out;
    for (auto const& [id, known] : endpoints_) {
        if (known.endpoint.writer && known.network == network && known.endpoint.topic == topic) {
            out.push_back(known.endpoint);
        }
    }
    return out;
}

void GraphModel::look_through(std::string const& participant) {
    own_.insert(participant);
    ++revision_;
}

std::string GraphModel::process_of(std::string const& participant) const {
    auto const it = participants_.find(participant);
    if (it == participants_.end()) {
        return "unknown " + participant.substr(0, 12);
    }
    std::string const& name = it->second.info.peer.process;
    return name.empty() ? "unnamed " + participant.substr(0, 12) : name;
}

std::map<std::string, Process> GraphModel::processes() const {
    std::map<std::string, Process> out = expected_;
    std::map<std::string, bool> any_here, any_lost;
    for (auto const& [id, participant] : participants_) {
        std::string const name = process_of(id);
        Process& process = out[name];
        process.name = name;
        if (!participant.info.peer.program.empty()) {
            process.program = participant.info.peer.program;
        }
        process.incarnation = std::max(process.incarnation, participant.info.peer.incarnation);
        for (std::string const& address : participant.info.addresses) {
            add_once(process.addresses, address);
        }
        add_once(process.networks, participant.network);
        any_here[name] = any_here[name] || participant.here;
        any_lost[name] = any_lost[name] || (!participant.here && !participant.clean);
    }
    for (auto& [name, process] : out) {
        if (any_here.contains(name)) {
            process.state = any_lost[name]   ? ProcessState::lost
                            : any_here[name] ? ProcessState::alive
                                             : ProcessState::ended;
        }
        if (process.host.empty()) {
            process.host = process.addresses.empty() ? "" : process.addresses.front();
        }
    }
    return out;
}

void GraphModel::tell_not_heard(Topic& topic, std::vector<Endpoint> const& endpoints) const {
    for (Endpoint const& w : endpoints) {
        if (!w.endpoint.writer) {
            continue;
        }
        bool heard = false;
        std::vector<std::string> unheard;
        for (Endpoint const& r : endpoints) {
            if (r.endpoint.writer || !own_.contains(r.endpoint.participant)) {
                continue;
            }
            auto const reasons = mismatch(w.endpoint, r.endpoint);
            heard = heard || reasons.empty();
            for (std::string const& reason : reasons) {
                add_once(unheard, w.process + ": " + reason);
            }
        }
        for (std::string const& reason : unheard) {
            if (!heard) {
                add_once(topic.not_heard, reason);
            }
        }
    }
}

Snapshot GraphModel::snapshot() const {
    Snapshot out;
    out.revision = revision_;
    out.wires = wires_;
    std::map<std::string, Process> const all = processes();
    for (auto const& [name, process] : all) {
        out.processes.push_back(process);
    }
    std::map<std::pair<std::string, std::string>, std::vector<Endpoint>> by_topic; // (network, topic)
    for (auto const& [id, entry] : endpoints_) {
        Endpoint endpoint = entry;
        endpoint.process = process_of(entry.endpoint.participant);
        by_topic[{entry.network, entry.endpoint.topic}].push_back(endpoint);
        out.endpoints.push_back(std::move(endpoint));
    }
    std::sort(out.endpoints.begin(), out.endpoints.end(), [](Endpoint const& a, Endpoint const& b) {
        return std::tie(a.endpoint.topic, a.process, a.endpoint.writer, a.endpoint.id) <
               std::tie(b.endpoint.topic, b.process, b.endpoint.writer, b.endpoint.id);
    });
    for (auto const& [where, endpoints] : by_topic) {
        Topic topic = topic_of(where.first, where.second, endpoints);
        tell_not_heard(topic, endpoints);
        Edges edges = edges_of(topic, endpoints);
        match(endpoints, all, edges);
        out.topics.push_back(std::move(topic));
        for (auto& [key, edge] : edges) {
            out.edges.push_back(std::move(edge));
        }
    }
    std::sort(out.topics.begin(), out.topics.end(),
              [](Topic const& a, Topic const& b) { return std::tie(a.name, a.network) < std::tie(b.name, b.network); });
    return out;
}

} // namespace gridspace::graph
