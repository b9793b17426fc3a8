// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/bus_tap.hpp"

#include "bus/raw_access.hpp"
#include "bus/sample_stamp.hpp"
#include "common/log.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <ctime>
#include <deque>
#include <fmt/format.h>
#include <map>
#include <set>
#include <string_view>
#include <utility>

namespace gridspace::monitor {
namespace {

/// Topics of the framework whose readers are as qos/monitor.xml says.
constexpr std::array<std::string_view, 5> kProfiles{"simulation_clock", "member_status", "type_catalog",
                                                    "signal_catalog", "signals"};

constexpr std::size_t kMaxTopics = 1024; ///< each takes a reader, and up to 256 kB of newest samples

/// What the reader of a topic asks for. One that asks for more than a writer offers gets nothing from it: the weakest
/// of the topic's writers decides, or what all of them have in common.
struct Wanted {
    bool reliable{true}, kept{true}, exclusive{true};
    bool partitioned{false}; ///< any is in a partition: all of them are read

    [[nodiscard]] Wanted with(bus::EndpointQos const& writer) const {
        bool const named = std::any_of(writer.partitions.begin(), writer.partitions.end(),
                                       [](std::string const& partition) { return !partition.empty(); });
        return {reliable && writer.reliable, kept && writer.durability >= bus::Durability::transient_local,
                exclusive && writer.exclusive, partitioned || named};
    }
    [[nodiscard]] bus::EndpointQos qos() const {
        bus::EndpointQos out;
        out.reliable = reliable;
        out.durability = kept ? bus::Durability::transient_local : bus::Durability::volatile_;
        out.exclusive = exclusive;
        if (partitioned) {
            out.partitions = {"", "*"};
        }
        return out;
    }
    bool operator==(Wanted const&) const = default;
};

} // namespace

/// One domain: what is discovered goes into the graph, and topics that appear wait for a reader.
struct BusTap::Network final : bus::DiscoveryObserver {
    Network(std::string network_name, LiveRun& live_run, std::int64_t instant_ns)
        : name{std::move(network_name)}, run{live_run}, about_ns{instant_ns} {}

    void participant_found(bus::DiscoveredParticipant const& found) override {
        std::lock_guard const lock{run.mutex};
        run.graph.participant_found(name, found);
        known.insert(found.id);
        auto const bearers = run.graph.bearers(name, found.peer);
        if (bearers.size() > 1 && !found.peer.process.empty() && found.peer.process != self.peer.process) {
            run.tell_once("same_name",
                          fmt::format("{} participants on '{}' call themselves '{}' ({}): only one of them "
                                      "is that process; one may be its last life, whose lease runs out",
                                      bearers.size(), name, found.peer.process, gridspace::join(bearers, ", ")));
        }
    }
    void participant_gone(std::string const& id, bool clean) override {
        std::lock_guard const lock{run.mutex};
        run.graph.participant_gone(id, clean);
        known.erase(id);
        look_at_contested();
    }
    void endpoint_found(bus::DiscoveredEndpoint const& endpoint) override {
        std::lock_guard const lock{run.mutex};
        if (known.insert(endpoint.participant).second) { // others are reported before their endpoints: this is us
            bus::DiscoveredParticipant us = self;
            us.id = endpoint.participant;
            run.graph.participant_found(name, us);
            run.graph.look_through(us.id);
        }
        if (!run.graph.endpoint_found(name, endpoint)) {
            run.full("readers and writers", graph::GraphModel::kMaxEndpoints);
        }
        if (endpoint.writer) {
            follow(endpoint);
        }
    }
    void endpoint_gone(std::string const& id) override {
        std::lock_guard const lock{run.mutex};
        run.graph.endpoint_gone(id);
        look_at_contested();
    }

