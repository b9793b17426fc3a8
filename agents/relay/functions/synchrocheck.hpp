// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

#include <vector>

namespace gridspace::relay {

struct RsynParams {
    double rate_hz{4800}, nominal_hz{50};
    int samples_per_cycle{80};
    double live_v{0}, dead_v{0}; ///< positive sequence, phase to earth: above, below
    double difference_v{0}, difference_deg{20}, difference_hz{0.1};
    bool dead_line{false}, dead_bus{false}; ///< releases also when one of them is dead
    double hold_s{0.1};                     ///< that the conditions must hold
};

/// Synchrocheck (25, RSYN): line and bus voltages are alike in magnitude, angle and frequency, or one is dead and that
/// is allowed (IEC 61850-7-4, RSYN: DifVClc, DifAngClc, DifHzClc, LivDeaMod). `op` releases the closing.
class Rsyn final : public Function {
  public:
    explicit Rsyn(RsynParams const& params);
    [[nodiscard]] std::uint8_t needs() const override { return kVoltages | kBusVoltages; }
    FunctionState step(FunctionInput const& input) override;
    void reset() override;

  private:
    [[nodiscard]] bool is_synchronous(Complex line, Complex bus);

    RsynParams params_;
    double least_cosine_;
    std::vector<Complex> angles_; ///< line against bus, the last cycle
    std::size_t next_{0};
    int seen_{0};
    DefiniteTimer hold_;
};

} // namespace gridspace::relay
