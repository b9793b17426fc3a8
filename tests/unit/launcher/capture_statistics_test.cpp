// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/capture_statistics.hpp"

#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/sv_template.hpp"
#include "recorder/pcapng/pcapng_writer.hpp"

#include <cstdlib>
#include <gmock/gmock.h>

namespace gridspace::wire {
namespace {

using namespace iec61850;
using Frame = std::vector<std::uint8_t>;
constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000, kPeriod = 208'333;

/// A frame with one ASDU for each (svID, smpCnt).
Frame sv(std::vector<std::pair<std::string, int>> const& samples, std::uint8_t device = 1,
         std::uint16_t app_id = 0x4000) {
    std::vector<AsduDescription> asdus;
    for (auto const& [id, count] : samples) {
        asdus.push_back({});
        asdus.back().sv_id = id;
        asdus.back().sample_octets = 12;
    }
    Address address{*Mac::parse("01:0C:CD:04:00:21"), *Mac::parse("02:00:00:00:00:01"), VlanTag{}, app_id, false};
    address.source.octets[5] = device;
    auto frame = SvTemplate::create(address, asdus);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        frame->set_smp_cnt(i, static_cast<std::uint16_t>(samples[i].second));
    }
    Octets const octets = frame->frame();
    return {octets.begin(), octets.end()};
}

Frame goose(std::uint32_t st_num, std::uint32_t sq_num, std::uint32_t since_s = 0) {
    GooseDescription description;
    description.gocb_ref = "A/LLN0$GO$g";
    description.dat_set = "A/LLN0$d";
    description.data_set = {{DataNode::leaf("status", BasicType::boolean)}};
    auto frame = GooseTemplate::create(
        {*Mac::parse("01:0C:CD:01:00:01"), *Mac::parse("02:00:00:00:00:01"), VlanTag{}, 1, false}, description);
    GooseState state;
    state.st_num = st_num;
    state.sq_num = sq_num;
    state.t.seconds = since_s;
    state.live_ms = 1000;
    Octets const octets = frame->frame(state);
    return {octets.begin(), octets.end()};
}

/// What PRP adds says by which of two networks the frame came.
Frame with_trailer(Frame frame, int network) {
    frame.insert(frame.end(), {0, 1, static_cast<std::uint8_t>(0xA0 + 0x10 * network), 60, 0x88, 0xFB});
    return frame;
}

class CaptureStatisticsOf : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = testing::TempDir() + "/gridspace-capture-XXXXXX";
        folder_ = ::mkdtemp(pattern.data());
        writer_.emplace(std::move(*pcapng::Writer::create(folder_ / "c.pcapng", "test")));
        for (char const* name : {"a", "b"}) {
            points_.push_back(writer_->add_interface(name));
        }
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    void put(std::int64_t at_ns, Frame const& frame, std::size_t point = 0) {
        ASSERT_TRUE(writer_->write(points_[point], kEpoch + at_ns, frame));
    }
    CaptureStatistics read() {
        EXPECT_TRUE(writer_->close());
        auto out = capture_statistics(folder_ / "c.pcapng");
        EXPECT_TRUE(out);
        return out ? std::move(*out) : CaptureStatistics{};
    }

    std::filesystem::path folder_;
    std::optional<pcapng::Writer> writer_;
    std::vector<std::uint32_t> points_;
};