    /// With the run's mutex.
    void follow(bus::DiscoveredEndpoint const& endpoint) {
        if (followed.size() >= kMaxTopics && !followed.contains(endpoint.topic)) {
            run.full("topics of a network", kMaxTopics);
            return;
        }
        auto [it, first] = followed.try_emplace(endpoint.topic, Followed{endpoint.type, {}});
        if (it->second.type != endpoint.type) {
            if (run.graph.has_writer(name, endpoint.topic, it->second.type)) {
                contested.insert(endpoint.topic);
                return; // a topic is read with the type of who came first and is still here
            }
            it->second = {endpoint.type, {}};
            first = true;
        }
        Wanted const before = std::exchange(it->second.wanted, it->second.wanted.with(endpoint.qos));
        bool const own = std::find(kProfiles.begin(), kProfiles.end(), endpoint.topic) != kProfiles.end();
        if (first || (before != it->second.wanted && !own)) {
            waiting.push_back({endpoint.topic, endpoint.type, endpoint.keyed, own, it->second.wanted});
        }
    }

    /// Topics that somebody also writes with another type: when the first writers have left, it is the others' turn.
    /// With the run's mutex.
    void look_at_contested() {
        for (std::string const& topic : std::exchange(contested, {})) {
            if (run.graph.has_writer(name, topic, followed.at(topic).type)) {
                contested.insert(topic);
                continue;
            }
            for (bus::DiscoveredEndpoint const& writer : run.graph.writers_of(name, topic)) {
                follow(writer);
            }
        }
    }

    /// Of a sample, in nanoseconds since 1970: the nearest to the run's beginning, or to now, that has this stamp.
    [[nodiscard]] std::int64_t time_of(std::int64_t stamp_ns) const {
        return about_ns + bus::stamp_after(stamp_ns, about_ns);
    }

    struct NewTopic {
        std::string topic, type;
        bool keyed{false};
        bool own{false}; ///< has a profile of its own
        Wanted wanted;   ///< of its reader, otherwise
    };

    struct Followed {
        std::string type;
        Wanted wanted;
    };

    std::string const name;
    LiveRun& run;
    std::int64_t const about_ns; ///< an instant of the run, since 1970
    bus::DiscoveredParticipant self;
    std::set<std::string> known;              // participants; with the run's mutex
    std::map<std::string, Followed> followed; // by topic; with the run's mutex
    std::set<std::string> contested;          // topics of `followed` with writers of several types; with it, too
    std::vector<NewTopic> waiting;            // with the run's mutex
    std::deque<std::string> type_names;       // codecs refer to them
    std::unique_ptr<bus::Participant> participant;
    std::map<std::string, std::unique_ptr<bus::RawReader>> readers; // by topic; before the participant in death
};

Result<std::unique_ptr<BusTap>> BusTap::join(bus::NodeConfig const& node, LiveRun& run) {
    std::unique_ptr<BusTap> tap{new BusTap};
    std::int64_t const epoch_s = node.clock.epoch_unix_s > 0 ? node.clock.epoch_unix_s : std::time(nullptr);
    auto const join_one = [&](std::string const& name, bus::NetworkConfig const& config) -> Result<void> {
        auto network = std::make_unique<Network>(name, run, epoch_s * 1'000'000'000);
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
        network->participant.reset(); // discovery ends before its listener is deleted
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
            bus::SampleHandler handler = [raw, topic = found.topic, type = found.type](
                                             std::span<std::byte const> cdr, bus::SampleHeader const& header) {
                raw->run.on_sample(raw->name, topic, type, raw->participant->peer(header.peer).process, cdr,
                                   raw->time_of(header.source_ns));
            };
            network->readers.erase(found.topic); // one that asked for more than a writer gives
            auto reader = found.own ? network->participant->create_reader(found.topic, codec, std::move(handler))
                                    : bus::create_reader_like(*network->participant, found.topic, codec,
                                                              found.wanted.qos(), std::move(handler));
            if (reader) {
                network->readers[found.topic] = std::move(*reader);
            } else {
                log::warning("topic '{}' is not followed: {}", found.topic, describe(reader.error()));
            }
        }
    }
}

} // namespace gridspace::monitor
