// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// https://github.com/foxglove/ws-protocol/blob/main/docs/spec.md
#include "monitor/app/foxglove.hpp"

#include "bus/topics.hpp"
#include "monitor/app/json_text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::monitor {
namespace {

using Json = nlohmann::ordered_json;

constexpr std::array<std::string_view, 2> kProtocols{"foxglove.websocket.v1", "foxglove.sdk.v1"};
constexpr std::size_t kMaxSubscriptions = 512;
constexpr std::uint8_t kMessageData = 1, kTime = 2; // binary messages of a server

template <class T>
void append(std::string& out, T number) {
    static_assert(std::endian::native == std::endian::little, "the protocol is little-endian");
    char octets[sizeof number];
    std::memcpy(octets, &number, sizeof number);
    out.append(octets, sizeof number);
}

std::optional<std::uint32_t> small_number(Json const& json, char const* key) {
    auto const it = json.find(key);
    if (it == json.end() || !it->is_number_unsigned() || it->get<std::uint64_t>() > UINT32_MAX) {
        return std::nullopt;
    }
    return it->get<std::uint32_t>();
}

/// These the framework writes at the wall clock, also in lockstep.
bool at_wall_clock(std::string_view topic) {
    return topic == "member_status" || topic == "type_catalog";
}

constexpr int kStepsForIdl = 20; ///< about a second

} // namespace

std::optional<std::string> FoxgloveHub::choose(std::vector<std::string> const& offered) {
    for (std::string_view const ours : kProtocols) {
        if (std::find(offered.begin(), offered.end(), ours) != offered.end()) {
            return std::string{ours};
        }
    }
    return std::nullopt;
}

void FoxgloveHub::opened(web::ClientId client) {
    std::lock_guard const lock{mutex_};
    clients_.try_emplace(client);
}

void FoxgloveHub::closed(web::ClientId client) {
    std::lock_guard const lock{mutex_};
    clients_.erase(client);
}

void FoxgloveHub::message(web::ClientId id, std::string const& content) {
    Json const json = Json::parse(content, nullptr, false);
    std::lock_guard const lock{mutex_};
    auto const it = clients_.find(id);
    if (it == clients_.end()) {
        return;
    }
    Client& client = it->second;
    std::string const op =
        json.is_object() && json.contains("op") && json["op"].is_string() ? json["op"].get<std::string>() : "";
    if (op == "subscribe" && json.contains("subscriptions") && json["subscriptions"].is_array()) {
        for (Json const& asked : json["subscriptions"]) {
            auto const number = asked.is_object() ? small_number(asked, "id") : std::nullopt;
            auto const channel = asked.is_object() ? small_number(asked, "channelId") : std::nullopt;
            if (!number || !channel || *channel == 0 || *channel > channels_.size()) {
                client.problems.push_back(
                    "a subscription needs an id and the channelId of a channel that was advertised");
            } else if (client.subscriptions.contains(*number) || client.subscriptions.size() >= kMaxSubscriptions) {
                client.problems.push_back(fmt::format("subscription {} is there already, or one too many", *number));
            } else {
                client.subscriptions[*number] = {*channel, 0, true};
            }
        }
    } else if (op == "unsubscribe" && json.contains("subscriptionIds") && json["subscriptionIds"].is_array()) {
        for (Json const& number : json["subscriptionIds"]) {
            if (number.is_number_unsigned() && number.get<std::uint64_t>() <= UINT32_MAX) {
                client.subscriptions.erase(number.get<std::uint32_t>());
            }
        }
    } else if (op == "subscribeConnectionGraph" || op == "unsubscribeConnectionGraph") {
        client.graph = op == "subscribeConnectionGraph";
        client.graph_revision = 0;
        client.advertised_topics.clear();
    } else {
        client.problems.push_back("only subscriptions are understood: nothing can be changed here");
    }
    if (client.problems.size() > 16) {
        client.problems.resize(16);
    }
}

/// Topics become channels when their type is known; run's mutex held.
void FoxgloveHub::find_channels() {
    for (auto const& [key, state] : run_.topics) {
        if (std::find(channels_.begin(), channels_.end(), key) != channels_.end()) {
            continue;
        }
        auto const found = run_.idl.find(state.type);
        std::string const idl = found != run_.idl.end() ? found->second : std::string{bus::idl_of_type(state.type)};
        if (idl.empty()) { // it may still come
            if (++steps_without_idl_[key] == kStepsForIdl) {
                without_idl_.push_back(fmt::format("topic '{}' is left out until somebody publishes the IDL of its "
                                                   "type {}, or the monitor is given it (--idl)",
                                                   key.second, state.type));
            }
            continue;
        }
        channels_.push_back(key);
        advertised_.push_back(json_text({{"id", channels_.size()},
                                         {"topic", key.second},
                                         {"encoding", "cdr"},
                                         {"schemaName", state.type},
                                         {"schema", idl},
                                         {"schemaEncoding", "omgidl"}}));
    }
}

/// What the samples are stamped with that are stamped with the run's time: the newest of them; run's mutex held.
std::int64_t FoxgloveHub::present_ns() const {
    std::int64_t newest = -1;
    for (auto const& [key, state] : run_.topics) {
        if (!at_wall_clock(key.second) && !state.newest.empty()) {
            newest = std::max(newest, state.newest.back().source_ns);
        }
    }
    return newest >= 0 ? newest : static_cast<std::int64_t>(run_.clock.time_s * 1e9);
}

