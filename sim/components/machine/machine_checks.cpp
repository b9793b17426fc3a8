// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine_checks.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::machines {

namespace {

/// Of AC8B: the steady state of its amplifier and its alternator.
Result<void> check_ac8b(std::string const& name, MachineData const& data, State const& x) {
    Ac8b const& a = *data.avr->ac8b;
    double const vr = x[kRegulator], ve = x[kEfd], ka = data.avr->ka;
    double const low = std::max(a.vr_min_pu, ka * a.lowest());
    double const high = std::min({a.vr_max_pu, ka * a.highest(), a.vfe_max_pu.value_or(a.vr_max_pu)});
    if (vr < low || vr > high) {
        return fail(
            ExitCode::usage,
            fmt::format("the exciter of machine '{}' needs {:.3f} p.u. of its amplifier at the start, outside "
                        "its limits {} to {}",
                        name, vr, shortest(low), shortest(high)),
            "ask it for less reactive power (voltage_setpoint_pu), or widen vr_min_pu, vr_max_pu, vfe_max_pu or "
            "the limits of its control");
    }
    if (ve < a.ve_min_pu) {
        return fail(ExitCode::usage,
                    fmt::format("the exciter of machine '{}' is at {:.3f} p.u. at the start, below its ve_min_pu = {}",
                                name, ve, shortest(a.ve_min_pu)),
                    "let it take less reactive power (voltage_setpoint_pu), or lower ve_min_pu");
    }
    return {};
}

} // namespace

Result<void> check_field(std::string const& name, MachineData const& data, State const& x) {
    if (!data.avr) {
        return {};
    }
    if (data.avr->ac8b) {
        return check_ac8b(name, data, x);
    }
    double const efd = x[kEfd], v = x[kVmeas];
    double low = data.avr->efd_min_pu, high = data.avr->efd_max_pu;
    if (auto const& c = data.avr->ceiling) { // the field current is the field voltage in steady state
        low = std::max(low, v * c->min_pu);
        high = std::min(high, v * c->max_pu - c->kc_pu * efd);
    }
    if (efd <= high && efd >= low) {
        return {};
    }
    return fail(
        ExitCode::usage,
        fmt::format("machine '{}' needs a field voltage of {:.3f} p.u. at the start, outside its limits {} to {}", name,
                    efd, shortest(low), shortest(high)),
        "ask it for less reactive power (voltage_setpoint_pu), or widen the limits of its `avr`");
}

Result<void> check_gate(std::string const& name, MachineData const& data, double power_pu) {
    if (!data.governor) {
        return {};
    }
    Governor const& g = *data.governor;
    double const most = g.load_limit ? std::min(g.highest(), g.load_limit->power_pu) : g.highest();
    if (power_pu <= most && power_pu >= g.lowest()) {
        return {};
    }
    return fail(ExitCode::usage,
                fmt::format("machine '{}' gives {:.3f} p.u. at the start, outside the limits of its governor, {} to {}",
                            name, power_pu, shortest(g.lowest()), shortest(most)),
                "give it less to do (p_kw), or widen gate_min_pu, gate_max_pu or the load limit");
}

} // namespace gridspace::sim::machines
