// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/load/load.hpp"

#include <cmath>
#include <gtest/gtest.h>

namespace gridspace::sim {
namespace {

TEST(LoadFactor, IsOneAtNominalVoltageForEveryModel) {
    for (LoadModel const model :
         {LoadModel::constant_power, LoadModel::constant_current, LoadModel::constant_impedance, LoadModel::exponential,
          LoadModel::zip, LoadModel::dc_resistive, LoadModel::dc_constant_power}) {
        Load load;
        load.model = model;
        load.exponent_p = 1.3;
        load.exponent_q = 2;
        load.zip_p = {0.2, 0.3, 0.5};
        EXPECT_DOUBLE_EQ(load.factor(1).p, 1);
        EXPECT_DOUBLE_EQ(load.factor(1).q, 1);
    }
}

TEST(LoadFactor, SlopesAreTheDerivatives) {
    constexpr double kStep = 1e-6;
    for (LoadModel const model : {LoadModel::constant_power, LoadModel::constant_current, LoadModel::constant_impedance,
                                  LoadModel::exponential, LoadModel::zip, LoadModel::dc_constant_power}) {
        for (double const v : {0.3, 0.65, 0.95, 1.07}) {
            Load load;
            load.model = model;
            load.exponent_p = 1.3;
            load.exponent_q = 2.5;
            load.zip_p = {0.2, 0.3, 0.5};
            load.zip_q = {0.6, 0.3, 0.1};
            VoltagePower const at = load.factor(v);
            EXPECT_NEAR(at.dp_dv, (load.factor(v + kStep).p - load.factor(v - kStep).p) / (2 * kStep), 1e-6);
            EXPECT_NEAR(at.dq_dv, (load.factor(v + kStep).q - load.factor(v - kStep).q) / (2 * kStep), 1e-6);
        }
    }
}

TEST(LoadFactor, BecomesAConstantImpedanceBelowTheFloorWithoutAJump) {
    Load load;
    load.model = LoadModel::constant_power;
    EXPECT_DOUBLE_EQ(load.factor(0.35).p, 0.25);
    EXPECT_NEAR(load.factor(0.7 - 1e-9).p, load.factor(0.7 + 1e-9).p, 1e-8);
    EXPECT_DOUBLE_EQ(load.factor(0).p, 0);
}

} // namespace
} // namespace gridspace::sim
