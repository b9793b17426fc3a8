// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/emt/step_choice.hpp"

#include "sim/emt/network_circuit.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

/// Of the network's base power.
constexpr double kLeastShare = 0.01;

/// Nominal voltages of all nodes: those of buses, and what hangs on them by closed poles and branches.
std::vector<double> nominal_voltages(NetworkCircuit const& n) {
    Circuit const& c = n.circuit;
    std::vector<double> v(static_cast<std::size_t>(c.nodes()));
    auto const set = [&](int node, double peak_v) { std::fill_n(v.begin() + node, 3, peak_v); };
    for (std::size_t b = 0; b < n.bus_node.size(); ++b) {
        set(n.bus_node[b], n.bus_peak_v[b]);
    }
    bool more = true;
    auto const spread = [&](int a, int b) {
        double const va = v[static_cast<std::size_t>(a)], vb = v[static_cast<std::size_t>(b)];
        if (a != kEarth && b != kEarth && (va == 0) != (vb == 0)) {
            set(va == 0 ? a : b, std::max(va, vb));
            more = true;
        }
    };
    while (more) {
        more = false;
        for (Switch const& s : c.switches) {
            spread(s.outer, s.inner);
        }
        for (RlBranch const& b : c.rl) {
            spread(b.from, b.to);
        }
        for (CoupledBranch const& b : c.coupled) {
            spread(b.from, b.to);
        }
    }
    for (double& x : v) {
        x = x == 0 ? c.peak_v : x;
    }
    return v;
}

double lost_percent(double steps_per_period) {
    double const x = std::numbers::pi / steps_per_period;
    return 100 * (1 - std::pow(1 + x * x, -2));
}

/// The longest whole part of `period` that is not longer than `longest_s`.
Rational part_of(Rational period, double longest_s) {
    double const parts = std::ceil(period.to_double() / longest_s * (1 - 1e-12));
    return period / Rational{static_cast<std::int64_t>(std::max(parts, 1.0))};
}

} // namespace

Result<StepNeeds> step_needs(Network const& network, double start_hour_of_day) {
    auto const parts = make_circuit(network, start_hour_of_day);
    if (!parts) {
        return std::unexpected{parts.error()};
    }
    Circuit const& c = parts->circuit;
    StepNeeds out{1 / (kStepsPerFundamental * network.frequency_hz), "the fundamental", {}};
    auto const need = [&](double longest_s, std::string reason) {
        if (longest_s < out.longest_s) {
            out.longest_s = longest_s;
            out.reason = std::move(reason);
        }
    };
    for (VoltageSource const& s : c.sources) {
        for (VoltageSource::Harmonic const& h : s.harmonics) {
            need(1 / (kGoodStepsPerPeriod * h.order * network.frequency_hz),
                 fmt::format("harmonic {} of source '{}'", h.order, s.name));
        }
    }
    for (BergeronLine const& line : c.bergeron) {
        need(std::min(line.tau1, line.tau0), fmt::format("the travel time of line '{}'", line.name));
    }
    for (MartiLine const& line : c.marti) {
        need(std::min(line.positive.tau_s, line.zero.tau_s), fmt::format("the travel time of line '{}'", line.name));
    }
    ModeSearch const search{nominal_voltages(*parts), kLeastShare * network.power_kva * 1e3 / 3};
    for (bool const all_closed : {false, true}) {
        auto const mode = fastest_mode(c, switch_state(c, all_closed), search);
        if (mode && *mode && (!out.mode || (*mode)->frequency_hz > out.mode->frequency_hz)) {
            out.mode = **mode; // poles that join two ideal sources cannot all be closed
        }
    }
    return out;
}

Rational resolving_step(StepNeeds const& needs, Rational period) {
    double const mode_s = needs.mode ? 1 / (kGoodStepsPerPeriod * needs.mode->frequency_hz) : needs.longest_s;
    return part_of(period, std::min(needs.longest_s, std::max(mode_s, kShortestAutoStep)));
}

std::optional<StepAdvice> step_advice(StepNeeds const& needs, double step_s, Rational period) {
    double const steps = needs.mode ? 1 / (needs.mode->frequency_hz * step_s) : kGoodStepsPerPeriod;
    if (steps >= kFewStepsPerPeriod) {
        return std::nullopt;
    }
    double const good_s = 1 / (kGoodStepsPerPeriod * needs.mode->frequency_hz);
    StepAdvice out{
        fmt::format("steps of {:.3g} us are too long for what rings at {:.4g} Hz between {}: {:.1f} steps a period, "
                    "{:.0f} % of it is lost after a switching",
                    1e6 * step_s, needs.mode->frequency_hz, fmt::join(needs.mode->elements, ", "), steps,
                    lost_percent(steps)),
        fmt::format("steps of {} s show it within {:.1f} %", part_of(period, good_s).to_string(),
                    lost_percent(kGoodStepsPerPeriod))};
    return out;
}

} // namespace gridspace::sim::emt
