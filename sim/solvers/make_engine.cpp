// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/solvers/make_engine.hpp"

#include "common/team.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/phasor/phasor_engine.hpp"
#include "sim/runtime/fuse_engine.hpp"
#include "sim/runtime/tap_changing_engine.hpp"

namespace gridspace::sim {
namespace {

Result<std::unique_ptr<Engine>> make_solver(EngineSettings const& settings, Network network, TimeBase base) {
    if (settings.waveform()) {
        std::shared_ptr<Team> team =
            settings.threads > 1 ? make_thread_team(static_cast<int>(settings.threads)) : nullptr;
        return emt::make_emt_engine(
            std::move(network), {base, base.nearest(settings.step_s), start_hour_of_day(settings), std::move(team)});
    }
    phasor::PhasorOptions options{.time_base = base, .start_hour_of_day = start_hour_of_day(settings)};
    options.fixed_step_s = settings.fixed_step ? settings.step_s.to_double() : 0;
    return phasor::make_phasor_engine(std::move(network), options);
}

} // namespace

Result<std::unique_ptr<Engine>> make_engine(EngineSettings const& settings, Network network, TimeBase base) {
    auto solver = make_solver(settings, network, base);
    if (!solver) {
        return solver;
    }
    return with_fuses(with_tap_changers(std::move(*solver), network, base), network, base,
                      base.nearest(settings.step_s));
}

} // namespace gridspace::sim
