// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Who is asked to stop while the simulator goes must not be handed to what is gone.
#include "bus/daemon.hpp"
#include "common/source_tree.hpp"
#include "sim/app/sim_app.hpp"
#include "tests/integration/veth/veth.hpp"

#include <fmt/format.h>
#include <gmock/gmock.h>

namespace gridspace::sim {
namespace {

class SimulatorStop : public ethernet::Veth {};

TEST_F(SimulatorStop, IsWithdrawnOnEveryWayOut) {
    SimConfig config;
    config.simulation.network = source_tree("configs/networks/smib.yaml");
    config.simulation.duration_s = Rational{1};
    config.simulation.gateways = config::Node::scalar("none_of_ours"); // found when it is on the bus already
    StatusReporter status;
    std::vector<bool> can_be_stopped;
    DaemonRun run{{}, status, [&](std::function<void()> stop) { can_be_stopped.push_back(stop != nullptr); }};
    run.bus.process = "sim";
    run.bus.program = "test";
    run.bus.qos = source_tree("qos/simulator.xml");
    run.bus.management = {1, {"127.0.0.1"}};
    run.bus.clock.simulator = "sim";

    Result<void> const result = sim::run(config, run);

    ASSERT_FALSE(result);
    EXPECT_THAT(describe(result.error()), testing::HasSubstr("gateways is 'none_of_ours'"));
    // The bus, the simulator on it; then first the simulator and last the bus.
    EXPECT_THAT(can_be_stopped, testing::ElementsAre(true, true, false, false));
}

} // namespace
} // namespace gridspace::sim
