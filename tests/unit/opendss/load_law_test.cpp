// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/consumer.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace gridspace::opendss {
namespace {

LoadLaw law_of(int model) {
    LoadLaw law;
    law.model = model;
    law.power_va = {1000, 500};
    law.nominal_v = 240;
    law.fixed_var = 400;
    law.exponent_p = 0.8;
    law.exponent_q = 3;
    law.shares = {0.2, 0.3, 0.5, 0.6, 0.3, 0.1, 0};
    return law;
}

Complex power(LoadLaw const& law, double pu) {
    Complex const v = std::polar(pu * law.nominal_v, 0.7);
    return v * std::conj(law.current(v));
}

TEST(LoadLaw, DrawsWhatItsModelSaysWithinItsRange) {
    double const u = 0.97;
    struct Row {
        int model;
        double p, q;
    };
    for (Row const row : {Row{1, 1000, 500}, Row{2, 1000 * u * u, 500 * u * u}, Row{3, 1000, 500 * u * u},
                          Row{4, 1000 * std::pow(u, 0.8), 500 * u * u * u}, Row{5, 1000 * u, 500 * u},
                          Row{6, 1000, 400}, Row{7, 1000, 400 * u * u},
                          Row{8, 1000 * (0.2 * u * u + 0.3 * u + 0.5), 500 * (0.6 * u * u + 0.3 * u + 0.1)}}) {
        Complex const s = power(law_of(row.model), u);
        EXPECT_NEAR(s.real(), row.p, 1e-9) << row.model;
        EXPECT_NEAR(s.imag(), row.q, 1e-9) << row.model;
    }
}

TEST(LoadLaw, IsAnImpedanceAboveItsRange) {
    for (int const model : {1, 3, 4, 5, 8}) {
        Complex const at_limit = power(law_of(model), 1.2) / power(law_of(model), 1.3);
        EXPECT_NEAR(at_limit.real(), 1.2 * 1.2 / 1.3 / 1.3, 1e-12) << model;
    }
    EXPECT_NEAR(power(law_of(1), 1.0500001).real(), 1000, 1e-3); // without a step
}

TEST(LoadLaw, OfAConstantCurrentGoesOverWithoutAStepWhereItsRangeEnds) {
    LoadLaw const sut = law_of(5);
    for (double const edge : {0.5, 0.95, 1.05}) {
        EXPECT_NEAR(std::abs(power(sut, edge + 1e-9) - power(sut, edge - 1e-9)), 0, 1e-3) << edge;
    }
    // Nominal current at the upper limit, and from there an impedance; a line to nominal current at the lower.
    double const nominal_a = std::abs(sut.power_va) / sut.nominal_v;
    EXPECT_NEAR(std::abs(sut.current(1.26 * 240)), 1.2 * nominal_a, 1e-9);
    EXPECT_NEAR(std::abs(sut.current((0.5 + 0.95) / 2 * 240)), 0.75 * nominal_a, 1e-9);
}

TEST(LoadLaw, OfZipvTakesItsThreePartsOverByThemselves) {
    LoadLaw const sut = law_of(8);
    for (double const edge : {0.95, 1.05}) { // at Vlowpu all of it becomes an impedance, as in OpenDSS
        EXPECT_NEAR(std::abs(power(sut, edge + 1e-9) - power(sut, edge - 1e-9)), 0, 1e-3) << edge;
    }
    double const high = 1.2 * 1.2, z = high, i = high / 1.05, p = high / 1.05 / 1.05;
    EXPECT_NEAR(power(sut, 1.2).real(), 1000 * (0.2 * z + 0.3 * i + 0.5 * p), 1e-9);
    EXPECT_NEAR(power(sut, 1.2).imag(), 500 * (0.6 * z + 0.3 * i + 0.1 * p), 1e-9);
    double const u = (0.5 + 0.95) / 2, current_i = 0.75, current_p = (0.5 + 1 / 0.95) / 2;
    EXPECT_NEAR(power(sut, u).real(), 1000 * (0.2 * u * u + 0.3 * u * current_i + 0.5 * u * current_p), 1e-9);
    EXPECT_NEAR(power(sut, 0.4).real(), 1000 * 0.4 * 0.4, 1e-9);
}

TEST(LoadLaw, GoesOverToItsNominalImpedanceBelowItsRangeWithoutAStep) {
    LoadLaw const sut = law_of(1);
    EXPECT_NEAR(power(sut, 0.95 + 1e-9).real(), power(sut, 0.95 - 1e-9).real(), 1e-3);
    EXPECT_NEAR(power(sut, 0.5 + 1e-9).real(), 1000 * 0.25, 1e-3);
    EXPECT_NEAR(power(sut, 0.3).real(), 1000 * 0.09, 1e-9);
    // Half way between the limits the current is half way, too.
    double const middle = (0.5 + 0.95) / 2;
    EXPECT_NEAR(std::abs(sut.current(middle * 240)),
                (std::abs(sut.current(120)) + std::abs(sut.current(0.95 * 240))) / 2, 1e-9);
}

TEST(LoadLaw, OfAGeneratorStaysAnImpedanceDownToNothing) {
    LoadLaw sut = law_of(1);
    sut.low_pu = 0;
    sut.least_pu = 0.9;
    EXPECT_NEAR(power(sut, 0.45).real(), 250, 1e-9);
    EXPECT_EQ(sut.current({}), Complex{});
}

} // namespace
} // namespace gridspace::opendss
