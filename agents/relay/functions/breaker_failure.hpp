// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/function.hpp"

#include <vector>

namespace gridspace::relay {

struct RbrfParams {
    double rate_hz{4800};
    std::vector<std::size_t> initiated_by; ///< functions; none: the relay's trip
    double pickup_a{0};                    ///< current that says that a pole is still closed
    double delay_s{0.15};                  ///< from the trip on
};

/// Breaker failure (50BF, RBRF): still current in a pole so long after a trip (IEEE C37.119-2016, 7.2: current
/// supervised, no seal of the current). `op` is for the breakers around.
class Rbrf final : public Function {
  public:
    explicit Rbrf(RbrfParams params)
        : params_{std::move(params)}, delay_{samples_of(params_.delay_s, params_.rate_hz)} {}
    [[nodiscard]] std::uint8_t needs() const override { return kCurrents; }
    FunctionState step(FunctionInput const& input) override {
        bool initiated = params_.initiated_by.empty() && input.trip;
        for (std::size_t const f : params_.initiated_by) {
            initiated = initiated || input.others[f].op;
        }
        // A function that tripped falls off with the current it saw; what was begun goes on while a pole conducts.
        Abc const current = magnitudes(input.measured.i);
        FunctionState out;
        for (std::size_t p = 0; p < 3; ++p) {
            out.phases = static_cast<std::uint8_t>(out.phases | (current[p] > params_.pickup_a ? 1U << p : 0U));
        }
        running_ = (running_ || initiated) && out.phases != 0;
        out.str = running_;
        out.op = delay_.step(running_);
        out.phases = running_ ? out.phases : std::uint8_t{0};
        return out;
    }
    void reset() override {
        running_ = false;
        delay_.reset();
    }

  private:
    RbrfParams params_;
    DefiniteTimer delay_;
    bool running_{false};
};

} // namespace gridspace::relay
