// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"

#include <gtest/gtest.h>

namespace gridspace {
namespace {

TEST(NearestSpelling, FindsSlipsAndIgnoresStrangers) {
    std::vector<std::string> const keys{"pickup_a", "window_cycles", "kind", "p_kw"};
    EXPECT_EQ(nearest_spelling("pick_up_a", keys), "pickup_a");
    EXPECT_EQ(nearest_spelling("pickpu_a", keys), "pickup_a");
    EXPECT_EQ(nearest_spelling("Kind", keys), "kind");
    EXPECT_FALSE(nearest_spelling("frequency", keys).has_value());
}

TEST(Glob, MatchesWholeTexts) {
    EXPECT_TRUE(matches_glob("bus.*.v_pu", "bus.B1.v_pu"));
    EXPECT_TRUE(matches_glob("*", ""));
    EXPECT_TRUE(matches_glob("stream.SMV2?.lost", "stream.SMV21.lost"));
    EXPECT_FALSE(matches_glob("bus.*.v_pu", "bus.B1.v_pu.a"));
    EXPECT_FALSE(matches_glob("bus.?.v_pu", "bus.B1.v_pu"));
    EXPECT_TRUE(matches_glob("a*b*c", "a_b_b_c"));
}

TEST(Identifier, FollowsTheStrictestDds) {
    EXPECT_TRUE(is_identifier("TL_21"));
    EXPECT_TRUE(is_identifier("_x"));
    EXPECT_FALSE(is_identifier("TL-21"));
    EXPECT_FALSE(is_identifier("21"));
    EXPECT_FALSE(is_identifier(""));
}

TEST(Shortest, ReadsBackTheSameNumber) {
    EXPECT_EQ(shortest(0.1), "0.1");
    EXPECT_EQ(shortest(3), "3");
    EXPECT_EQ(shortest(1e-9), "1e-09");
}

TEST(Shortest, WritesNoExponentWherePeopleWouldNot) {
    EXPECT_EQ(shortest(1'000'000), "1000000");
    EXPECT_EQ(shortest(-200'000), "-200000");
    EXPECT_EQ(shortest(0.00012), "0.00012");
    EXPECT_EQ(shortest(0), "0");
    EXPECT_EQ(shortest(1e22), "1e+22");
}

TEST(EscapeMarkup, LeavesNothingThatIsMarkup) {
    EXPECT_EQ(escape_markup("<a b=\"c\" d='e'>&\x1b[2J"), "&lt;a b=&quot;c&quot; d=&#39;e&#39;&gt;&amp;?[2J");
}

TEST(Printable, KeepsTextAndTakesControlCharacters) {
    EXPECT_EQ(printable("a\tb\x1b[2J\x7f \xc2\x9b \xff \xe2\x82"), "a b?[2J? ? ? ??");
    EXPECT_EQ(printable("Größe µ €"), "Größe µ €");
}

} // namespace
} // namespace gridspace
