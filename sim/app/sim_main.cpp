// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-sim: the physics, the simulation clock, and the simulator's side of the gateways.
#include "sim/app/sim_app.hpp"

int main(int argc, char** argv) {
    using namespace gridspace;
    sim::SimConfig config;
    Daemon const daemon{"gridspace-sim", "simulator: network, simulation clock and gateways",
                        [&](config::Fields& f) { describe(f, config); },
                        [&](config::Diagnostics& diagnostics) { sim::check(config, diagnostics); },
                        [&](DaemonRun& run) { return sim::run(config, run); }};
    return run_daemon(daemon, argc, argv);
}
