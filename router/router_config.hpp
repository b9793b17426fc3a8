// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/raw_access.hpp"
#include "common/config/fields.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::router {

/// Where the router takes part: a DDS domain of this site, or the link to another site.
struct EndConfig {
    config::Ref name;
    std::int64_t domain{0};
    std::vector<std::string> addresses; ///< IPv4 of the interfaces to use; empty: all
    std::filesystem::path qos;          ///< participant profile of another file: discovery server, TCP, security
    std::string profile{"management"};
    std::filesystem::path network_namespace; ///< of a domain in another network namespace; empty: the process's own
    std::optional<bus::TcpLink> link;        ///< to another site; otherwise a domain
    enum class Run { none, management, data } run{Run::none}; ///< a network of the run that has started the router
};

/// A topic that may pass.
struct TopicConfig {
    std::string name;
    std::vector<std::size_t> from, to; ///< indices of ends
    std::int64_t depth{0}; ///< samples of each instance for readers that are behind or late; 0: the profile's
};

struct RouterConfig {
    std::string name;
    std::vector<EndConfig> ends;
    std::vector<TopicConfig> topics;
};

/// Splits "HOST:PORT"; nothing when it is none.
[[nodiscard]] std::optional<std::pair<std::string, std::uint16_t>> host_and_port(std::string_view text);

void describe(config::Fields& f, RouterConfig& config);

/// Fills in the networks of the run, from what `gridspace run` gives a `program: exec` by `variable` (std::getenv).
/// Fails where no run has started this.
[[nodiscard]] Result<void> take_run_networks(RouterConfig& config,
                                             std::function<char const*(char const*)> const& variable);

} // namespace gridspace::router
