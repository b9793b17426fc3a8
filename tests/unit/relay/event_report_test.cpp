// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/event_report.hpp"

#include "tests/support/temporary_folder.hpp"
#include "tests/unit/relay/waves.hpp"

#include <gtest/gtest.h>

#include <cstring>
#include <fstream>
#include <sstream>

namespace gridspace::relay {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kUtc = 1'575'158'400'000'000'000; // 2019-12-01T00:00:00Z
constexpr std::size_t kOctetsOfRow = 4 + 4 + 9 * 2 + 2;

std::string content(fs::path const& file) {
    std::ifstream stream{file, std::ios::binary};
    std::ostringstream out;
    out << stream.rdbuf();
    return out.str();
}

EventReportConfig config(fs::path const& folder) {
    EventReportConfig out;
    out.before_ms = 10;
    out.after_ms = 20;
    out.folder = folder;
    return out;
}

/// Feeds samples [from, until); the relay trips at `trip` and `lost` is missing.
void feed(EventReport& sut, std::int64_t from, std::int64_t until, std::int64_t trip, std::int64_t lost = -1) {
    for (std::int64_t k = from; k < until; ++k) {
        if (k == lost) {
            continue;
        }
        RelayOutput out;
        out.index = k;
        out.pickup = out.trip = k >= trip;
        sut.sample(through(k, 100), out, kUtc + k * 1'000'000'000 / 4800);
    }
}

std::int16_t stored(std::string const& dat, std::size_t row, std::size_t channel) {
    std::int16_t out = 0;
    std::memcpy(&out, dat.data() + row * kOctetsOfRow + 8 + channel * 2, 2);
    return out;
}

TEST(EventReport, HoldsTheSamplesAroundTheTripAndTheLog) {
    TemporaryFolder const folder;
    {
        EventReport sut{config(folder.path()), {"relay2", "SMV21", "SMV22"}};
        feed(sut, 0, 480, 480);
        sut.event("sample 480: trip");
        feed(sut, 480, 700, 480);
    }
    std::string const cfg = content(folder.path() / "relay2_1.cfg"), dat = content(folder.path() / "relay2_1.dat");
    EXPECT_EQ(cfg.substr(0, 31), "gridspace,relay2,2013\r\n14,9A,5D");
    std::size_t const rows = 48 + 1 + 96; // 10 ms before, the trip, 20 ms after
    EXPECT_EQ(dat.size(), rows * kOctetsOfRow);
    EXPECT_NE(cfg.find("4800,145\r\n"), std::string::npos) << cfg;
    EXPECT_NE(cfg.find("01/12/2019,00:00:00.090"), std::string::npos) << "first sample: 432 of 4800\n" << cfg;
    EXPECT_NE(cfg.find("01/12/2019,00:00:00.100"), std::string::npos) << "the trip: sample 480\n" << cfg;
    // Phase a of SMV21: crest 100 sqrt(2) A at multiples of 80 samples, so in row 48 (sample 480), at the end of the
    // scale.
    EXPECT_EQ(stored(dat, 48, 0), 32767);
    EXPECT_NE(content(folder.path() / "relay2_1.hdr").find("sample 480: trip\r\n"), std::string::npos);
    EXPECT_FALSE(fs::exists(folder.path() / "relay2_2.cfg"));
}

TEST(EventReport, ShowsALostSampleAsMissingAndKeepsTheTime) {
    TemporaryFolder const folder;
    EventReport sut{config(folder.path()), {"relay2", "SMV21", "SMV22"}};
    feed(sut, 0, 700, 480, 500);
    sut.finish();
    std::string const dat = content(folder.path() / "relay2_1.dat");
    EXPECT_EQ(dat.size(), (48 + 1 + 96 + 1) * kOctetsOfRow) << "the lost one takes a row of its own";
    EXPECT_EQ(stored(dat, 68, 0), std::int16_t{-32768}) << "sample 500 is missing";
    EXPECT_NE(stored(dat, 69, 0), std::int16_t{-32768});
}

TEST(EventReport, IsWrittenAsFarAsItIsWhenTheRunEnds) {
    TemporaryFolder const folder;
    EventReport sut{config(folder.path()), {"relay2", "SMV21", "SMV22"}};
    feed(sut, 470, 490, 480);
    sut.finish();
    EXPECT_EQ(content(folder.path() / "relay2_1.dat").size(), 20 * kOctetsOfRow);
}

TEST(EventReport, ATripThatStaysIsOneReportAndAnotherTripIsAnother) {
    TemporaryFolder const folder;
    EventReport sut{config(folder.path()), {"relay2", "SMV21", "SMV22"}};
    feed(sut, 0, 2000, 480);
    EXPECT_EQ(sut.reports(), 1);
    feed(sut, 2000, 2500, 2400); // reset before, trips again
    feed(sut, 2500, 2600, 2400);
    EXPECT_EQ(sut.reports(), 2);
    sut.finish();
    EXPECT_TRUE(fs::exists(folder.path() / "relay2_2.cfg"));
}

TEST(EventReport, WithoutATripThereIsNone) {
    TemporaryFolder const folder;
    EventReport sut{config(folder.path()), {"relay2", "SMV21", "SMV22"}};
    feed(sut, 0, 5000, 6000);
    sut.finish();
    EXPECT_EQ(sut.reports(), 0);
    EXPECT_TRUE(fs::is_empty(folder.path()));
}

} // namespace
} // namespace gridspace::relay
