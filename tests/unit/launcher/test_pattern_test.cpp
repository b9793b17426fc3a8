// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/test_pattern.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>
#include <numbers>

namespace gridspace::wire {
namespace {

using iec61850::BasicType;
using iec61850::DataNode;
using iec61850::DataSet;
using iec61850::SvLayout;

/// The numbers of sample `index` by name; 60 Hz at 4800 Hz.
std::map<std::string, double> sample(DataSet const& set, std::int64_t index) {
    SvLayout const layout{set};
    std::vector<std::uint8_t> octets(layout.sample_octets());
    TestPattern{layout, 10'000, 60, 4800}.write(index, octets);
    std::map<std::string, double> out;
    for (std::size_t i = 0; i < layout.slots().size(); ++i) {
        if (is_number(layout.slots()[i].leaf.type)) {
            out[layout.slots()[i].leaf.name] = layout.read(i, octets).number();
        }
    }
    return out;
}

double phase(std::int64_t index, int of_three) {
    return 10'000 * std::cos(2 * std::numbers::pi * (static_cast<double>(index) / 80 - of_three / 3.0));
}

TEST(TestPattern, CurrentsAndVoltagesOf92LEAreBalancedAndTheirNeutralIsTheSum) {
    for (std::int64_t const index : {0, 7, 4799}) {
        auto const sut = sample(iec61850::data_set_92le(), index);
        ASSERT_EQ(sut.size(), 8U);
        for (char const quantity : {'I', 'V'}) {
            int of_three = 0;
            double sum = 0;
            for (char const letter : {'a', 'b', 'c'}) {
                double const value = sut.at({quantity, letter});
                EXPECT_NEAR(value, phase(index, of_three++), 1) << quantity << letter;
                sum += value;
            }
            EXPECT_NEAR(sut.at({quantity, 'n'}), sum, 2) << quantity;
        }
    }
}

TEST(TestPattern, OtherNumbersArePhasesInTheirOrder) {
    DataSet set;
    for (char const* name : {"x", "main", "y", "data"}) { // an n or a at an end does not make a phase
        set.members.push_back(DataNode::leaf(name, BasicType::float64));
    }
    auto const sut = sample(set, 7);
    EXPECT_NEAR(sut.at("x"), phase(7, 0), 1e-6);
    EXPECT_NEAR(sut.at("main"), phase(7, 1), 1e-6);
    EXPECT_NEAR(sut.at("y"), phase(7, 2), 1e-6);
    EXPECT_NEAR(sut.at("data"), phase(7, 0), 1e-6);
}

} // namespace
} // namespace gridspace::wire
