// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/machine/machine_checks.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim::machines {

Result<void> check_field(std::string const& name, MachineData const& data, double efd) {
    if (!data.avr || (efd <= data.avr->efd_max_pu && efd >= data.avr->efd_min_pu)) {
        return {};
    }
    return fail(
        ExitCode::usage,
        fmt::format("machine '{}' needs a field voltage of {:.3f} p.u. at the start, outside its limits {} to {}", name,
                    efd, shortest(data.avr->efd_min_pu), shortest(data.avr->efd_max_pu)),
        "ask it for less reactive power (voltage_setpoint_pu), or widen efd_min_pu and efd_max_pu");
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
