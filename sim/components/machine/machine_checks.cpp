// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine_checks.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::machines {

Result<void> check_field(std::string const& name, MachineData const& data, double efd, double v) {
    if (!data.avr) {
        return {};
    }
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