TEST_F(CaptureStatisticsOf, TwoPublishersOfOneNameKeepTheirIntervalsAndDelaysApart) {
    for (int n = 0; n < 400; ++n) {
        put(n * kPeriod, sv({{"MU", n}}, 1));
        put(n * kPeriod + 10'000, sv({{"MU", n}}, 1), 1); // seen at a second point, 10 us later
        put(n * kPeriod + 50'000, sv({{"MU", n}}, 2, 0x4001));
    }
    auto const got = read();
    ASSERT_EQ(got.streams.size(), 2U);
    for (StreamStatistics const& stream : got.streams) {
        EXPECT_EQ(stream.interval_ms.count, 399U);
        EXPECT_NEAR(stream.interval_ms.min, 0.208, 1e-3);
        EXPECT_NEAR(stream.interval_ms.max, 0.208, 1e-3);
    }
    ASSERT_TRUE(got.streams[0].delay_ms);
    EXPECT_EQ(got.streams[0].delay_ms->count, 400U);
    EXPECT_NEAR(got.streams[0].delay_ms->p50, 0.010, 1e-6);
    EXPECT_FALSE(got.streams[1].delay_ms) << "this one was seen at one point only";
    EXPECT_EQ(got.clock_back, 0U);
}

TEST_F(CaptureStatisticsOf, FramesThatCameBeforeMakeNoIntervals) {
    for (int n = 0; n < 400; ++n) {
        for (int network = 0; network < 2; ++network) {
            put(n * kPeriod + network * 5'000, with_trailer(sv({{"MU", n}}), network));
        }
    }
    for (std::uint32_t k = 0; k < 10; ++k) {
        put(1'000'000'000 + k * 16'000'000, with_trailer(goose(1, k), 0));
        put(1'000'005'000 + k * 16'000'000, with_trailer(goose(1, k), 1));
    }
    auto const got = read();
    ASSERT_EQ(got.streams.size(), 2U);
    StreamStatistics const& samples = got.streams[0];
    EXPECT_EQ(samples.stream.frames, 800U);
    EXPECT_EQ(samples.stream.duplicates, 400U);
    EXPECT_EQ(samples.interval_ms.count, 399U);
    EXPECT_NEAR(samples.interval_ms.min, 0.208, 1e-3);
    EXPECT_EQ(got.streams[1].stream.duplicates, 10U);
    EXPECT_NEAR(got.streams[1].interval_ms.min, 16, 1e-6);
    EXPECT_NEAR(got.streams[1].interval_ms.max, 16, 1e-6);
}

TEST_F(CaptureStatisticsOf, FramesOfManySamplesThatComeTwiceAreDuplicatesAndOvertakenOnesOutOfOrder) {
    auto const frame = [](int first) {
        return sv({{"MU", first}, {"MU", first + 1}, {"MU", first + 2}, {"MU", first + 3}});
    };
    for (int n = 0; n < 800; n += 4) {
        put(n * kPeriod, frame(n % 80 == 40 ? n + 4 : n % 80 == 44 ? n - 4 : n));
        if (n % 80 == 0) {
            put(n * kPeriod + 100'000, frame(n));
        }
    }
    auto const got = read();
    ASSERT_EQ(got.streams.size(), 1U);
    ObservedStream const& stream = got.streams[0].stream;
    EXPECT_EQ(stream.frames, 210U);
    EXPECT_EQ(stream.lost, 0U);
    EXPECT_EQ(stream.duplicates, 40U) << "samples";
    EXPECT_EQ(stream.out_of_order, 40U);
}

TEST_F(CaptureStatisticsOf, FramesWhoseStreamsAlternateAreCountedOnce) {
    for (int n = 0; n < 800; n += 2) {
        put(n * kPeriod, sv({{"A", n}, {"B", n}, {"A", n + 1}, {"B", n + 1}}));
    }
    auto const got = read();
    ASSERT_EQ(got.streams.size(), 2U);
    for (StreamStatistics const& stream : got.streams) {
        EXPECT_EQ(stream.stream.frames, 400U);
        EXPECT_EQ(stream.stream.asdus, 2U);
        EXPECT_EQ(stream.stream.lost, 0U);
    }
}

TEST_F(CaptureStatisticsOf, AClockThatIsSetBackMakesNoIntervalAndIsSaid) {
    for (int n = 0; n < 400; ++n) {
        put(n * kPeriod - (n >= 200 ? 10'000'000'000 : 0) - (n >= 300 ? 10'000'000'000 : 0), sv({{"MU", n}}));
    }
    auto const got = read();
    EXPECT_EQ(got.clock_back, 2U);
    ASSERT_EQ(got.streams.size(), 1U);
    EXPECT_EQ(got.streams[0].interval_ms.count, 397U);
    EXPECT_NEAR(got.streams[0].interval_ms.min, 0.208, 1e-3);
    EXPECT_NEAR(got.streams[0].stream.rate_hz(), 4800, 0.1);
    EXPECT_THAT(to_text(got), testing::HasSubstr("the capture's clock went back 2 times"));
    EXPECT_THAT(to_json(got), testing::HasSubstr("\"clock_back\": 2"));
}

TEST_F(CaptureStatisticsOf, AnOutageIsLostAndNotARestart) {
    for (int n = 0; n < 12'000; ++n) {
        if (n < 2000 || n >= 2000 + 4800) { // exactly a second: the counter goes on as if nothing had been
            put(std::int64_t{n} * 1'000'000'000 / 4800, sv({{"MU", n % 4800}}));
        }
    }
    auto const got = read();
    ASSERT_EQ(got.streams.size(), 1U);
    EXPECT_EQ(got.streams[0].stream.lost, 4800U);
    EXPECT_EQ(got.streams[0].stream.restarts, 0U);
    EXPECT_NEAR(got.streams[0].stream.rate_hz(), 4800, 0.1);
}

TEST_F(CaptureStatisticsOf, ADeviceThatStartsAgainIsARestartAndNotOutOfOrder) {
    std::int64_t n = 0;
    for (std::uint32_t const sq_num : {9U, 10U, 11U, 12U}) {
        put(++n * 1'000'000'000, goose(1, sq_num, 1000));
    }
    for (std::uint32_t const sq_num : {1U, 2U, 3U}) { // stNum stays 1, and its state began 78 s later
        put((++n + 78) * 1'000'000'000, goose(1, sq_num, 1078));
    }
    auto const got = read();
    ASSERT_EQ(got.streams.size(), 1U);
    EXPECT_EQ(got.streams[0].stream.restarts, 1U);
    EXPECT_EQ(got.streams[0].stream.out_of_order, 0U);
    EXPECT_EQ(got.streams[0].stream.lost, 0U);
}

TEST(Observer, CallsAStreamOfASingleFrameSilentSoon) {
    Observer sut;
    sut.add(sv({{"A", 0}}), 0);
    EXPECT_TRUE(sut.streams()[0]->alive(1'500'000'000));
    EXPECT_FALSE(sut.streams()[0]->alive(3'000'000'000)) << "nobody sends less than a sample a second";
}

TEST(Observer, KeepsTheOneStreamThatIsWantedAndCountsTheFramesOfOthers) {
    Observer sut{"B"};
    EXPECT_EQ(sut.add(sv({{"A", 0}, {"B", 0}}), 0).size(), 1U);
    EXPECT_EQ(sut.add(sv({{"A", 1}}), kPeriod).size(), 0U);
    ASSERT_EQ(sut.streams().size(), 1U);
    EXPECT_EQ(sut.streams()[0]->id, "B");
    EXPECT_EQ(sut.frames(), 2U);
    EXPECT_EQ(sut.unwanted(), 1U);
}

} // namespace
} // namespace gridspace::wire
