// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/healthy_current.hpp"

#include "agents/relay/differential_element.hpp"
#include "sim/app/engine_factory.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <cmath>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::launcher {
namespace {

using sim::Complex;

/// Current into the line at a transformer's end, amperes RMS; zero when the line is not in service.
Complex into_line(sim::Network const& network, sim::PowerFlow const& flow, sim::Ct const& ct) {
    std::vector<sim::TwoPort const*> const elements = two_ports(network);
    for (sim::PowerFlow::BranchValue const& branch : flow.branches) {
        sim::TwoPort const& line = *elements[branch.element];
        if (line.name != ct.line) {
            continue;
        }
        bool const at_from = ct.end == sim::LineEnd::from;
        std::size_t const bus = sim::index_of(network.buses, (at_from ? line.from : line.to).name);
        Complex const kva =
            at_from ? Complex{branch.p_from_kw, branch.q_from_kvar} : Complex{branch.p_to_kw, branch.q_to_kvar};
        Complex const v = flow.buses[bus].v * network.buses[bus].voltage_v;
        return std::abs(v) > 0 ? std::conj(kva * 1e3 / (std::numbers::sqrt3 * v)) : Complex{};
    }
    return {};
}

/// As the transformer gives it out, with its direction and its error.
Complex measured(sim::Network const& network, sim::PowerFlow const& flow, sim::Ct const& ct) {
    bool const against = ct.end == sim::LineEnd::to && ct.positive == sim::CtPolarity::from_to;
    sim::CtType const* const type = sim::find(network.ct_types, ct.type.name);
    double const error = type == nullptr ? 0 : type->error_percent / 100;
    return into_line(network, flow, ct) * (against ? -1.0 : 1.0) * (1 + error);
}

relay::Abc at_angle(Complex rms, double angle) {
    relay::Abc out{};
    for (std::size_t phase = 0; phase < 3; ++phase) {
        double const shift = 2 * std::numbers::pi / 3 * static_cast<double>(phase);
        out[phase] = std::numbers::sqrt2 * std::abs(rms) * std::cos(angle + std::arg(rms) - shift);
    }
    return out;
}

std::string text_of(sim::Ct const& ct) {
    return fmt::format("{} ({} end of {}, positive: {})", ct.name.name, ct.end == sim::LineEnd::from ? "from" : "to",
                       ct.line.name, ct.positive == sim::CtPolarity::from_to ? "from_to" : "into_line");
}

} // namespace

void check_healthy_current(Scenario const& scenario, Process const& process, relay::RelayConfig const& config,
                           sim::Ct const& from, sim::Ct const& to, relay::ElementParams const& element,
                           config::Diagnostics& diagnostics) {
    config::Node const* const told = process.node.find("positive");
    auto const where = told != nullptr ? told->where : config.to_stream.where;
    int const width = told != nullptr ? 1 : static_cast<int>(config.to_stream.name.size());
    if (from.line == to.line && from.end == to.end) {
        diagnostics.warning(
            where, fmt::format("relay '{}' sees the same end of '{}' twice", process.name.name, from.line.name),
            fmt::format("'{}' comes from {}, '{}' from {}: it is blind to faults", config.from_stream.name,
                        text_of(from), config.to_stream.name, text_of(to)),
            width);
    }
    sim::PowerFlowOptions options;
    options.start_hour_of_day = sim::start_hour_of_day(scenario.simulation);
    sim::Network const& network = *scenario.network;
    auto const flow = solve_power_flow(network, sim::SwitchState{network}, options);
    if (!flow) {
        return; // reported for the whole network
    }
    Complex const at_from = measured(network, *flow, from), at_to = measured(network, *flow, to);
    double const sign = config.to_positive == relay::Positive::from_to ? -1 : 1;
    relay::DifferentialElement differential{element};
    for (int i = 0; i < element.window_samples; ++i) {
        double const angle = 2 * std::numbers::pi * i / element.samples_per_cycle;
        differential.push(at_angle(at_from, angle), at_angle(sign * at_to, angle));
    }
    relay::ElementValues const values = differential.evaluate();
    if (values.pickup_phases == 0) {
        return;
    }
    diagnostics.warning(
        where,
        fmt::format("relay '{}' would trip on the healthy network: its differential current is {:.2f} A, "
                    "and it picks up at {:.2f} A",
                    process.name.name, values.differential_a[0], values.operate_at_a[0]),
        fmt::format("{:.2f} A from {}, {:.2f} A from {}; is the direction right (`positive:`), are both "
                    "of one line, and is pickup_a "
                    "above what the line charges?",
                    std::abs(at_from), text_of(from), std::abs(at_to), text_of(to)),
        width);
}

} // namespace gridspace::launcher