std::string FoxgloveHub::advertisement(std::size_t from) const {
    std::string list;
    for (std::size_t i = from; i < advertised_.size(); ++i) {
        list += (list.empty() ? "" : ",") + advertised_[i];
    }
    return fmt::format(R"({{"op":"advertise","channels":[{}]}})", list);
}

std::string FoxgloveHub::connection_graph(Client& client) const {
    graph::Snapshot const& graph = run_.snapshot();
    Json published = Json::array(), subscribed = Json::array(), removed = Json::array();
    std::vector<std::string> names;
    for (graph::Topic const& topic : graph.topics) {
        Json writers = Json::array(), readers = Json::array();
        for (graph::Edge const& edge : graph.edges) {
            if (edge.topic == topic.name && edge.network == topic.network) {
                (edge.writes ? writers : readers).push_back(edge.process);
            }
        }
        published.push_back({{"name", topic.name}, {"publisherIds", std::move(writers)}});
        subscribed.push_back({{"name", topic.name}, {"subscriberIds", std::move(readers)}});
        names.push_back(topic.name);
    }
    for (std::string const& told : client.advertised_topics) {
        if (std::find(names.begin(), names.end(), told) == names.end()) {
            removed.push_back(told);
        }
    }
    client.advertised_topics = std::move(names);
    client.graph_revision = graph.revision;
    return json_text({{"op", "connectionGraphUpdate"},
                      {"publishedTopics", std::move(published)},
                      {"subscribedTopics", std::move(subscribed)},
                      {"advertisedServices", Json::array()},
                      {"removedTopics", std::move(removed)},
                      {"removedServices", Json::array()}});
}

void FoxgloveHub::tell(web::Server& server, web::ClientId id, Client& client) {
    auto const say = [&](Json const& json) { server.push(id, {.octets = share(json_text(json)), .lasting = true}); };
    if (!std::exchange(client.greeted, true)) {
        say({{"op", "serverInfo"},
             {"name", "Gridspace: " + run_.plan.scenario},
             {"capabilities", {"time", "connectionGraph"}},
             {"supportedEncodings", Json::array()},
             {"metadata", Json::object()},
             {"sessionId", std::to_string(run_.started.time_since_epoch().count())}});
    }
    if (client.advertised < advertised_.size()) {
        server.push(id, {.octets = share(advertisement(client.advertised)), .lasting = true});
        client.advertised = advertised_.size();
    }
    for (std::string const& problem : std::exchange(client.problems, {})) {
        say({{"op", "status"}, {"level", 1}, {"message", problem}});
    }
    for (; client.reported_without_idl < without_idl_.size(); ++client.reported_without_idl) {
        say({{"op", "status"}, {"level", 1}, {"message", without_idl_[client.reported_without_idl]}});
    }
}

void FoxgloveHub::send_samples(web::Server& server, web::ClientId id, Client& client) {
    for (auto& [number, subscription] : client.subscriptions) {
        Topic const& key = channels_[subscription.channel - 1];
        TopicState const& topic = run_.topics.at(key);
        std::optional<std::int64_t> const stamp_ns =
            at_wall_clock(key.second) ? std::optional{present_ns()} : std::nullopt;
        for (RawSample const& sample : topic.newest) {
            // At first the newest: of a topic that is written once nothing else would ever come.
            bool const wanted =
                subscription.fresh ? &sample == &topic.newest.back() : sample.number > subscription.sent;
            if (wanted) {
                std::string bytes(1, static_cast<char>(kMessageData));
                append(bytes, number);
                append(bytes, static_cast<std::uint64_t>(stamp_ns ? *stamp_ns : sample.source_ns));
                bytes.append(reinterpret_cast<char const*>(sample.cdr.data()), sample.cdr.size());
                server.push(id, {.octets = share(std::move(bytes)), .binary = true});
                subscription.sent = sample.number;
            }
        }
        subscription.fresh = subscription.fresh && topic.newest.empty();
    }
}

void FoxgloveHub::step(web::Server& server) {
    std::lock_guard const lock{mutex_};
    if (clients_.empty()) {
        return;
    }
    std::lock_guard const run_lock{run_.mutex};
    find_channels();
    auto const time_ns = static_cast<std::int64_t>(run_.clock.time_s * 1e9);
    std::shared_ptr<std::string const> time;
    if (time_ns != time_sent_ns_) {
        time_sent_ns_ = time_ns;
        std::string bytes(1, static_cast<char>(kTime));
        append(bytes, static_cast<std::uint64_t>(time_ns));
        time = share(std::move(bytes));
    }
    for (auto& [number_of_client, client] : clients_) {
        web::ClientId const id = number_of_client;
        tell(server, id, client);
        if (time != nullptr) {
            server.push(id, {.octets = time, .binary = true});
        }
        if (client.graph && client.graph_revision != run_.snapshot().revision) {
            server.push(id, {.octets = share(connection_graph(client)), .lasting = true});
        }
        send_samples(server, id, client);
    }
}

} // namespace gridspace::monitor
