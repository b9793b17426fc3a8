// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-sim: the physics, the simulation clock, and the simulator's side of the gateways.
#include "sim/app/sim_app.hpp"
#include "sim/app/sim_declaration.hpp"

int main(int argc, char** argv) {
    using namespace gridspace;
    sim::SimConfig config;
    program::Declaration const declaration = sim::sim_declaration();
    Daemon const daemon{declaration.name,
                        declaration.description,
                        [&](config::Fields& f) { describe(f, config); },
                        [&](config::Diagnostics& diagnostics) { sim::check(config, diagnostics); },
                        [&](DaemonRun& run) { return sim::run(config, run); },
                        true,
                        sim::sim_declaration};
    return run_daemon(daemon, argc, argv);
}
