// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

namespace gridspace::relay {

/// What the currents are compared with.
enum class Polarisation : std::uint8_t {
    positive_sequence, ///< I1 against the remembered V1; one answer for all phases
    cross,             ///< each phase's current against the voltage between the others, turned forward by 90 degrees
    negative_sequence, ///< I2 against -V2; for unbalanced faults
    zero_sequence,     ///< I0 against -V0; for earth faults
};

struct RdirParams {
    Polarisation polarisation{Polarisation::positive_sequence};
    double characteristic_angle_deg{60}; ///< by which the current of a forward fault lags
    double sector_deg{85};               ///< to both sides of it that is forward; opposite it is reverse
    double minimum_a{0}, minimum_v{0};   ///< below, there is no direction
};

/// Directional element (67, RDIR): forward when the current, turned by the characteristic angle, lies within the sector
/// around the polarising voltage (Blackburn and Domin, Protective Relaying, chapter 3).
class Rdir final : public Function {
  public:
    explicit Rdir(RdirParams const& params);
    [[nodiscard]] std::uint8_t needs() const override;
    FunctionState step(FunctionInput const& input) override;
    void reset() override {}

  private:
    [[nodiscard]] int side(Complex current, Complex voltage) const;

    RdirParams params_;
    Complex turn_;
    double least_cosine_;
};

} // namespace gridspace::relay
