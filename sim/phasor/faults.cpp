// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/phasor/faults.hpp"

#include "common/text.hpp"
#include "sim/phasor/sequence_networks.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

namespace gridspace::sim::phasor {
namespace {

constexpr double kMinOhm = 1e-6;
/// A fault nearer to an end of a line than this share is at this share.
constexpr double kMinShare = 1e-6;

/// A line with a fault admittance inside, seen from its buses: nodes `from`, fault, `to`, of which open ends and the
/// fault are eliminated (Kron).
void put_on_line(PiSection const& line, double z_base, Ends closed, ApplyFault const& fault, Complex y_fault,
                 Branch& port) {
    Complex const series = z_base / line.series_ohm;
    Complex const half = line.half_s * z_base;
    double const share = std::clamp(fault.position_percent / 100, kMinShare, 1 - kMinShare);
    Complex const near = series / share, far = series / (1 - share);
    std::array<std::array<Complex, 3>, 3> y{}; // from, to, fault
    y[0][0] = near + half;
    y[1][1] = far + half;
    y[2][2] = near + far + y_fault;
    y[0][2] = y[2][0] = -near;
    y[1][2] = y[2][1] = -far;
    auto const eliminate = [&](std::size_t k) {
        for (std::size_t i = 0; i < 3; ++i) {
            for (std::size_t j = 0; j < 3; ++j) {
                if (i != k && j != k) {
                    y[i][j] -= y[i][k] * y[k][j] / y[k][k];
                }
            }
        }
        for (std::size_t i = 0; i < 3; ++i) {
            y[i][k] = y[k][i] = 0;
        }
    };
    eliminate(2);
    if (!closed.from) {
        eliminate(0);
    }
    if (!closed.to) {
        eliminate(1);
    }
    port.ff = y[0][0];
    port.ft = y[0][1];
    port.tf = y[1][0];
    port.tt = y[1][1];
}

/// What the fault lies on; nullptr where nothing of that name has a length.
TwoPort const* line_of(Network const& n, ApplyFault const& f) {
    NetworkAround const around{n};
    for (TwoPort const* e : two_ports(n)) {
        if (e->name.name == f.line && e->pi(around)) {
            return e;
        }
    }
    return nullptr;
}

bool balanced(ApplyFault const& f) {
    return f.type == FaultType::three_phase_ground || f.type == FaultType::three_phase;
}

} // namespace

Result<void> Faults::apply(Network const& n, ApplyFault const& f) {
    if (f.line.empty() ? find(n.buses, f.bus) == nullptr : line_of(n, f) == nullptr) {
        return fail(ExitCode::usage, fmt::format("there is no {} '{}'", f.line.empty() ? "bus" : "line",
                                                 f.line.empty() ? f.bus : f.line));
    }
    if (!(f.position_percent >= 0 && f.position_percent <= 100)) {
        return fail(ExitCode::usage,
                    fmt::format("a fault at {} % of line '{}' is not on it", shortest(f.position_percent), f.line));
    }
    for (auto const& [name, other] : active_) {
        if (name != f.name && !(balanced(f) && balanced(other))) {
            return fail(
                ExitCode::usage,
                fmt::format("faults '{}' and '{}' are there together, and one of them is unbalanced", name, f.name),
                "phasors know one unbalanced fault at a time; use `solver: emt`");
        }
        if (!f.line.empty() && other.line == f.line && name != f.name) {
            return fail(ExitCode::usage, fmt::format("line '{}' already has the fault '{}'", f.line, name),
                        "use `solver: emt`");
        }
    }
    active_[f.name] = known_[f.name] = f;
    return {};
}

Result<void> Faults::clear(std::string const& name) {
    if (!known_.contains(name)) {
        return fail(ExitCode::usage, fmt::format("there is no fault '{}' to clear", name));
    }
    active_.erase(name);
    return {};
}

Result<void> Faults::enter(Network const& n, SwitchState const& switches, std::set<std::string> const& out,
                           std::vector<Branch>& branches, std::vector<Complex>& shunts) const {
    NetworkAround const around{n};
    std::vector<TwoPort const*> const elements = two_ports(n);
    for (auto const& [name, f] : active_) {
        TwoPort const* const line = f.line.empty() ? nullptr : line_of(n, f);
        Ref const bus = line == nullptr ? Ref{f.bus, {}} : line->from;
        double const z_base = around.base_ohm(bus);
        double const r = std::max(f.resistance_ohm, kMinOhm) / z_base;
        Complex y = 1 / r;
        if (!balanced(f)) {
            auto const z = sequence_impedances(n, switches, out, f);
            if (!z) {
                return std::unexpected{z.error()};
            }
            y = 1.0 / positive_sequence_fault(f.type, *z, r);
        }
        if (line == nullptr) {
            shunts[around.bus(bus)] += y;
            continue;
        }
        for (Branch& b : branches) {
            if (b.element != Branch::kNone && elements[b.element] == line) {
                put_on_line(line->pi(around)->positive, z_base, switches.closed(n, line->name), f, y, b);
            }
        }
    }
    return {};
}

} // namespace gridspace::sim::phasor
