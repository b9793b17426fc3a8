// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/overcurrent.hpp"

#include "agents/relay/functions/breaker_failure.hpp"
#include "agents/relay/functions/direction.hpp"
#include "tests/unit/relay/functions/signals.hpp"

#include <gtest/gtest.h>
#include <tuple>

namespace gridspace::relay {
namespace {

PtocParams curve(Curve of, double time_multiplier = 1) {
    PtocParams p;
    p.curve = of;
    p.pickup_a = 100;
    p.time_multiplier = time_multiplier;
    return p;
}

Measurement current(double a) {
    return measurement({Complex{a, 0}, 0, 0});
}

/// Times as they stand in relay manuals for a time multiplier of 1, in seconds at 2, 5 and 10 times the setting.
TEST(Ptoc, OperatesAtTheTimesOfTheStandard) {
    for (auto const& [of, at2, at5, at10] : {std::tuple{Curve::iec_normal_inverse, 10.029, 4.280, 2.971},
                                             {Curve::iec_very_inverse, 13.5, 3.375, 1.5},
                                             {Curve::iec_extremely_inverse, 26.667, 3.333, 0.8081},
                                             {Curve::ieee_moderately_inverse, 3.803, 1.688, 1.207},
                                             {Curve::ieee_very_inverse, 7.028, 1.308, 0.6891},
                                             {Curve::ieee_extremely_inverse, 9.522, 1.297, 0.4065}}) {
        for (auto const& [ratio, expected] : {std::pair{2.0, at2}, {5.0, at5}, {10.0, at10}}) {
            Ptoc sut{curve(of)};
            // Class E 2.5 of a relay would be 2.5 %; what is computed is held to the digits of the table and a sample.
            EXPECT_NEAR(time_to_operate(sut, current(ratio * 100), 30), expected, 5e-4 * expected + 1 / kRateHz)
                << static_cast<int>(of) << " at " << ratio;
        }
    }
}

TEST(Ptoc, GoesNoFasterBeyondTwentyTimesTheSetting) {
    Ptoc at{curve(Curve::iec_normal_inverse)}, beyond{curve(Curve::iec_normal_inverse)};
    EXPECT_EQ(time_to_operate(at, current(2000), 5), time_to_operate(beyond, current(9000), 5));
}

TEST(Ptoc, DoesNotStartJustBelowTheSettingAndOperatesJustAbove) {
    PtocParams p;
    p.pickup_a = 100;
    p.delay_s = 0.3;
    Ptoc below{p}, above{p};
    EXPECT_FALSE(after(below, current(99.9), 10).str);
    EXPECT_NEAR(time_to_operate(above, current(100.1), 10), 0.3, 1 / kRateHz);
}

TEST(Ptoc, IntegratesACurrentThatChanges) {
    Ptoc sut{curve(Curve::iec_very_inverse)};
    EXPECT_FALSE(after(sut, current(200), 6.75 - 1.5 / kRateHz).op);        // half of 13.5 s
    EXPECT_NEAR(time_to_operate(sut, current(1000), 5), 0.75, 2 / kRateHz); // half of 1.5 s
}

TEST(Ptoc, ResetsAsItsCharacteristicSays) {
    using Reset = PtocParams::Reset;
    for (auto const& [reset, left_s] : {std::pair{Reset::instantaneous, 1.308}, {Reset::definite_time, 0.654}}) {
        PtocParams p = curve(Curve::ieee_very_inverse);
        p.reset = reset;
        p.reset_s = 0.5;
        Ptoc sut{p};
        (void)after(sut, current(500), 0.654); // half of the way
        (void)after(sut, current(50), 0.4);
        EXPECT_NEAR(time_to_operate(sut, current(500), 5), left_s, 2e-3);
    }
    PtocParams p = curve(Curve::ieee_very_inverse);
    p.reset = Reset::dependent;
    Ptoc sut{p};
    (void)after(sut, current(500), 0.654);
    (void)after(sut, current(0), 5.4); // a quarter of the 21.6 s in which it falls from 1 to 0
    EXPECT_NEAR(time_to_operate(sut, current(500), 5), 0.75 * 1.308, 2e-3);
}

TEST(Ptoc, MeasuresResidualCurrentAndNotTheLoad) {
    PtocParams p;
    p.pickup_a = 20;
    p.measures = CurrentOf::residual;
    Ptoc load{p}, earth{p};
    EXPECT_FALSE(after(load, measurement(balanced(400)), 1).str);
    EXPECT_TRUE(after(earth, measurement({Complex{421, 0}, 400.0 * kTurnBack, 400.0 * kTurn}), 1).op); // 3 I0 = 21 A
}

TEST(Pioc, OperatesAboveTheSettingOnlyAndAfterAsManySamplesAsAreAskedFor) {
    PiocParams p;
    p.pickup_a = 1000;
    p.confirm_samples = 3;
    Pioc sut{p}, other{p};
    EXPECT_FALSE(after(other, current(999), 1).op);
    EXPECT_EQ(time_to_operate(sut, current(1001), 1), 2 / kRateHz);
}

/// A directional function and an overcurrent that asks it.
bool operates(Polarisation polarisation, Measurement const& m, bool forward, double angle_deg = 60) {
    RdirParams d;
    d.polarisation = polarisation;
    d.characteristic_angle_deg = angle_deg;
    Rdir rdir{d};
    PiocParams p;
    p.pickup_a = 100;
    p.direction = {0, forward};
    Pioc pioc{p};
    std::array<FunctionState, 1> states{};
    states[0] = rdir.step({m, states, false});
    return pioc.step({m, states, false}).op;
}

TEST(Rdir, TellsForwardFromReverseByPositiveSequenceAndCrossPolarisation) {
    for (Polarisation const by : {Polarisation::positive_sequence, Polarisation::cross}) {
        for (double const lag : {60.0, -20.0, 140.0}) { // on the characteristic angle, and 80 degrees to both sides
            Measurement const ahead = measurement(balanced(polar(500, -lag)), balanced(60));
            Measurement const behind = measurement(balanced(polar(500, 180 - lag)), balanced(60));
            EXPECT_TRUE(operates(by, ahead, true));
            EXPECT_FALSE(operates(by, behind, true));
            EXPECT_TRUE(operates(by, behind, false));
            EXPECT_FALSE(operates(by, ahead, false));
        }
        for (double const lag : {60 + 86.0, 60 - 86.0}) { // just outside of the sector of 85 degrees
            Measurement const beside = measurement(balanced(polar(500, -lag)), balanced(60));
            EXPECT_FALSE(operates(by, beside, true));
            EXPECT_FALSE(operates(by, beside, false));
        }
    }
}

TEST(Rdir, FindsAnEarthFaultWhoseOwnVoltageIsGoneByTheOthers) {
    Phasors v = balanced(100);
    v[0] = 0;
    EXPECT_TRUE(operates(Polarisation::cross, measurement({polar(500, -75), 0, 0}, v), true));
    EXPECT_FALSE(operates(Polarisation::cross, measurement({polar(500, 105), 0, 0}, v), true));
    // The source behind gives V2 = -Z2 I2 and V0 = -Z0 I0.
    for (Polarisation const by : {Polarisation::negative_sequence, Polarisation::zero_sequence}) {
        EXPECT_TRUE(operates(by, measurement({polar(500, -75), 0, 0}, v), true));
        EXPECT_FALSE(operates(by, measurement({polar(500, 105), 0, 0}, v), true));
    }
}

TEST(Rbrf, OperatesWhenCurrentFlowsAfterTheDelayAndNotWhenTheBreakerOpens) {
    RbrfParams p;
    p.pickup_a = 20;
    p.delay_s = 0.15;
    Rbrf fails{p}, opens{p}, idle{p};
    EXPECT_NEAR(time_to_operate(fails, current(500), 1, true), 0.15, 1 / kRateHz);
    (void)after(opens, current(500), 0.14, true);
    EXPECT_FALSE(after(opens, current(5), 1, true).op);
    EXPECT_FALSE(after(idle, current(500), 1, false).op); // without a trip
}

} // namespace
} // namespace gridspace::relay
