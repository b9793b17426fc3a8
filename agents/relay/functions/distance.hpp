// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

namespace gridspace::relay {

struct PdisParams {
    double rate_hz{4800};
    enum class Characteristic { mho, quadrilateral } characteristic{Characteristic::mho};
    bool forward{true};
    double reach_ohm{0};             ///< positive sequence, primary
    double angle_deg{75};            ///< of the line's positive-sequence impedance
    double r_ohm{0}, r_earth_ohm{0}; ///< quadrilateral: resistive reach of loops between phases, and to earth
    Complex k0{0, 0};                ///< (Z0 - Z1) / (3 Z1) of the line
    double minimum_a{0};             ///< of a loop's current
    double minimum_residual_a{0};    ///< 3 I0, above which a fault is to earth
    double delay_s{0};
    double confirm_s{0}; ///< that a fault must be seen in the zone before it starts
};

/// One zone of distance protection (21, PDIS; IEC 61850-7-4: each zone is a logical node of its own).
///
/// Loops: V_a / (I_a + k0 3 I0), (V_a - V_b) / (I_a - I_b) and their like. Which of them count follows from the fault:
/// without residual current those between phases; with it, the angle of I2 against I0 names one phase, and its loop to
/// earth and the loop of the two others count (a fault of two phases to earth makes the others overreach).
///
/// mho: the angle between I Zr - V and the polarising voltage is below 90 degrees (Cook, Analysis of Distance
/// Protection, 1985). It is polarised by the remembered positive sequence: with the voltage of the loop itself in that
/// phase, the boundary is the circle over Zr; with a source behind, the circle grows backwards and stays directional.
/// quadrilateral: reactance below the reach, distance from the line below the resistive reach, and forward by the same
/// polarising voltage.
class Pdis final : public Function {
  public:
    explicit Pdis(PdisParams const& params);
    [[nodiscard]] PdisParams const& params() const { return params_; }
    [[nodiscard]] std::uint8_t needs() const override { return kCurrents | kVoltages | kPolarising; }
    FunctionState step(FunctionInput const& input) override;
    void reset() override;
    /// Resistance and reactance of the six loops in ohm, primary, seen from the transformers into what is protected.
    /// Of a loop that does not count, or whose current is too small, there is none.
    [[nodiscard]] std::span<MeasuredQuantity const> quantities() const override;
    void measure(Measurement const& m, std::span<double> out) const override;

    /// Which loops count: bits 0 to 2: a, b, c to earth; 3 to 5: ab, bc, ca.
    [[nodiscard]] std::uint8_t loops(Measurement const& m) const;

  private:
    struct Loop {
        Complex v, i, polarising;
        bool to_earth;
    };
    [[nodiscard]] static Loop loop_of(Measurement const& m, std::size_t number, Complex k0);
    [[nodiscard]] bool is_within(Loop const& loop) const;

    PdisParams params_;
    Complex reach_, turn_; ///< Zr, and 1 at the angle of the line
    DefiniteTimer confirm_, delay_;
};

} // namespace gridspace::relay
