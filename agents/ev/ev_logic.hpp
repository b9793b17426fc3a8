// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace gridspace::agents {

/// What an EV's agent knows of its battery and wants of its charge.
struct EvParams {
    double capacity_kwh{24};
    double battery_v{360};
    double rated_current_a{15};
    double soc_target_percent{80};
    double requested_h{4}; ///< time after the start in which the target shall be reached
    enum class TimeBase {
        remaining, ///< t = what is left of requested_h, but at least min_remaining_h
        fixed,     ///< t = requested_h, as printed: the target is approached exponentially and never reached
    } time_base{TimeBase::remaining};
    double min_remaining_h{0.1};
};

/// Battery current that the EV asks for, A.
/// Eq. (1): I_req = (SoC_f - SoC_c) MC / (t V_b), MC the capacity in Wh; Eq. (2): capped at the rated current.
/// A finished EV asks for 0.
[[nodiscard]] double requested_current_a(EvParams const& params, double soc_percent, double elapsed_h);

} // namespace gridspace::agents
