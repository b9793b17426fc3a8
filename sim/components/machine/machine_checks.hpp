// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "sim/components/machine/machine_data.hpp"
#include "sim/components/machine/rotor_state.hpp"

#include <string>

namespace gridspace::sim::machines {

/// Fails when the field voltage of the start is outside the limits of regulator and exciter.
[[nodiscard]] Result<void> check_field(std::string const& name, MachineData const& data, State const& x);

/// Fails when the power of the start is outside the limits of the governor.
[[nodiscard]] Result<void> check_gate(std::string const& name, MachineData const& data, double power_pu);

} // namespace gridspace::sim::machines
