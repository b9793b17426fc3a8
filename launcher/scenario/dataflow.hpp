// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/member_plan.hpp"
#include "bus/node_config.hpp"
#include "launcher/scenario/program.hpp"

#include <map>
#include <string>
#include <vector>

namespace gridspace::launcher {

struct Scenario;
struct Process;

/// Who reads what from whom, as the programs say.
struct Dataflow {
    struct Endpoint {
        std::string process;
        TopicUse use;
        bool expected{true}; ///< others wait for it at the start
    };
    std::map<std::string, std::vector<Endpoint>> writers, readers; ///< by topic
    std::vector<bus::MemberPlan> members;                          ///< lockstep members, by name

    [[nodiscard]] bus::ExpectedPeers expected_writers(std::string const& process) const;
    [[nodiscard]] bus::ExpectedPeers expected_readers(std::string const& process) const;
};

[[nodiscard]] Dataflow dataflow(Scenario const& scenario);

/// What lockstep and the bus demand of it: types agree, everything that is read is written, no circle without the
/// simulator, and every edge into the simulator takes at least one tick.
void check_dataflow(Scenario const& scenario, config::Diagnostics& diagnostics);

/// All deterministic topics that the other processes write.
[[nodiscard]] std::vector<TopicUse> recorded_topics(Scenario const& scenario, Process const& recorder);

/// The settings of gridspace-sim for the scenario.
[[nodiscard]] config::Node simulator_settings(Scenario const& scenario);

} // namespace gridspace::launcher
