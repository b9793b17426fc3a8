// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/api.hpp"
#include "monitor/app/live_run.hpp"
#include "monitor/web/server.hpp"

#include <chrono>
#include <cstdint>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::monitor {

/// Sends WebSocket clients what changes (docs/reference/rest_api.md, "Push"): the graph when it changes, the clock and
/// newest values five times a second, and for each of a client's views the signals as they are to be drawn.
class PushHub {
  public:
    PushHub(LiveRun const& run, Api const& api) : run_{run}, api_{api} {}

    // From the server's thread.
    void opened(web::ClientId client);
    void closed(web::ClientId client);
    void message(web::ClientId client, std::string const& text);

    /// From the process's own thread, about every 50 ms. A view is drawn only for a client that has taken nearly all
    /// that it was sent, and only so many at once: those that are left are the first of the next step. True when
    /// nothing is left that a client could take.
    bool step(web::Server& server, std::chrono::steady_clock::time_point now);

  private:
    /// What a client wants drawn. Without a fixed begin it follows the newest sample.
    struct View {
        std::string id;
        std::vector<std::string> names;
        double from_s{0}, to_s{0}, window_s{0}; ///< window 0: from_s to to_s; negative: everything
        std::size_t pixels{800};
        bool asked{true}; ///< it has not been answered yet
        std::int64_t newest_sent_ns{INT64_MIN};
        std::chrono::steady_clock::time_point drawn; ///< looked at, and sent when something had changed
    };
    /// What a client has said since the last step: all that the server's thread touches.
    struct Inbox {
        std::map<std::string, View> views; ///< by id; without names: no longer wanted
        std::optional<double> seek;        ///< NaN: the end
    };
    struct Client {
        bool fresh{true};
        bool moved{false};          ///< it has not been told what held there
        std::optional<double> at_s; ///< the instant that the client looks at, of a recorded run
        std::uint64_t graph_revision{0}, events_sent{0}, dropped_reported{0};
        std::size_t signals_sent{0};
        std::map<std::string, View> views;
        std::string drawn_last; ///< id of a view; the next one is the next to be drawn
    };
    void collect();
    static void seek(Client& client, double at_s);
    void tell(web::Server& server, bool topics_due);
    bool draw(web::Server& server, std::chrono::steady_clock::time_point now);
    /// The newest values, or those that held at an instant.
    [[nodiscard]] std::string values(std::optional<double> at_s, std::size_t& count) const;
    /// Empty when nothing has changed since the view was last sent.
    [[nodiscard]] std::string series(View& view, std::optional<double> at_s) const;

    LiveRun const& run_;
    Api const& api_;
    std::mutex mutex_; // guards the next one, briefly: the server's thread waits for it
    std::map<web::ClientId, Inbox> inboxes_;
    std::map<web::ClientId, Client> clients_; // from here on: of the process's own thread
    web::ClientId drawn_last_{0};
    std::chrono::steady_clock::time_point state_sent_, topics_sent_;
};

} // namespace gridspace::monitor
