// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"
#include "agents/relay/functions/inverse_curve.hpp"

#include <optional>

namespace gridspace::relay {

/// Which currents are compared with the setting.
enum class CurrentOf : std::uint8_t {
    phases,
    residual, ///< 3 I0
    negative_sequence,
};
[[nodiscard]] Abc current_of(CurrentOf what, Measurement const& m);
/// current_a of each phase, or of the one that there is.
[[nodiscard]] std::span<MeasuredQuantity const> currents_of(CurrentOf what);
void measure_currents(CurrentOf what, Measurement const& m, std::span<double> out);

/// A function that gives direction (RDIR), and which one is wanted.
struct Direction {
    std::optional<std::size_t> of; ///< none: every direction
    bool forward{true};
    [[nodiscard]] std::uint8_t phases(FunctionInput const& input) const;
};

struct PtocParams {
    double rate_hz{4800};
    CurrentOf measures{CurrentOf::phases};
    Direction direction;
    Curve curve{Curve::definite_time};
    double pickup_a{0};
    double dropout_ratio{0.95};
    double time_multiplier{1}; ///< of a curve
    double delay_s{0};         ///< definite_time
    double minimum_s{0};       ///< of a curve: it operates no sooner
    enum class Reset { instantaneous, definite_time, dependent } reset{Reset::instantaneous};
    double reset_s{0}; ///< definite_time
};

/// Time overcurrent (51): IEC 60255-151 and IEEE C37.112, each phase for itself. The time of a curve is integrated,
/// so that it follows a current that changes: operates when the integral of dt / t(G) reaches 1 (IEC 60255-151,
/// equation 2).
class Ptoc final : public Function {
  public:
    explicit Ptoc(PtocParams const& params);
    [[nodiscard]] PtocParams const& params() const { return params_; }
    [[nodiscard]] std::uint8_t needs() const override { return kCurrents; }
    FunctionState step(FunctionInput const& input) override;
    void reset() override;
    [[nodiscard]] std::span<MeasuredQuantity const> quantities() const override {
        return currents_of(params_.measures);
    }
    void measure(Measurement const& m, std::span<double> out) const override {
        measure_currents(params_.measures, m, out);
    }

  private:
    struct Phase {
        double travelled{0}; ///< share of the operate time; of a reset, what is left of it
        std::int64_t since{0}, below{0};
        bool started{false};
    };
    [[nodiscard]] bool runs(Phase& phase, double current_a) const;
    void rests(Phase& phase, double current_a) const;

    PtocParams params_;
    std::int64_t delay_, minimum_, reset_samples_;
    std::array<Phase, 3> phases_{};
};

struct PiocParams {
    double rate_hz{4800};
    CurrentOf measures{CurrentOf::phases};
    Direction direction;
    double pickup_a{0};
    double dropout_ratio{0.95};
    std::int64_t confirm_samples{1}; ///< above the setting in a row
};

/// Instantaneous overcurrent (50): the phasor's magnitude above the setting.
class Pioc final : public Function {
  public:
    explicit Pioc(PiocParams const& params) : params_{params} {}
    [[nodiscard]] PiocParams const& params() const { return params_; }
    [[nodiscard]] std::uint8_t needs() const override { return kCurrents; }
    FunctionState step(FunctionInput const& input) override;
    void reset() override { confirmed_ = {}; }
    [[nodiscard]] std::span<MeasuredQuantity const> quantities() const override {
        return currents_of(params_.measures);
    }
    void measure(Measurement const& m, std::span<double> out) const override {
        measure_currents(params_.measures, m, out);
    }

  private:
    PiocParams params_;
    std::array<std::int64_t, 3> confirmed_{};
};

} // namespace gridspace::relay
