// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/distance.hpp"

#include "tests/unit/relay/functions/signals.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <gtest/gtest.h>

namespace gridspace::relay {
namespace {

using Characteristic = PdisParams::Characteristic;

PdisParams zone(Characteristic characteristic = Characteristic::mho) {
    PdisParams p;
    p.characteristic = characteristic;
    p.reach_ohm = 8;
    p.angle_deg = 75;
    p.r_ohm = 4;
    p.r_earth_ohm = 6;
    return p;
}

/// A balanced fault that the relay sees as `z`.
Measurement seen_as(Complex z) {
    return measurement(balanced(100), balanced(100.0 * z));
}

bool starts(PdisParams const& p, Measurement const& m) {
    Pdis sut{p};
    return sut.step({m, {}, false}).str;
}

TEST(Pdis, TheMhoIsTheCircleOverItsReach) {
    for (double const angle : {75.0, 45.0, 105.0, 20.0, 130.0}) {
        double const boundary = 8 * std::cos((angle - 75) * std::numbers::pi / 180);
        EXPECT_TRUE(starts(zone(), seen_as(polar(boundary * 0.999, angle)))) << angle;
        EXPECT_FALSE(starts(zone(), seen_as(polar(boundary * 1.001, angle)))) << angle;
    }
    EXPECT_FALSE(starts(zone(), seen_as(polar(0.5, 75 - 180)))); // behind
    PdisParams reverse = zone();
    reverse.forward = false;
    Measurement behind = seen_as(polar(0.5, 75 - 180));
    EXPECT_TRUE(starts(reverse, behind));
    EXPECT_FALSE(starts(reverse, seen_as(polar(0.5, 75))));
}

TEST(Pdis, TheQuadrilateralEndsAtItsReactanceAndItsResistance) {
    PdisParams const p = zone(Characteristic::quadrilateral);
    double const x = 8 * std::sin(75 * std::numbers::pi / 180), slope = std::tan(75 * std::numbers::pi / 180);
    for (double const share : {0.2, 0.5, 0.9}) {
        double const on_line = share * x / slope;
        EXPECT_TRUE(starts(p, seen_as({on_line + 3.99, share * x})));
        EXPECT_FALSE(starts(p, seen_as({on_line + 4.01, share * x})));
    }
    EXPECT_TRUE(starts(p, seen_as({1, 0.999 * x})));
    EXPECT_FALSE(starts(p, seen_as({1, 1.001 * x})));
    EXPECT_FALSE(starts(p, seen_as(polar(2, 75 - 180)))); // behind
}

/// A source of 100 V behind zs, a line with z0 = 3 z1, a solid fault at z1 of it; what the relay at its begin measures,
/// by symmetrical components.
struct Faulted {
    Complex source{0.5, 5}, source_zero{0.3, 3}, z1, z0;
    [[nodiscard]] Measurement phase_to_earth() const {
        Complex const i = 100.0 / (2.0 * (source + z1) + source_zero + z0);
        return measured(i, i, i);
    }
    [[nodiscard]] Measurement phases_b_and_c() const {
        Complex const i = 100.0 / (2.0 * (source + z1));
        return measured(i, -i, 0);
    }
    [[nodiscard]] Measurement b_and_c_to_earth() const {
        Complex const one = source + z1, zero = source_zero + z0;
        Complex const i = 100.0 / (one + one * zero / (one + zero));
        return measured(i, -i * zero / (one + zero), -i * one / (one + zero));
    }
    [[nodiscard]] Measurement measured(Complex i1, Complex i2, Complex i0) const {
        auto const phases = [](Complex one, Complex two, Complex zero) {
            return Phasors{zero + one + two, zero + kTurnBack * one + kTurn * two,
                           zero + kTurn * one + kTurnBack * two};
        };
        Measurement m = measurement(phases(i1, i2, i0), phases(100.0 - source * i1, -source * i2, -source_zero * i0));
        m.polarising = 100; // before the fault
        return m;
    }
};

TEST(Pdis, MeasuresThePlaceOfFaultsOfEveryKindWithK0) {
    for (Characteristic const c : {Characteristic::mho, Characteristic::quadrilateral}) {
        PdisParams p = zone(c);
        p.k0 = 2.0 / 3.0; // z0 = 3 z1
        p.minimum_residual_a = 0.5;
        for (double const at : {0.1, 0.5, 0.98}) {
            Faulted f;
            f.z1 = polar(8 * at, 75);
            f.z0 = 3.0 * f.z1;
            for (Measurement const& m : {f.phase_to_earth(), f.phases_b_and_c(), f.b_and_c_to_earth()}) {
                EXPECT_TRUE(starts(p, m)) << at;
            }
        }
        Faulted beyond;
        beyond.z1 = polar(8 * 1.02, 75);
        beyond.z0 = 3.0 * beyond.z1;
        for (Measurement const& m : {beyond.phase_to_earth(), beyond.phases_b_and_c(), beyond.b_and_c_to_earth()}) {
            EXPECT_FALSE(starts(p, m));
        }
        // The control: without k0 the loop to earth reaches less far.
        PdisParams without = p;
        without.k0 = 0;
        Faulted near_end;
        near_end.z1 = polar(8 * 0.9, 75);
        near_end.z0 = 3.0 * near_end.z1;
        EXPECT_FALSE(starts(without, near_end.phase_to_earth()));
    }
}

TEST(Pdis, TellsTheImpedanceUpToTheFaultOfTheLoopsThatCountAndNoOther) {
    PdisParams p = zone();
    p.k0 = 2.0 / 3.0; // z0 = 3 z1
    p.minimum_residual_a = 0.5;
    Pdis const sut{p};
    ASSERT_EQ(sut.quantities().size(), 12U);
    EXPECT_EQ(sut.quantities()[4].name, "r_ohm.bc");
    EXPECT_EQ(sut.quantities()[6].name, "x_ohm.a");
    std::array<double, 12> out{};
    for (double const at : {0.2, 0.6, 1.4}) {
        Faulted f;
        f.z1 = polar(8 * at, 75);
        f.z0 = 3.0 * f.z1;
        sut.measure(f.phase_to_earth(), out);
        EXPECT_NEAR(out[0], f.z1.real(), 1e-9) << at;
        EXPECT_NEAR(out[6], f.z1.imag(), 1e-9) << at;
        EXPECT_TRUE(std::isnan(out[1]) && std::isnan(out[7]) && std::isnan(out[3])) << "b and ab are not faulted";
        sut.measure(f.phases_b_and_c(), out);
        EXPECT_NEAR(out[4], f.z1.real(), 1e-9) << at;
        EXPECT_NEAR(out[10], f.z1.imag(), 1e-9) << at;
        EXPECT_TRUE(std::isnan(out[0])) << "no loop to earth counts without residual current";
    }
    p.minimum_a = 1e6;
    Pdis{p}.measure(seen_as({1, 2}), out);
    EXPECT_TRUE(std::ranges::all_of(out, [](double v) { return std::isnan(v); })) << "no loop carries so much";
}

TEST(Pdis, NamesTheFaultedPhases) {
    Faulted f;
    f.z1 = polar(4, 75);
    f.z0 = 3.0 * f.z1;
    PdisParams p = zone();
    p.k0 = 2.0 / 3.0;
    p.minimum_residual_a = 0.5;
    Pdis sut{p};
    EXPECT_EQ(sut.step({f.phase_to_earth(), {}, false}).phases, 1);
    EXPECT_EQ(sut.step({f.phases_b_and_c(), {}, false}).phases, 6);
    EXPECT_EQ(sut.step({f.b_and_c_to_earth(), {}, false}).phases, 6);
}

TEST(Pdis, StaysDirectionalWhenTheVoltageIsGone) {
    Measurement close = measurement(balanced(polar(100, -75)), balanced(0));
    close.polarising = 60; // remembered
    EXPECT_TRUE(starts(zone(), close));
    Measurement behind = measurement(balanced(polar(100, 105)), balanced(0));
    behind.polarising = 60;
    EXPECT_FALSE(starts(zone(), behind));
}

TEST(Pdis, WaitsForItsZonesTime) {
    PdisParams p = zone();
    p.confirm_s = 5e-3;
    p.delay_s = 0.3;
    Pdis sut{p};
    EXPECT_NEAR(time_to_operate(sut, seen_as(polar(4, 75)), 1), 0.305, 2 / kRateHz);
    EXPECT_FALSE(sut.step({seen_as(polar(40, 30)), {}, false}).str); // load
}

} // namespace
} // namespace gridspace::relay
