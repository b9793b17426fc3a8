// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/app/live_run.hpp"
#include "monitor/web/server.hpp"

#include <functional>
#include <string>

namespace gridspace::monitor {

/// The REST interface (docs/reference/rest_api.md): a function from requests to responses over what is known of the
/// run.
class Api {
  public:
    /// `counters` tells about the server itself.
    Api(LiveRun const& run, std::function<web::ServerCounters()> counters);
    /// From now on whoever knows `token` may have `act` called with pause, continue, "step 3" or stop.
    void allow_control(std::string token, std::function<void(std::string const& action)> act);
    [[nodiscard]] web::Response answer(web::Request const& request) const;

    // What is pushed, too; JSON texts.
    [[nodiscard]] std::string health() const;
    [[nodiscard]] std::string run() const;
    [[nodiscard]] std::string graph() const;
    [[nodiscard]] std::string network() const;
    [[nodiscard]] std::string topics() const;
    [[nodiscard]] std::string signals() const;
    [[nodiscard]] std::string events(std::uint64_t after, std::size_t most) const;

  private:
    [[nodiscard]] web::Response control(web::Request const& request) const;
    [[nodiscard]] web::Response topic(std::string const& rest) const;
    [[nodiscard]] web::Response signal_query(web::Target const& target) const;

    LiveRun const& run_;
    std::function<web::ServerCounters()> counters_;
    std::string token_; ///< empty: nobody may control the run
    std::function<void(std::string const&)> act_;
};

} // namespace gridspace::monitor
