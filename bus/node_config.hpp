// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/time.hpp"

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::bus {

enum class ClockMode { realtime, lockstep };

/// How a process takes part in the simulation clock (docs/design/time.md).
struct ClockConfig {
    ClockMode mode{ClockMode::realtime};
    Rational quantum_s{1}; ///< every step and tick is a whole multiple of it
    Rational tick_s{1};
    /// Lockstep: the input of this process is complete so long beyond a tick, and its own ticks end so much later; 0
    /// unless the tick is longer than a hop of a loop (docs/design/time.md).
    Rational ahead_s{0};
    /// Lockstep: what this process sends is complete so long beyond its own tick. 0: nobody counts on it.
    Rational promise_s{0};
    std::optional<Rational> ends_at_s{}; ///< no tick goes beyond it; where `ahead_s` is not 0
    std::int64_t epoch_unix_s{0};        ///< simulated time 0
    double member_timeout_s{10};         ///< a wait inside a tick; 0: none (a debugger is attached)
    double start_timeout_s{30};          ///< until everybody is matched; 0: none
    std::int64_t max_lag_ticks{16};      ///< an idle member still acknowledges this often
    std::string simulator{"sim"};        ///< the process that publishes the clock; empty: time is UTC since the epoch
    std::vector<std::string> members;    ///< lockstep members
    std::vector<std::string> upstream;   ///< members whose output this process reads
    std::vector<std::string> downstream; ///< members that read this process's output
    /// Those of them between whom what is made in a tick is due after it: nobody waits for it within the tick.
    std::vector<std::string> late_upstream{}, late_downstream{};
};

/// One network that a process is on.
struct NetworkConfig {
    std::int64_t domain{0};
    std::vector<std::string> addresses; ///< IPv4 of the interfaces to use; empty: all
    /// Whom to look for, as "address:port" of UDP; empty: everybody, by multicast. Who announces itself by multicast is
    /// heard in any case.
    std::vector<std::string> peers{};
};

/// With how many endpoints of which process a topic's reader or writer must be matched before the process is ready.
using ExpectedPeers = std::map<std::string, std::map<std::string, std::int64_t>>; ///< topic -> process -> count

/// What a process needs to know to be on the bus. Written by the launcher for each process; a hand-written file may
/// leave out everything but the domain.
struct NodeConfig {
    std::string process;
    std::string program;
    std::int64_t incarnation{0};
    std::optional<Rational> joins_at_s;         ///< simulated time at which a restarted incarnation joins
    std::vector<std::string> absent;            ///< expected peers that are gone when this incarnation joins
    std::filesystem::path qos;                  ///< XML profiles of the role
    NetworkConfig management;                   ///< clock, acknowledgements, recording, health
    std::optional<NetworkConfig> data;          ///< the studied network; without it everything is on management
    std::vector<std::string> management_topics; ///< topics beyond the built-in ones that stay off the studied network
    ClockConfig clock;
    ExpectedPeers expected_writers; ///< by topic that this process reads
    ExpectedPeers expected_readers; ///< by topic that this process writes
    bool is_daemon{false};          ///< the node is all that its process is for
};

/// Where a host's participant of that number, counted from 0, hears of others: "address:port" (DDSI-RTPS 2.2, 9.6.1.1).
[[nodiscard]] std::string discovery_address(std::string_view address, std::int64_t domain, int participant);

void describe(config::Fields& f, ClockConfig& clock);
void describe(config::Fields& f, NodeConfig& node);

/// The configuration as the tree that `describe` reads back.
[[nodiscard]] config::Node to_node(NodeConfig const& node);

} // namespace gridspace::bus
