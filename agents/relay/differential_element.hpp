// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/common/line_sample.hpp"
#include "common/rational.hpp"
#include "common/result.hpp"

#include <cstdint>
#include <vector>

namespace gridspace::relay {

struct ElementParams {
    enum class Kind {
        rms,    ///< Eq. (5) and (6) as published: the difference of two RMS magnitudes. Blind to the angle between the
                ///< ends.
        phasor, ///< full-cycle DFT of both ends; operates on |I_from + I_to| (both into the line), restrained
    };
    Kind kind{Kind::phasor};
    int samples_per_cycle{80};
    int window_samples{80};
    double pickup_a{0};       ///< RMS, primary
    double slope_percent{0};  ///< phasor: of the restraint current
    double slope2_percent{0}; ///< phasor: above slope2_from_a; 0: one slope only
    double slope2_from_a{0};  ///< phasor: restraint current at which the second slope starts
};

/// The samples in `cycles` cycles; an error when that is not a whole number, because every windowed magnitude would
/// then ripple at the fundamental.
[[nodiscard]] Result<int> whole_samples(Rational rate_hz, Rational frequency_hz, Rational cycles);

/// What the differential current has to reach at a restraint current, by pickup and slopes; RMS amperes.
[[nodiscard]] double operating_current_a(ElementParams const& params, double restraint_a);

/// Magnitudes over one window; RMS amperes.
struct ElementValues {
    Abc from_a{}, to_a{};
    Abc differential_a{};
    Abc restraint_a{};             ///< mean of the two magnitudes
    Abc operate_at_a{};            ///< what the differential current has to reach
    std::uint8_t pickup_phases{0}; ///< bit 0: a, 1: b, 2: c

    friend bool operator==(ElementValues const&, ElementValues const&) = default;
};

/// A sliding window over both ends of a line. Currents are given into the line. No allocation after construction.
///
/// Sums are formed anew for each sample, oldest first: a running sum would keep the rounding of a 1e9 A spike for ever.
class DifferentialElement {
  public:
    explicit DifferentialElement(ElementParams const& params);

    void push(Abc const& from_into_a, Abc const& to_into_a);
    /// Forgets all samples.
    void clear() { filled_ = 0; }
    [[nodiscard]] bool full() const { return filled_ == params_.window_samples; }

    /// The magnitudes of the window that ends with the newest sample. Only when full().
    [[nodiscard]] ElementValues evaluate() const;

    [[nodiscard]] ElementParams const& params() const { return params_; }

  private:
    using Row = std::array<double, 6>; ///< from a b c, to a b c

    [[nodiscard]] ElementValues evaluate_rms(Row const* window) const;
    [[nodiscard]] ElementValues evaluate_phasor(Row const* window) const;
    void decide(ElementValues& v) const;

    ElementParams params_;
    std::vector<Row> rows_; ///< the window twice, so that the newest samples always lie in one piece
    std::vector<double> cos_, sin_;
    int next_{0}, filled_{0};
};

} // namespace gridspace::relay
