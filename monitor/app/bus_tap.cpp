// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/bus_tap.hpp"

#include "common/log.hpp"

#include <deque>
#include <set>

namespace gridspace::monitor {

/// One domain: what is discovered goes into the graph, and topics that appear wait for a reader.
struct BusTap::Network final : bus::DiscoveryObserver {
    Network(std::string network_name, LiveRun& live_run) : name{std::move(network_name)}, run{live_run} {}

    void participant_found(bus::DiscoveredParticipant const& found) override {
        std::lock_guard const lock{run.mutex};
        run.graph.participant_found(name, found);
        known.insert(found.id);
    }
    void participant_gone(std::string const& id, bool clean) override {
        std::lock_guard const lock{run.mutex};
        run.graph.participant_gone(id, clean);
    }
    void endpoint_found(bus::DiscoveredEndpoint const& endpoint) override {
        std::lock_guard const lock{run.mutex};
        if (known.insert(endpoint.participant).second) { // others are told of before their endpoints: this is us
            bus::DiscoveredParticipant us = self;
            us.id = endpoint.participant;
            run.graph.participant_found(name, us);
        }
        run.graph.endpoint_found(name, endpoint);
        if (endpoint.writer && followed.insert(endpoint.topic).second) {
            waiting.push_back({endpoint.topic, endpoint.type, endpoint.keyed});
        }
    }
    void endpoint_gone(std::string const& id) override {
        std::lock_guard const lock{run.mutex};
        run.graph.endpoint_gone(id);
    }

    struct NewTopic {
        std::string topic, type;
        bool keyed{false};
    };

    std::string const name;
    LiveRun& run;
    bus::DiscoveredParticipant self;
    std::set<std::string> known;        // participants; with the run's mutex
    std::set<std::string> followed;     // with the run's mutex
    std::vector<NewTopic> waiting;      // with the run's mutex
    std::deque<std::string> type_names; // codecs refer to them
    std::unique_ptr<bus::Participant> participant;
    std::vector<std::unique_ptr<bus::RawReader>> readers; // before the participant in death
};

Result<std::unique_ptr<BusTap>> BusTap::join(bus::NodeConfig const& node, LiveRun& run) {
    std::unique_ptr<BusTap> tap{new BusTap};
    auto const join_one = [&](std::string const& name, bus::NetworkConfig const& config) -> Result<void> {
        auto network = std::make_unique<Network>(name, run);
        bus::ParticipantOptions options;
        options.process = node.process;
        options.incarnation = static_cast<std::uint32_t>(node.incarnation);
        options.program = node.program;
        options.domain = static_cast<int>(config.domain);
        options.qos_file = node.qos;
        options.profile = name;
        options.addresses = config.addresses;
        network->self = {"self in " + name,
                         {node.process, static_cast<std::uint32_t>(node.incarnation), node.program},
                         config.addresses};
        network->participant_found(network->self); // nobody discovers himself
        auto participant = bus::Participant::create(std::move(options), network.get());
        if (!participant) {
            return std::unexpected{participant.error()};
        }
        network->participant = std::move(*participant);
        tap->networks_.push_back(std::move(network));
        return {};
    };
    if (auto ok = join_one("management", node.management); !ok) {
        return std::unexpected{ok.error()};
    }
    if (node.data) {
        if (auto ok = join_one("data", *node.data); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return tap;
}

BusTap::~BusTap() {
    for (auto& network : networks_) {
        network->readers.clear();
        network->participant.reset(); // discovery ends before what it tells goes
    }
}

void BusTap::follow() {
    for (auto& network : networks_) {
        std::vector<Network::NewTopic> waiting;
        {
            std::lock_guard const lock{network->run.mutex};
            waiting.swap(network->waiting);
        }
        for (Network::NewTopic const& found : waiting) {
            bus::Codec codec;
            if (bus::Codec const* known = bus::find_codec(found.type); known != nullptr) {
                codec = *known;
            } else {
                codec.type_name = network->type_names.emplace_back(found.type);
                codec.keyed = found.keyed;
            }
            auto* const raw = network.get();
            auto reader = network->participant->create_reader(
                found.topic, codec,
                [raw, topic = found.topic, type = found.type](std::span<std::byte const> cdr,
                                                              bus::SampleHeader const& header) {
                    raw->run.on_sample(raw->name, topic, type, raw->participant->peer(header.peer).process, cdr,
                                       header.source_ns);
                });
            if (reader) {
                network->readers.push_back(std::move(*reader));
            } else {
                log::warning("topic '{}' is not followed: {}", found.topic, describe(reader.error()));
            }
        }
    }
}

} // namespace gridspace::monitor
