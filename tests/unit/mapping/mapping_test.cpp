// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/mapping.hpp"

#include <gmock/gmock.h>
#include <limits>

namespace gridspace::mapping {
namespace {

using namespace iec61850;
using testing::ElementsAre;
using testing::HasSubstr;

Rule rule(std::string from, std::string to) {
    Rule out;
    out.from = std::move(from);
    out.to = std::move(to);
    return out;
}

/// Maps one value of a type to another; the mistake instead, when there is one.
struct One {
    std::vector<Mistake> mistakes; // before the mapping, which writes to it
    Mapping mapping;

    One(Field const& from, Field const& to, Rule r = rule("a", "b"))
        : mapping{Mapping::compile({r}, {from}, {to}, mistakes)} {}
    Value operator()(Value in) {
        Value out;
        mapping.apply(std::span{&in, 1}, std::span{&out, 1});
        return out;
    }
};

TEST(Mapping, ScalesCurrentsIntoTheMilliamperesOf92LE) {
    One sut{{"a", BasicType::float32, 0, "A"}, {"b", BasicType::int32, 0, "mA"}};
    ASSERT_TRUE(sut.mistakes.empty());
    EXPECT_EQ(sut(Value::of(1.25F)), Value::integer(BasicType::int32, 1250));
    EXPECT_EQ(sut(Value::of(-0.0006F)), Value::integer(BasicType::int32, -1));
    EXPECT_EQ(sut.mapping.counters().saturated, 0U);
    EXPECT_EQ(sut(Value::of(3e6F)).as_signed(), std::numeric_limits<std::int32_t>::max());
    EXPECT_EQ(sut(Value::of(-3e6F)).as_signed(), std::numeric_limits<std::int32_t>::min());
    EXPECT_EQ(sut.mapping.counters().saturated, 2U);
    EXPECT_EQ(sut(Value::of(std::numeric_limits<float>::quiet_NaN())).as_signed(), 0);
    EXPECT_EQ(sut.mapping.counters().not_finite, 1U);
}

TEST(Mapping, AppliesScaleAndOffsetAfterTheUnits) {
    Rule r = rule("a", "b");
    r.scale = 2;
    r.offset = 1;
    One sut{{"a", BasicType::float64, 0, "kV"}, {"b", BasicType::float64, 0, "V"}, r};
    EXPECT_EQ(sut(Value::of(1.5)).number(), 3001);
}

TEST(Mapping, DoesNotIgnoreAUnitThatHasNothingToComeFrom) {
    Rule to_unit = rule("a", "b"), from_unit = rule("a", "b"), both = rule("a", "b");
    to_unit.to_unit = both.to_unit = "mA";
    from_unit.from_unit = both.from_unit = "kA";
    Field const a{"a", BasicType::float64}, b{"b", BasicType::int32};
    One const no_source{a, b, to_unit};
    ASSERT_EQ(no_source.mistakes.size(), 1U);
    EXPECT_EQ(no_source.mistakes[0].message, "'b' is in mA, and the unit of 'a' is not known");
    EXPECT_THAT(no_source.mistakes[0].hint, HasSubstr("from_unit"));
    EXPECT_FALSE(no_source.mistakes[0].about_to);
    One const no_target{a, b, from_unit};
    ASSERT_EQ(no_target.mistakes.size(), 1U);
    EXPECT_THAT(no_target.mistakes[0].hint, HasSubstr("to_unit"));
    EXPECT_TRUE((One{a, b, both}.mistakes.empty()));
    EXPECT_TRUE((One{{"a", BasicType::float64, 0, "A"}, b}.mistakes.empty())) << "nobody said a unit";
}

TEST(Mapping, KeepsWholeNumbersExactBeyondWhatADoubleHolds) {
    One sut{{"a", BasicType::int64}, {"b", BasicType::uint64}};
    EXPECT_EQ(sut(Value::integer(BasicType::int64, 9'007'199'254'740'993)).bits, 9'007'199'254'740'993U);
    EXPECT_EQ(sut(Value::integer(BasicType::int64, -1)).bits, 0U);
    EXPECT_EQ(sut.mapping.counters().saturated, 1U);
    One narrow{{"a", BasicType::uint64}, {"b", BasicType::int8}};
    EXPECT_EQ(narrow({BasicType::uint64, 0, 200, {}}).as_signed(), 127);
    EXPECT_EQ(narrow({BasicType::uint64, 0, 100, {}}).as_signed(), 100);
}

TEST(Mapping, TurnsATripIntoAPositionAndBack) {
    One open{{"a", BasicType::boolean}, {"b", BasicType::position}};
    EXPECT_EQ(to_string(open(Value::of(true))), "open");
    EXPECT_EQ(to_string(open(Value::of(false))), "closed");
    Rule r = rule("a", "b");
    r.true_is_open = false;
    One closed{{"a", BasicType::boolean}, {"b", BasicType::position}, r};
    EXPECT_EQ(to_string(closed(Value::of(true))), "closed");
    One back{{"a", BasicType::position}, {"b", BasicType::boolean}};
    EXPECT_TRUE(back({BasicType::position, 0, 1, {}}).boolean());
    for (std::uint64_t const other : {0U, 2U, 3U}) {
        EXPECT_FALSE(back({BasicType::position, 0, other, {}}).boolean()) << "neither intermediate nor bad is open";
    }
}

TEST(Mapping, ConvertsTimesQualitiesTextsAndConstants) {
    One time{{"a", BasicType::int64}, {"b", BasicType::timestamp}};
    EXPECT_EQ(time(Value::integer(BasicType::int64, 1'500'000'000)).time(), (UtcTime{1, 0x800000, 0x0A}));
    One nanoseconds{{"a", BasicType::timestamp}, {"b", BasicType::int64}};
    EXPECT_EQ(nanoseconds(Value::of(UtcTime{1, 0x800000, 0})).as_signed(), 1'500'000'000);
    One quality{{"a", BasicType::uint32}, {"b", BasicType::quality}};
    EXPECT_EQ(quality({BasicType::uint32, 0, 0x802, {}}), Value::quality(0x802));
    One text{{"a", BasicType::visible_string, 10}, {"b", BasicType::visible_string, 20}};
    EXPECT_EQ(to_string(text(Value::visible("abc"))), "abc");
    Rule r = rule("", "b");
    r.constant = Value::of(true);
    One constant{{"a", BasicType::boolean}, {"b", BasicType::boolean}, r};
    EXPECT_TRUE(constant(Value::of(false)).boolean());
}

TEST(Mapping, TreatsAQualityAsBitsAndNeverAsAQuantity) {
    Field const sampled{"b", BasicType::quality}, goose{"b", BasicType::quality, 13};
    for (std::uint64_t const bits : {0x2000U, 0x2003U, 0x2800U, 0x1FFFU}) {
        One to_sampled{{"a", BasicType::uint16}, sampled}, to_goose{{"a", BasicType::uint16}, goose},
            from_sampled{{"a", BasicType::quality}, goose},
            to_number{{"a", BasicType::quality}, {"b", BasicType::uint16}};
        EXPECT_EQ(to_sampled({BasicType::uint16, 0, bits, {}}).bits, bits) << "with 'derived'";
        EXPECT_EQ(to_goose({BasicType::uint16, 0, bits, {}}).bits, bits & 0x1FFF) << "validity and test are kept";
        EXPECT_EQ(from_sampled({BasicType::quality, 0, bits, {}}).bits, bits & 0x1FFF);
        EXPECT_EQ(to_number({BasicType::quality, 0, bits, {}}).bits, bits);
        EXPECT_EQ(to_sampled.mapping.counters().saturated + to_goose.mapping.counters().saturated, 0U);
    }
    One no_quality{{"a", BasicType::uint32}, sampled};
    EXPECT_EQ(no_quality({BasicType::uint32, 0, 0x1'0802, {}}).bits, 0x802U);
    EXPECT_EQ(no_quality.mapping.counters().saturated, 1U);
}

TEST(Mapping, TakesAPositionFromTheNumberThatItBecomes) {
    for (BasicType const type : {BasicType::uint8, BasicType::int8, BasicType::int32}) {
        One sut{{"a", type}, {"b", BasicType::position}}, back{{"a", BasicType::position}, {"b", type}};
        ASSERT_TRUE(sut.mistakes.empty()) << type_name(type);
        for (std::uint64_t code = 0; code < 4; ++code) {
            EXPECT_EQ(sut(back({BasicType::position, 0, code, {}})).bits, code);
        }
        EXPECT_EQ(sut(Value::integer(type, 4)).bits, 3U) << "no position has this code: bad";
        EXPECT_EQ(sut.mapping.counters().saturated, 1U);
    }
    One sut{{"a", BasicType::int8}, {"b", BasicType::position}};
    EXPECT_EQ(sut(Value::integer(BasicType::int8, -1)).bits, 3U);
}

TEST(Mapping, RefusesWhatDoesNotConvert) {
    auto const refused = [](Field from, Field to, Rule r = rule("a", "b")) {
        One const sut{from, to, r};
        return sut.mistakes.empty() ? std::string{} : sut.mistakes[0].message + " | " + sut.mistakes[0].hint;
    };
    EXPECT_THAT(refused({"a", BasicType::visible_string, 5}, {"b", BasicType::int32}),
                HasSubstr("one does not become the other"));
    EXPECT_THAT(refused({"a", BasicType::float32}, {"b", BasicType::boolean}), HasSubstr("what is true is a decision"));
    for (auto const& [from, to] : {std::pair{BasicType::int16, BasicType::quality},
                                   {BasicType::quality, BasicType::int32},
                                   {BasicType::quality, BasicType::uint8}}) { // the test bit would be lost
        EXPECT_THAT(refused({"a", from}, {"b", to}), HasSubstr("its number is uint16, uint32 or uint64"))
            << type_name(from) << " to " << type_name(to);
    }
    EXPECT_THAT(refused({"a", BasicType::float32}, {"b", BasicType::position}),
                HasSubstr("a position is a boolean, an enumeration or a whole number"));
    EXPECT_THAT(refused({"a", BasicType::float32, 0, "A"}, {"b", BasicType::float32, 0, "V"}),
                HasSubstr("they measure different things"));
    EXPECT_THAT(refused({"a", BasicType::float32, 0, "furlong"}, {"b", BasicType::float32}),
                HasSubstr("'furlong' is not a unit"));
    EXPECT_THAT(refused({"a", BasicType::visible_string, 30}, {"b", BasicType::visible_string, 20}),
                HasSubstr("30 characters do not fit into 20"));
    Rule r = rule("a", "b");
    r.scale = 2;
    EXPECT_THAT(refused({"a", BasicType::quality}, {"b", BasicType::quality}, r), HasSubstr("it has no scale"));
    EXPECT_EQ(refused({"a", BasicType::int16}, {"b", BasicType::float32}), "");
}

TEST(Mapping, ReportsEveryMistakeWithTheNearestSpelling) {
    std::vector<Field> const from{{"samples.ia", BasicType::float32}, {"samples.ib", BasicType::float32}},
        to{{"Ia", BasicType::float32}, {"Ib", BasicType::float32}, {"Ic", BasicType::float32}};
    std::vector<Mistake> mistakes;
    Mapping const sut = Mapping::compile(
        {rule("samples.ia", "Ia"), rule("sample.ib", "Ib"), rule("samples.ib", "Ix"), rule("samples.ia", "Ia")}, from,
        to, mistakes);
    ASSERT_EQ(mistakes.size(), 3U);
    EXPECT_EQ(mistakes[0].rule, 1U);
    EXPECT_EQ(mistakes[0].hint, "did you mean 'samples.ib'?");
    EXPECT_TRUE(mistakes[1].about_to);
    EXPECT_THAT(mistakes[2].message, HasSubstr("written twice"));
    EXPECT_THAT(sut.unmapped(), ElementsAre("Ic"));
}

TEST(Mapping, EveryPairOfTypesEitherConvertsOrIsRefused) {
    for (std::size_t i = 0; i < kBasicTypes; ++i) {
        for (std::size_t k = 0; k < kBasicTypes; ++k) {
            auto const a = static_cast<BasicType>(i), b = static_cast<BasicType>(k);
            One sut{{"a", a, default_length(a)}, {"b", b, default_length(b)}};
            EXPECT_EQ(i == k && !sut.mistakes.empty(), false) << type_name(a);
            if (sut.mistakes.empty()) {
                EXPECT_EQ(sut({a, 0, ~std::uint64_t{0} >> 40, {}}).type, b) << type_name(a) << " to " << type_name(b);
            }
        }
    }
}

TEST(Units, ConvertWithinAQuantityOnly) {
    EXPECT_DOUBLE_EQ(*unit_factor("kA", "mA"), 1e6);
    EXPECT_DOUBLE_EQ(*unit_factor("%", "pu"), 0.01);
    EXPECT_DOUBLE_EQ(*unit_factor("MW", "kW"), 1e3);
    EXPECT_FALSE(unit_factor("W", "VA"));
    EXPECT_FALSE(unit_factor("A", "x"));
    EXPECT_TRUE(is_unit("mA"));
    EXPECT_FALSE(is_unit("xA"));
    EXPECT_FALSE(is_unit(""));
}

} // namespace
} // namespace gridspace::mapping
