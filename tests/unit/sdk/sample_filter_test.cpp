// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/sample_filter.hpp"

#include <gmock/gmock.h>
#include <map>

namespace gridspace::sdk {
namespace {

struct Price {
    double value;
    char const* bus;
    char const* kind;
};

idl::NativeLayout const& price() {
    static auto const layout = *idl::NativeLayout::create(
        std::make_shared<idl::Model const>(*idl::parse("struct Price { double value; string bus; string kind; };")),
        "Price");
    return layout;
}

program::Values settings(std::map<std::string, std::vector<std::string>> values) {
    return [values = std::move(values)](std::string_view key) {
        auto const found = values.find(std::string{key});
        return found == values.end() ? std::vector<std::string>{} : found->second;
    };
}

bool admits(std::vector<program::Topic::Only> const& only, program::Values const& values, Price const& sample) {
    auto const sut = SampleFilter::create(price(), only, values);
    EXPECT_TRUE(sut);
    return sut && sut->admits(&sample);
}

TEST(SampleFilter, WithoutTextsAdmitsEverything) {
    EXPECT_TRUE(admits({}, settings({}), {1, "N", "day"}));
}

TEST(SampleFilter, AdmitsWhatHasTheValueOfASetting) {
    auto const bus = settings({{"bus", {"N"}}});
    EXPECT_TRUE(admits({{"bus", "{bus}"}}, bus, {1, "N", "day"}));
    EXPECT_FALSE(admits({{"bus", "{bus}"}}, bus, {1, "NN", "day"}));
    EXPECT_FALSE(admits({{"bus", "{bus}"}}, bus, {1, nullptr, "day"})); // an empty text
}

TEST(SampleFilter, OfSeveralValuesEachWillDo) {
    auto const buses = settings({{"buses", {"N", "S"}}});
    EXPECT_TRUE(admits({{"bus", "{buses}"}}, buses, {1, "S", "day"}));
    EXPECT_FALSE(admits({{"bus", "{buses}"}}, buses, {1, "E", "day"}));
}

TEST(SampleFilter, OfSeveralMembersEachHasToFit) {
    auto const bus = settings({{"bus", {"N"}}});
    EXPECT_TRUE(admits({{"bus", "{bus}"}, {"kind", "day"}}, bus, {1, "N", "day"}));
    EXPECT_FALSE(admits({{"bus", "{bus}"}, {"kind", "day"}}, bus, {1, "N", "night"}));
}

TEST(SampleFilter, OfASettingThatIsNotGivenFiltersNothing) {
    EXPECT_TRUE(admits({{"bus", "{bus}"}}, settings({}), {1, "N", "day"}));
}

TEST(SampleFilter, RefusesAMemberThatIsNoText) {
    for (char const* const member : {"value", "buss"}) {
        auto const sut = SampleFilter::create(price(), {{member, "1"}}, settings({}));
        ASSERT_FALSE(sut);
        EXPECT_THAT(sut.error().message,
                    testing::HasSubstr(std::string{"`only` names '"} + member + "', and Price has no text"));
    }
}

} // namespace
} // namespace gridspace::sdk
