// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// How waveforms begin in a network whose phases differ.
#include "sim/emt/emt_engine_impl.hpp"
#include "sim/powerflow/three_phase.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

constexpr int kMostTrials = 200;
constexpr double kSettledPu = 1e-10;

/// What a machine, or another element with states of its own, is to give at the start.
struct Wanted {
    std::size_t norton{0};
    Complex va;       ///< of three phases
    double peak_v{0}; ///< it holds this voltage; 0: whatever there is
    bool holds_angle{false};
};

} // namespace

Result<void> EmtEngine::initialise_unbalanced() {
    if (std::ranges::any_of(parts_.one_ports, [](auto const& parts) { return parts.norton >= 0; })) {
        return initialise_around_norton();
    }
    ThreePhaseOptions options;
    options.start_hour_of_day = options_.start_hour_of_day;
    auto const flow = solve_three_phase(network_, SwitchState{network_}, options);
    if (!flow) {
        return std::unexpected{flow.error()};
    }
    std::vector<BusPhases> bus_v;
    for (std::size_t i = 0; i < network_.buses.size(); ++i) {
        BusPhases v = flow->buses[i];
        for (auto& phase : v) {
            phase *= std::numbers::sqrt2 / parts_.bus_peak_v[i];
        }
        bus_v.push_back(v);
    }
    return begin({}, start_injections(bus_v, std::vector<double>(parts_.one_ports.size(), 0.0)));
}

/// Machines hold power and voltage of the positive sequence, and are impedances to the others. The balanced power flow
/// says where to begin; then the solver's own steady state is corrected until they hold them.
Result<void> EmtEngine::initialise_around_norton() {
    auto begun = balanced_start();
    if (!begun) {
        return std::unexpected{begun.error()};
    }
    auto& [bus_v, starts, kvar] = *begun;
    std::vector<Wanted> wanted;
    double largest = 0;
    bool held = false; // the angle, by a source
    std::size_t holder = 0;
    for (std::size_t i = 0; i < parts_.one_ports.size(); ++i) {
        Holding const holding = holding_of(*one_ports_[i]);
        held = held || holding.ideal || (holding.keeps_alive && !holding.regulates);
        if (parts_.one_ports[i].norton < 0) {
            continue;
        }
        if (holding.keeps_alive && holding.rating_kva > largest) { // as the power flow chooses
            largest = holding.rating_kva;
            holder = wanted.size();
        }
        auto const norton = static_cast<std::size_t>(parts_.one_ports[i].norton);
        auto const [v, amperes] = starts[norton];
        wanted.push_back({norton, 1.5 * v * std::conj(amperes), holding.regulates ? std::abs(v) : 0, false});
    }
    if (!held && largest > 0) {
        wanted[holder].holds_angle = true;
    }
    for (int trial = 0; trial < kMostTrials; ++trial) {
        if (auto ok = solver_.start(starts, start_injections(bus_v, kvar), true); !ok) {
            return ok;
        }
        double change = 0;
        for (std::size_t b = 0; b < bus_v.size(); ++b) {
            for (std::size_t k = 0; k < 3; ++k) {
                Complex const v =
                    solver_.start_voltage(parts_.bus_node[b] + static_cast<int>(k)) / parts_.bus_peak_v[b];
                change = std::max(change, std::abs(v - bus_v[b][k]));
                bus_v[b][k] = v;
            }
        }
        for (Wanted const& w : wanted) {
            auto const [v, i] = solver_.start_of(w.norton);
            if (v == 0.0) {
                continue;
            }
            Complex const there = w.peak_v > 0 ? v * (w.peak_v / std::abs(v)) : v;
            Complex const s = 1.5 * v * std::conj(i);
            if (w.holds_angle) {
                starts[w.norton] = {std::polar(w.peak_v, std::arg(starts[w.norton].v)), i};
            } else {
                Complex const power{w.va.real(), w.peak_v > 0 ? s.imag() : w.va.imag()};
                starts[w.norton] = {there, std::conj(power * 2.0 / (3.0 * there))};
            }
        }
        if (change < kSettledPu) {
            return finish_start();
        }
    }
    return fail(ExitCode::usage, "no start is found for the machines of this unbalanced network",
                "less difference between the phases, or fewer machines that hold a voltage");
}

} // namespace gridspace::sim::emt
