// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

namespace gridspace::relay {

struct FrequencyFunctionParams {
    double rate_hz{4800};
    enum class Kind { under, over, rate } kind{Kind::under}; ///< PTUF, PTOF, PFRC
    double pickup_hz{0};                                     ///< under, over
    double pickup_hz_per_s{0};                               ///< rate: negative for a falling frequency
    double delay_s{0};
};

/// Under- and overfrequency and rate of change of frequency (81; PTUF, PTOF, PFRC) with definite time
/// (IEC 60255-181:2019, clause 5). Measured by FrequencyEstimator; without a voltage it is not available and they rest.
class FrequencyFunction final : public Function {
  public:
    explicit FrequencyFunction(FrequencyFunctionParams const& params)
        : params_{params}, delay_{samples_of(params.delay_s, params.rate_hz)} {}
    [[nodiscard]] std::uint8_t needs() const override {
        return params_.kind == FrequencyFunctionParams::Kind::rate ? kRocof : kFrequency;
    }
    FunctionState step(FunctionInput const& input) override {
        FunctionState out;
        out.str = is_beyond(input.measured);
        out.op = delay_.step(out.str);
        return out;
    }
    void reset() override { delay_.reset(); }

  private:
    [[nodiscard]] bool is_beyond(Measurement const& m) const {
        using Kind = FrequencyFunctionParams::Kind;
        if (params_.kind == Kind::rate) {
            return params_.pickup_hz_per_s < 0 ? m.rocof_hz_per_s < params_.pickup_hz_per_s
                                               : m.rocof_hz_per_s > params_.pickup_hz_per_s;
        }
        return params_.kind == Kind::under ? m.frequency_hz < params_.pickup_hz : m.frequency_hz > params_.pickup_hz;
    }

    FrequencyFunctionParams params_;
    DefiniteTimer delay_;
};

} // namespace gridspace::relay
