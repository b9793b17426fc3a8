// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/security/rights.hpp"

namespace gridspace::launcher {

Rights rights_of(Scenario const& scenario, Process const& process) {
    if (process.program.name == "gridspace-monitor") {
        return {{}, {"*"}};
    }
    Rights out;
    for (TopicUse const& use : process.settings->writes(scenario, process)) {
        out.publish.insert(use.topic);
    }
    for (TopicUse const& use : process.settings->reads(scenario, process)) {
        out.subscribe.insert(use.topic);
    }
    out.publish.insert({"member_status", "type_catalog"});
    if (&process == scenario.simulator()) {
        out.publish.insert("simulation_clock");
    } else if (process.settings->is_member() && scenario.clock.mode == bus::ClockMode::lockstep) {
        out.publish.insert("clock_ack");
    }
    out.subscribe.insert({"simulation_clock", "clock_ack", "member_status", "type_catalog", "signal_catalog", "signals",
                          "stream_statistics"});
    return out;
}

} // namespace gridspace::launcher
