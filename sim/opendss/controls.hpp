// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Core>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::opendss {

struct Circuit;

/// Which phase a control looks at, of those that are measured.
enum class Watched { one, largest, smallest, mean };

/// A voltage regulator at a winding of a transformer, with line-drop compensation [OpenDSS manual, "RegControl"].
struct Regulator {
    std::string name;       ///< "regcontrol.reg1"
    std::size_t element{0}; ///< its transformer, in Circuit::elements
    std::size_t winding{1}; ///< that is measured
    std::size_t tap_winding{1};
    double setpoint_v{120}, band_v{3}; ///< of the relay
    double pt_ratio{60}, ct_primary_a{300};
    double r_v{0}, x_v{0}; ///< line-drop compensation: volts of the relay at ct_primary_a
    double limit_v{0};     ///< of the relay; 0: none
    double delay_s{15};
    bool inverse_time{false};
    int most_steps{16}; ///< at once; 0: it stays
    Watched watched{Watched::one};
    int phase{0};
    std::vector<int> remote; ///< nodes of a bus that is measured instead, without compensation
    double remote_ratio{60};
};

/// What a regulator wants at these voltages.
struct TapWish {
    int steps{0};
    double delay_s{0};
    double measured_v{0}; ///< of the relay, compensated
};
[[nodiscard]] TapWish wish_of(Regulator const& regulator, Circuit const& circuit, Eigen::VectorXcd const& v);
/// Its tap changes by `steps`, or as far as there are taps; returns whether it changed.
bool change_tap(Regulator const& regulator, Circuit& circuit, int steps);
/// The position of its tap, steps from the middle.
[[nodiscard]] int tap_position(Regulator const& regulator, Circuit const& circuit);

/// A control that switches a capacitor [OpenDSS manual, "CapControl"].
struct CapacitorControl {
    enum class Kind { current, voltage, kvar, power_factor, time };
    std::string name;
    std::size_t capacitor{0}, monitored{0}; ///< in Circuit::elements
    int terminal{0};
    Kind kind{Kind::current};
    double pt_ratio{60}, ct_ratio{60};
    double on{300}, off{200};
    double pf_on{0.95}, pf_off{1.05}; ///< leading ones count from 1 to 2
    double least_kvar{0};             ///< by power factor: it closes where more flows
    bool voltage_overrides{false};
    double most_v{126}, least_v{115};
    double delay_s{15}, delay_off_s{15};
    Watched of_voltages{Watched::one}, of_currents{Watched::one};
    int voltage_phase{0}, current_phase{0};
    bool between_phases{false}; ///< of one phase the voltage to the next: the bank is in delta
};

/// Whether a capacitor should be in service: nothing when it may stay as it is.
[[nodiscard]] std::optional<bool> wish_of(CapacitorControl const& control, Circuit const& circuit,
                                          Eigen::VectorXcd const& v, double hour);

} // namespace gridspace::opendss
