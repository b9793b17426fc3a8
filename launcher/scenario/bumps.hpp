// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/scenario/program.hpp"
#include "launcher/scenario/scenario.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// A process in the cable between a host and a switch.
struct PlacedBump {
    std::string process, process_host; ///< who, and the host in which the two interfaces are
    std::string host, link;            ///< the ends of the cable
    std::string host_interface, switch_interface;
    /// A direction that goes through its hands: between which pieces of the cable. Lockstep ledgers name a frame's
    /// place so.
    struct Way {
        std::string in, out;                   ///< `out` empty: frames pass untouched, and are only heard
        std::vector<std::uint16_t> ethertypes; ///< what processes of the run send there
        bool only_heard{false};
    };
    std::optional<Way> from_host, to_host;
};

/// All of the scenario. Several in one cable stand in the order of the processes, the first one next to the host.
[[nodiscard]] std::vector<PlacedBump> placed_bumps(Scenario const& scenario);

/// The piece of cable into which a host sends on a link, or from which it receives: the link itself when nobody sits
/// there.
[[nodiscard]] std::string piece_sent_on(Scenario const& scenario, std::string const& host, std::string const& link);
[[nodiscard]] std::string piece_received_on(Scenario const& scenario, std::string const& host, std::string const& link);

/// What a process sends and receives, by pieces of cable, the frames that it passes on included. `bumps`: all of the
/// scenario.
[[nodiscard]] std::vector<WireUse> wires_sent(Scenario const& scenario, Process const& process,
                                              std::vector<PlacedBump> const& bumps);
[[nodiscard]] std::vector<WireUse> wires_received(Scenario const& scenario, Process const& process,
                                                  std::vector<PlacedBump> const& bumps);

/// `bumps:` of the settings of a process (gateways/bump_in_the_wire/bump_config.hpp).
[[nodiscard]] config::Node bump_settings(Scenario const& scenario, Process const& process);

/// The places of a process must exist: a host, a link that it is plugged into, and no IP there.
void check_bumps(Scenario const& scenario, Process const& process, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
