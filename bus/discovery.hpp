// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/participant.hpp"

#include <string>
#include <vector>

namespace gridspace::bus {

/// A participant of a domain, ours or somebody's, as it announces itself.
struct DiscoveredParticipant {
    std::string id; ///< its GUID prefix, hexadecimal
    Peer peer;
    std::vector<std::string> addresses; ///< IPv4 at which it takes samples
};

enum class Durability { volatile_, transient_local, transient, persistent };
enum class Liveliness { automatic, manual_by_participant, manual_by_topic };
enum class PresentationScope { instance, topic, group };
enum class Representation { xcdr1, xml, xcdr2 };

/// The part of an endpoint's QoS that decides a match. Durations in seconds; infinite when negative.
struct EndpointQos {
    bool reliable{false};
    Durability durability{Durability::volatile_};
    double deadline_s{-1};
    Liveliness liveliness{Liveliness::automatic};
    double lease_s{-1};
    bool exclusive{false}; ///< ownership
    std::vector<std::string> partitions;
    PresentationScope scope{PresentationScope::instance};
    bool coherent{false};            ///< presentation: changes are sent, or wanted, as units
    bool ordered{false};             ///< presentation: in the order of all changes of the scope
    bool by_source_timestamp{false}; ///< destination order
    std::vector<Representation> representations{Representation::xcdr1}; ///< a writer uses the first; never empty
    double latency_budget_s{0};

    friend bool operator==(EndpointQos const&, EndpointQos const&) = default;
};

/// A reader or writer of somebody else's.
struct DiscoveredEndpoint {
    std::string id;          ///< its GUID, hexadecimal
    std::string participant; ///< id of its participant
    std::string topic;
    std::string type;
    bool writer{false};
    bool keyed{false};
    EndpointQos qos;
};

/// Called for what appears in a domain and what leaves it, on threads of DDS: must not block, and must not make readers
/// or writers.
class DiscoveryObserver {
  public:
    virtual ~DiscoveryObserver() = default;
    virtual void participant_found(DiscoveredParticipant const& participant) = 0;
    virtual void participant_gone(std::string const& id, bool clean) = 0; ///< `clean`: it said goodbye
    virtual void endpoint_found(DiscoveredEndpoint const& endpoint) = 0;
    virtual void endpoint_gone(std::string const& id) = 0;
};

} // namespace gridspace::bus
