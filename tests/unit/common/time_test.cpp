// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/time.hpp"

#include <gtest/gtest.h>

namespace gridspace {
namespace {

TEST(TimeBase, NanosecondStampsLoseNothing) {
    TimeBase const sut{Rational{1, 48000}};
    for (std::int64_t quanta : {0L, 1L, 2L, 3L, 47999L, 48000L, 264007L, 86'400L * 365 * 48000 + 1}) {
        EXPECT_EQ(sut.from_nanoseconds(sut.nanoseconds({quanta})).quanta, quanta);
    }
}

TEST(TimeBase, RoundsNanosecondsAndNeverAccumulatesThem) {
    TimeBase const sut{Rational{1, 4800}};
    EXPECT_EQ(sut.nanoseconds({1}), 208'333);
    EXPECT_EQ(sut.nanoseconds({2}), 416'667);
    EXPECT_EQ(sut.nanoseconds({4800}), 1'000'000'000);
}

TEST(TimeBase, LatenciesRoundUpToWholeQuanta) {
    TimeBase const sut{Rational{1, 48000}};
    EXPECT_EQ(sut.ceil(Rational{120, 1'000'000}).quanta, 6);       // 5.76
    EXPECT_EQ(sut.ceil(Rational{1, 48000}).quanta, 1);             // exact stays
    EXPECT_EQ(sut.ceil(*Rational::parse("1111.2e-6")).quanta, 54); // 53.3376
}

TEST(Utc, ReadsAndWritesTheSameText) {
    EXPECT_EQ(parse_utc("1970-01-01T00:00:00Z"), 0);
    EXPECT_EQ(parse_utc("2019-12-01T09:00:00Z"), 1'575'190'800);
    EXPECT_EQ(parse_utc("2199-12-31T23:59:59Z"), 7'258'118'399);
    EXPECT_EQ(format_utc(1'575'190'800), "2019-12-01T09:00:00Z");
    for (char const* text :
         {"2019-12-01", "2019-13-01T00:00:00Z", "2019-02-29T00:00:00Z", "2019-12-01T24:00:00Z", "2019-12-01T09:00:00",
          "2019-12-01 09:00:00Z", "x019-12-01T09:00:00Z", "1969-12-31T23:59:59Z", "2200-01-01T00:00:00Z"}) {
        EXPECT_FALSE(parse_utc(text).has_value()) << text;
    }
}

} // namespace
} // namespace gridspace
