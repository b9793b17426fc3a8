// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/graph/graph_model.hpp"

#include "bus/topics.hpp"
#include "monitor/graph/match.hpp"

#include <algorithm>

namespace gridspace::graph {
namespace {

void add_once(std::vector<std::string>& list, std::string const& text) {
    if (std::find(list.begin(), list.end(), text) == list.end()) {
        list.push_back(text);
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

Snapshot GraphModel::snapshot() const {
    Snapshot out;
    out.revision = revision_;
    out.wires = wires_;

    std::map<std::string, Process> processes = expected_;
    std::map<std::string, bool> any_here, any_lost;
    for (auto const& [id, participant] : participants_) {
        std::string const name = process_of(id);
        Process& process = processes[name];
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
    for (auto& [name, process] : processes) {
        if (any_here.contains(name)) {
            process.state = any_lost[name]   ? ProcessState::lost
                            : any_here[name] ? ProcessState::alive
                                             : ProcessState::ended;
        }
        if (process.host.empty()) {
            process.host = process.addresses.empty() ? "" : process.addresses.front();
        }
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
        Topic topic{where.second, where.first, {}, bus::is_management_topic(where.second), 0, 0};
        std::map<std::pair<std::string, bool>, Edge> edges;
        for (Endpoint const& e : endpoints) {
            (e.endpoint.writer ? topic.writers : topic.readers) += 1;
            if (topic.type.empty() || e.endpoint.writer) {
                topic.type = e.endpoint.type;
            }
            Edge& edge = edges[{e.process, e.endpoint.writer}];
            edge.process = e.process;
            edge.topic = where.second;
            edge.network = where.first;
            edge.writes = e.endpoint.writer;
            ++edge.endpoints;
        }
        for (Endpoint const& w : endpoints) {
            bool heard = !w.endpoint.writer;
            std::vector<std::string> unheard;
            for (Endpoint const& r : endpoints) {
                if (!w.endpoint.writer || r.endpoint.writer) {
                    continue;
                }
                Edge &writing = edges[{w.process, true}], &reading = edges[{r.process, false}];
                auto const reasons = mismatch(w.endpoint, r.endpoint);
                if (own_.contains(r.endpoint.participant)) {
                    heard = heard || reasons.empty();
                    for (std::string const& reason : reasons) {
                        add_once(unheard, w.process + ": " + reason);
                    }
                }
                if (!reasons.empty() && processes[r.process].program == "gridspace-monitor") {
                    continue; // an observer is no fault of what it looks at
                }
                if (reasons.empty()) {
                    writing.matched = reading.matched = true;
                }
                for (std::string const& reason : reasons) {
                    add_once(writing.problems, r.process + " does not get it: " + reason);
                    add_once(reading.problems, "gets nothing from " + w.process + ": " + reason);
                }
            }
            for (std::string const& reason : unheard) {
                if (!heard) {
                    add_once(topic.not_heard, reason);
                }
            }
        }
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
