// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/instrument_data.hpp"

#include <array>
#include <complex>

namespace gridspace::sim::emt {

/// Three current or voltage transformers: core, filter, ratio error, quantum, in this order. CT: flux' = R i_s with
/// i_s = i_p / turns - i_m(flux), R the sum of winding and burden. VT: flux' = v - R i_m(flux), which is the output.
/// The cores by backward Euler, which keeps a saturated core quiet; the filter by the trapezoidal rule.
class InstrumentTransformer {
  public:
    explicit InstrumentTransformer(InstrumentData const& data) : d_{data} {}

    /// Whether it has a memory, and step() must be called.
    [[nodiscard]] bool dynamic() const { return d_.core || d_.cutoff_hz > 0; }
    [[nodiscard]] bool saturates() const { return d_.core.has_value(); }
    /// Steady state for peak phasors by phase, from which steps of h follow.
    void start(std::array<std::complex<double>, 3> const& input, double w, double h);
    /// Values at the end of a step of h.
    void step(std::array<double, 3> const& input, double h);
    /// What the secondary shows, in primary units.
    [[nodiscard]] double value(std::size_t phase) const { return shown(phases_[phase].out); }
    /// The same of something without a memory.
    [[nodiscard]] double shown(double input) const;
    /// Flux linkage, of that at the knee.
    [[nodiscard]] double flux_pu(std::size_t phase) const { return phases_[phase].flux / d_.core->slopes.knee; }

  private:
    struct Phase {
        double flux{0};
        double in{0}, x1{0}, x2{0}; ///< of the filter
        double out{0};
    };
    InstrumentData d_;
    std::array<Phase, 3> phases_{};
};

} // namespace gridspace::sim::emt
