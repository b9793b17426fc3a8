// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/discovery.hpp"

#include <cstdint>
#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::graph {

enum class ProcessState {
    expected, ///< the scenario names it; it has not been seen yet
    alive,
    ended, ///< it said goodbye
    lost,  ///< its lease ran out: it was killed, or its network is gone
};
[[nodiscard]] char const* name_of(ProcessState state);

/// A process as the graph shows it: what the scenario says and what its participants say.
struct Process {
    std::string name, program, host;
    ProcessState state{ProcessState::expected};
    std::uint32_t incarnation{0};
    std::vector<std::string> addresses;
    std::vector<std::string> networks; ///< domains in which it is seen
};

struct Topic {
    std::string name, network, type;
    bool framework{false}; ///< clock, acknowledgements, catalogues: hidden at first
    std::size_t writers{0}, readers{0};
    std::vector<std::string> not_heard{}; ///< writers from which the observer gets nothing, and why
};

/// A process writes or reads a topic.
struct Edge {
    std::string process, topic, network;
    bool writes{false};
    std::size_t endpoints{0};
    bool matched{false};               ///< somebody is at the other end
    std::vector<std::string> problems; ///< why somebody is not
};

/// A process publishes or subscribes a stream of raw frames.
struct WireEdge {
    std::string process, stream, kind, link;
    bool publishes{false};
};

struct Endpoint {
    bus::DiscoveredEndpoint endpoint;
    std::string network, process;
};

/// Everything at one moment, sorted by name: equal graphs are equal texts.
struct Snapshot {
    std::uint64_t revision{0};
    std::vector<Process> processes;
    std::vector<Topic> topics;
    std::vector<Edge> edges;
    std::vector<WireEdge> wires;
    std::vector<Endpoint> endpoints;
};

/// Who is in the domains, kept up to date by discovery. Pure: no DDS, no lock.
class GraphModel {
  public:
    static constexpr std::size_t kMaxEndpoints = 8192; ///< who comes first stays
    static constexpr std::size_t kMaxGone = 256;       ///< participants that have left, and are no process of the run
    void expect(Process process);
    void wire(WireEdge edge);

    void participant_found(std::string const& network, bus::DiscoveredParticipant const& participant);
    void participant_gone(std::string const& id, bool clean);
    /// The addresses of those on a network that are this process in this incarnation, or say so: one entry for each.
    [[nodiscard]] std::vector<std::string> bearers(std::string const& network, bus::Peer const& peer) const;
    /// Somebody who watches processes has seen it die: its lease runs out only seconds later.
    void process_died(std::string const& process);
    /// False: there is no room for it.
    bool endpoint_found(std::string const& network, bus::DiscoveredEndpoint const& endpoint);
    void endpoint_gone(std::string const& id);
    [[nodiscard]] bool has_writer(std::string const& network, std::string const& topic, std::string const& type) const;
    [[nodiscard]] std::vector<bus::DiscoveredEndpoint> writers_of(std::string const& network,
                                                                  std::string const& topic) const;
    /// The participant of the observer: what its readers do not get is a note of the topic.
    void look_through(std::string const& participant);

    [[nodiscard]] std::uint64_t revision() const { return revision_; } ///< grows with every change
    [[nodiscard]] Snapshot snapshot() const;

  private:
    struct Participant {
        std::string network;
        bus::DiscoveredParticipant info;
        bool here{true}, clean{false};
    };
    [[nodiscard]] std::string process_of(std::string const& participant) const;
    /// Those of the scenario and those that have been seen, by name.
    [[nodiscard]] std::map<std::string, Process> processes() const;
    /// What the readers of whoever looks on do not get.
    void tell_not_heard(Topic& topic, std::vector<Endpoint> const& endpoints) const;

    std::map<std::string, Process> expected_;
    std::vector<WireEdge> wires_;
    std::map<std::string, Participant>
        participants_;                          ///< by id; the last ones of a process are kept when they have gone
    std::map<std::string, Endpoint> endpoints_; ///< by id
    std::set<std::string> own_;                 ///< participants of the observer
    std::uint64_t revision_{1};
};

} // namespace gridspace::graph
