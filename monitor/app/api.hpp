// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"
#include "monitor/web/server.hpp"

#include <functional>
#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <utility>

namespace gridspace::monitor {

/// The REST interface (docs/reference/rest_api.md): a function from requests to responses over what is known of the
/// run.
class Api {
  public:
    /// `counters` is about the server itself.
    Api(LiveRun const& run, std::function<web::ServerCounters()> counters);
    /// From now on whoever knows `token` may have `act` called with pause, continue, "step 3" or stop.
    void allow_control(std::string token, std::function<void(std::string const& action)> act);
    [[nodiscard]] web::Response answer(web::Request const& request) const;

    /// "GET", "/api/v1/topics/{topic}/last": a name in braces stands for something.
    struct Route {
        std::string_view method, path;
    };
    /// Everything that is answered here; openapi.json describes it.
    [[nodiscard]] static std::span<Route const> routes();

    // What is pushed, too; JSON texts.
    [[nodiscard]] std::string health() const;
    [[nodiscard]] std::string run() const;
    [[nodiscard]] std::string graph() const;
    [[nodiscard]] std::string network() const;
    /// What the scenario expects; of a recorded run also what came of it, and how real its time was.
    [[nodiscard]] std::string verdict() const;
    [[nodiscard]] std::string topics() const;
    [[nodiscard]] std::string streams() const;
    [[nodiscard]] std::string signals() const;
    [[nodiscard]] std::string events(std::uint64_t after, std::size_t most) const;

  private:
    struct Entry;
    static std::span<Entry const> entries();
    [[nodiscard]] web::Response control(web::Request const& request) const;
    [[nodiscard]] web::Response topic(std::string const& name) const;
    /// `cdr`: with the octets of each sample, in hexadecimal digits.
    [[nodiscard]] web::Response last_samples(std::string const& name, bool cdr) const;
    [[nodiscard]] web::Response picture(web::Target const& target, bool dot) const;
    [[nodiscard]] web::Response signal_query(web::Target const& target) const;
    [[nodiscard]] web::Response event_query(web::Target const& target) const;
    [[nodiscard]] web::Response metrics() const;

    /// State and IDL text of a topic; nothing when nobody writes or reads it.
    [[nodiscard]] std::vector<std::string> not_heard(TopicState const& state) const;
    [[nodiscard]] std::optional<std::pair<TopicState, std::string>> topic_state(std::string const& name) const;

    LiveRun const& run_;
    std::function<web::ServerCounters()> counters_;
    std::string token_; ///< empty: nobody may control the run
    std::function<void(std::string const&)> act_;
};

} // namespace gridspace::monitor
