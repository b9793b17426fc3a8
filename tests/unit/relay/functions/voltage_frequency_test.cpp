// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/frequency.hpp"
#include "agents/relay/functions/voltage.hpp"
#include "tests/unit/relay/functions/signals.hpp"

#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

Measurement voltage(double a, double b, double c) {
    return measurement({}, {Complex{a, 0}, b * kTurnBack, c * kTurn});
}

VoltageParams voltage_params(bool over, double pickup_v) {
    VoltageParams p;
    p.over = over;
    p.pickup_v = pickup_v;
    p.delay_s = 0.2;
    return p;
}

TEST(VoltageFunction, OperatesBeyondTheSettingAfterTheDelayAndNotJustInside) {
    VoltageFunction under{voltage_params(false, 80)}, over{voltage_params(true, 110)};
    EXPECT_NEAR(time_to_operate(under, voltage(100, 79.9, 100), 1), 0.2, 1 / kRateHz);
    EXPECT_NEAR(time_to_operate(over, voltage(100, 100, 110.1), 1), 0.2, 1 / kRateHz);
    VoltageFunction not_under{voltage_params(false, 80)}, not_over{voltage_params(true, 110)};
    EXPECT_FALSE(after(not_under, voltage(100, 80.1, 100), 1).str);
    EXPECT_FALSE(after(not_over, voltage(100, 100, 109.9), 1).str);
}

TEST(VoltageFunction, DropsOutWithAHysteresis) {
    VoltageFunction over{voltage_params(true, 100)};
    (void)after(over, voltage(101, 90, 90), 1);
    EXPECT_TRUE(over.step({voltage(98.1, 90, 90), {}, false}).op);
    EXPECT_FALSE(over.step({voltage(97.9, 90, 90), {}, false}).str);
}

TEST(VoltageFunction, OfAllPhasesOrOfALineThatIsOff) {
    VoltageParams p = voltage_params(false, 80);
    p.all_phases = true;
    p.block_below_v = 20;
    VoltageFunction sut{p};
    EXPECT_FALSE(after(sut, voltage(100, 50, 50), 1).str);
    EXPECT_TRUE(after(sut, voltage(50, 50, 50), 1).op);
    EXPECT_FALSE(after(sut, voltage(0, 1, 0), 1).str);
}

TEST(VoltageFunction, TheInverseTimeFollowsTheVoltage) {
    VoltageParams p = voltage_params(true, 100);
    p.inverse = true;
    p.time_multiplier = 0.5;
    VoltageFunction at120{p};
    EXPECT_NEAR(time_to_operate(at120, voltage(120, 100, 100), 10), 0.5 / 0.2, 2e-3);
    p.over = false;
    VoltageFunction at60{p};
    EXPECT_NEAR(time_to_operate(at60, voltage(60, 60, 60), 10), 0.5 / 0.4, 2e-3);
}

TEST(VoltageFunction, OfPhasesToEachOtherOfTheSequenceAndOfTheResidual) {
    for (auto const& [of, above, below] :
         {std::tuple{VoltageOf::phase_to_phase, 101.0, 99.0}, {VoltageOf::positive_sequence, 101.0, 99.0}}) {
        VoltageParams p = voltage_params(true, of == VoltageOf::phase_to_phase ? 100 * std::sqrt(3.0) : 100);
        p.measures = of;
        VoltageFunction up{p}, down{p};
        EXPECT_TRUE(after(up, voltage(above, above, above), 1).op);
        EXPECT_FALSE(after(down, voltage(below, below, below), 1).str);
    }
    VoltageParams p = voltage_params(true, 50);
    p.measures = VoltageOf::residual;
    VoltageFunction earth{p}, healthy{p};
    EXPECT_TRUE(after(earth, voltage(40, 100, 100), 1).op); // 3 V0 = 60 V
    EXPECT_FALSE(after(healthy, voltage(100, 100, 100), 1).str);
}

TEST(FrequencyFunction, OperatesBeyondTheSettingAfterTheDelayAndNotJustInside) {
    using Kind = FrequencyFunctionParams::Kind;
    for (auto const& [kind, setting, inside, beyond] : {std::tuple{Kind::under, 49.0, 49.01, 48.99},
                                                        {Kind::over, 51.0, 50.99, 51.01},
                                                        {Kind::rate, -1.0, -0.99, -1.01},
                                                        {Kind::rate, 0.5, 0.49, 0.51}}) {
        FrequencyFunctionParams p;
        p.kind = kind;
        p.pickup_hz = p.pickup_hz_per_s = setting;
        p.delay_s = 0.1;
        FrequencyFunction yes{p}, no{p};
        Measurement m;
        m.frequency_hz = m.rocof_hz_per_s = beyond;
        EXPECT_NEAR(time_to_operate(yes, m, 1), 0.1, 1 / kRateHz);
        m.frequency_hz = m.rocof_hz_per_s = inside;
        EXPECT_FALSE(after(no, m, 1).str);
    }
}

} // namespace
} // namespace gridspace::relay
