// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"
#include "monitor/web/server.hpp"

#include <cstdint>
#include <map>
#include <mutex>
#include <optional>
#include <string>
#include <utility>
#include <vector>

namespace gridspace::monitor {

/// Speaks the Foxglove WebSocket protocol (subprotocol foxglove.websocket.v1), so that Foxglove and PlotJuggler show a
/// run live: every topic is a channel of CDR samples with the IDL of its type, stamped with simulated time. A client
/// that asks for more than the newest samples of a topic is too late for them; what it misses is missing there only.
class FoxgloveHub {
  public:
    explicit FoxgloveHub(LiveRun const& run) : run_{run} {}

    /// The one of the offered subprotocols that is spoken here.
    [[nodiscard]] static std::optional<std::string> choose(std::vector<std::string> const& offered);

    // From the server's thread.
    void opened(web::ClientId client);
    void closed(web::ClientId client);
    void message(web::ClientId client, std::string const& text);

    /// From the process's own thread, about every 50 ms.
    void step(web::Server& server);

  private:
    using Topic = std::pair<std::string, std::string>; ///< network and name
    struct Subscription {
        std::uint32_t channel{0};
        std::uint64_t sent{0}; ///< number of the newest sample that was sent
        bool fresh{true};
    };
    struct Client {
        bool greeted{false};
        std::size_t advertised{0};
        std::map<std::uint32_t, Subscription> subscriptions; ///< by the client's own number
        bool graph{false};                                   ///< wants to know who writes and reads
        std::uint64_t graph_revision{0};
        std::vector<std::string> advertised_topics;
        std::vector<std::string> problems; ///< to be told
        std::size_t reported_without_idl{0};
    };
    void find_channels();
    /// What the client has to know before samples: who speaks, channels, problems.
    void tell(web::Server& server, web::ClientId id, Client& client);
    void send_samples(web::Server& server, web::ClientId id, Client& client);
    [[nodiscard]] std::int64_t present_ns() const;
    [[nodiscard]] std::string advertisement(std::size_t from) const;
    [[nodiscard]] std::string connection_graph(Client& client) const;

    LiveRun const& run_;
    std::mutex mutex_;
    std::map<web::ClientId, Client> clients_;
    std::vector<Topic> channels_;         ///< the number of a channel is its place, from 1
    std::vector<std::string> advertised_; ///< its JSON
    std::map<Topic, int> steps_without_idl_;
    std::vector<std::string> without_idl_; ///< what is said of topics that cannot be channels yet
    std::int64_t time_sent_ns_{-1};
};

} // namespace gridspace::monitor
