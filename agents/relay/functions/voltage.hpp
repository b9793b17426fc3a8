// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

namespace gridspace::relay {

/// Which voltages are compared with the setting.
enum class VoltageOf : std::uint8_t { phase_to_earth, phase_to_phase, positive_sequence, residual };

struct VoltageParams {
    double rate_hz{4800};
    bool over{false}; ///< PTOV, otherwise PTUV
    VoltageOf measures{VoltageOf::phase_to_earth};
    bool all_phases{false}; ///< only when all of them are beyond; otherwise one is enough
    double pickup_v{0};
    double dropout_ratio{0.98}; ///< of over; of under its inverse
    bool inverse{false};
    double delay_s{0};         ///< definite time
    double time_multiplier{1}; ///< inverse
    double block_below_v{0};   ///< under: a line that is off is no undervoltage
};

/// Under- and overvoltage (27, 59; PTUV, PTOV): definite or inverse time, t = T / |1 - V / Vs| integrated
/// (IEC 60255-127:2010, clause 5.2, with k = 1, c = 0, alpha = 1).
class VoltageFunction final : public Function {
  public:
    explicit VoltageFunction(VoltageParams const& params);
    [[nodiscard]] std::uint8_t needs() const override { return kVoltages; }
    FunctionState step(FunctionInput const& input) override;
    void reset() override;

  private:
    [[nodiscard]] Abc measured(Measurement const& m, std::size_t& count) const;
    [[nodiscard]] bool is_beyond(double v, bool started) const;

    VoltageParams params_;
    DefiniteTimer delay_;
    std::array<bool, 3> started_{};
    double travelled_{0};
};

} // namespace gridspace::relay
