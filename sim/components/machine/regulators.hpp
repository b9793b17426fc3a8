// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <limits>
#include <optional>

/// Data of a synchronous machine's regulators, in units of the network file.
namespace gridspace::sim {

/// Limits of the field voltage that go with the terminal voltage: VRMAX, VRMIN and KC of ST1A.
struct FieldCeiling {
    double max_pu{0}, min_pu{0};
    double kc_pu{0}; ///< what the upper one loses per p.u. of field current: the rectifier's commutation
};

/// Power system stabilizer PSS1A with the speed as its input (IEEE 421.5).
struct Stabilizer {
    double gain{0}, washout_s{10};
    double t1_s{0}, t2_s{0}, t3_s{0}, t4_s{0}; ///< (1 + t1 s) / (1 + t2 s), and the same with t3 and t4
    double min_pu{-0.1}, max_pu{0.1};
};

/// What AC8B of IEEE 421.5-2005 (6.8) has in addition to KA, TA and TR: PID control, limits, an alternator with diodes.
struct Ac8b {
    double kpr{0}, kir{0}, kdr{0}, tdr_s{0};
    std::optional<double> pid_min_pu, pid_max_pu; ///< of the control's output (PSS/E, AC8C of IEEE 421.5-2016)
    double vr_min_pu{0}, vr_max_pu{0};
    double te_s{0}, ke{1};
    double kc{0}; ///< rectifier loading
    double kd{0}; ///< demagnetizing
    double e1_pu{0}, se_e1{0}, e2_pu{0}, se_e2{0};
    double ve_min_pu{0};
    std::optional<double> vfe_max_pu;

    [[nodiscard]] double lowest() const { return pid_min_pu.value_or(-std::numeric_limits<double>::infinity()); }
    [[nodiscard]] double highest() const { return pid_max_pu.value_or(std::numeric_limits<double>::infinity()); }
};

/// Voltage regulator and exciter. Without an `ac8b` a static one, ST1A of IEEE 421.5, of which ka, ta, tr and the
/// limits are the simplest form.
struct Avr {
    double ka{0}, ta_s{0}, tr_s{0}, efd_min_pu{0}, efd_max_pu{0};
    double tc_s{0}, tb_s{0}; ///< (1 + tc s) / (1 + tb s) before the gain
    double kf{0}, tf_s{1};   ///< kf s / (1 + tf s), back from the field voltage
    std::optional<FieldCeiling> ceiling;
    std::optional<Ac8b> ac8b;
    std::optional<Stabilizer> stabilizer;
};

/// AT, KT and T3 of GAST.
struct TurbineLoadLimit {
    double power_pu{1}, gain{2}, t_s{3};
};

/// What the droop of DEGOV1 goes by.
enum class DroopControl { throttle, electric_power };

/// Woodward's diesel governor: DEGOV and, with a droop, DEGOV1 of PSS/E. TMIN and TMAX are the limits of the gate.
struct Degov {
    double t1_s{0}, t2_s{0}, t3_s{0};       ///< electric control box: (1 + t3 s) / (1 + t1 s + t1 t2 s^2)
    double k{0}, t4_s{0}, t5_s{0}, t6_s{0}; ///< actuator: k (1 + t4 s) / (s (1 + t5 s) (1 + t6 s))
    double td_s{0};                         ///< dead time of the engine
    DroopControl droop_control{DroopControl::throttle};
    double te_s{0}; ///< of the measured electric power
};

/// Speed governor and turbine. Without a `degov` TGOV1 with an integral, and with a load limit the gas turbine GAST.
/// p.u. of the machine's rating.
struct Governor {
    double droop_percent{4};
    double tg_s{0}, tt_s{0};
    double integral_ki{0};
    std::optional<double> gate_min_pu, gate_max_pu; ///< of the servo; without: any
    double lead_s{0};                               ///< of the turbine: what of its power comes at once
    double damping_pu{0};                           ///< power that the turbine loses per p.u. of speed
    std::optional<TurbineLoadLimit> load_limit;     ///< by the temperature of the exhaust
    std::optional<Degov> degov;

    [[nodiscard]] double lowest() const { return gate_min_pu.value_or(-std::numeric_limits<double>::infinity()); }
    [[nodiscard]] double highest() const { return gate_max_pu.value_or(std::numeric_limits<double>::infinity()); }
};

} // namespace gridspace::sim
