// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/discovery.hpp"
#include "router/router_config.hpp"

#include <map>
#include <set>
#include <string>
#include <vector>

namespace gridspace::router {

inline constexpr std::string_view kProgram = "gridspace-router";

/// One topic's way from one end to others, with the QoS that its writers there have in common.
struct Route {
    std::string topic;
    std::size_t from{0};
    std::vector<std::size_t> to;
    std::string type;
    bool keyed{false};
    bus::EndpointQos qos;
    std::int32_t depth{0};
};
[[nodiscard]] bool same_route(Route const& a, Route const& b);

/// Decides what is carried, from what is discovered: no DDS in here.
///
/// What keeps samples from running in circles: what a router wrote into a domain is never taken up again by a router
/// there. On a link everything is written by routers, and goes into domains only, never on to another link.
class RouteTable {
  public:
    explicit RouteTable(RouterConfig const& config);

    /// A participant other than this router's own. Its endpoints are reported after it.
    void participant_found(std::size_t end, std::string const& id, std::string const& program);
    void participant_gone(std::string const& id);
    void endpoint_found(std::size_t end, bus::DiscoveredEndpoint const& endpoint);
    void endpoint_gone(std::string const& id);

    /// Whether samples of this writer's program are carried on from this end.
    [[nodiscard]] bool takes(std::size_t end, std::string const& program) const;

    [[nodiscard]] std::vector<Route> routes() const;
    /// What somebody will miss, each said once.
    [[nodiscard]] std::vector<std::string> take_notes();

  private:
    struct Writer {
        std::size_t end;
        bus::DiscoveredEndpoint endpoint;
        std::size_t order; ///< of discovery: the first decides the type
    };
    void note(std::string text);

    RouterConfig const& config_;
    std::map<std::string, std::string> programs_; ///< by participant
    std::map<std::string, Writer> writers_;       ///< by GUID; of allowed topics, without routers on domains
    std::size_t found_{0};
    std::set<std::string> noted_;
    std::vector<std::string> notes_;
};

} // namespace gridspace::router
