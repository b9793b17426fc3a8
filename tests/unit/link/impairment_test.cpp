// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/sample_index.hpp"
#include "gateways/link/impairment.hpp"

#include "gateways/iec61850/routable_sender.hpp"
#include "gateways/iec61850/sv_publisher.hpp"

#include <bit>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <map>
#include <numeric>
#include <optional>

namespace gridspace::gateways {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kPeriodNs = 208'333;

/// What came out, in the order of time.
struct Outcome final : FrameOutput {
    std::int64_t now_ns{0};
    std::multimap<std::int64_t, std::vector<std::uint8_t>> frames;
    void send(std::span<std::uint8_t const> octets, std::int64_t delay_ns) override {
        EXPECT_GE(delay_ns, 0);
        frames.emplace(now_ns + delay_ns, std::vector<std::uint8_t>{octets.begin(), octets.end()});
    }
    /// The fifth octet from the end of each, which is where `numbered` writes its number.
    [[nodiscard]] std::vector<int> numbers() const {
        std::vector<int> out;
        for (auto const& [at, octets] : frames) {
            out.push_back(octets[octets.size() - 5]);
        }
        return out;
    }
};

std::vector<std::uint8_t> numbered(std::uint8_t number, std::size_t size = 100) {
    std::vector<std::uint8_t> out(size, 0x55);
    out[12] = 0x88, out[13] = 0xba, out[size - 5] = number;
    return out;
}

Outcome passed(Impairments const& impairments, int frames, std::uint64_t seed = 1, std::int64_t period_ns = kPeriodNs) {
    Impairment sut{{impairments, {}, {}, {}, {}}, seed, "cable"};
    Outcome out;
    for (int i = 0; i < frames; ++i) {
        out.now_ns = i * period_ns;
        if (auto const due = sut.due(); due && *due < out.now_ns) {
            sut.elapse(*due, out);
        }
        sut.pass({numbered(static_cast<std::uint8_t>(i)), out.now_ns}, out);
    }
    if (auto const due = sut.due()) {
        out.now_ns = *due;
        sut.elapse(*due, out);
    }
    return out;
}

TEST(Impairment, LetsEverythingPassWhenThereIsNone) {
    auto const out = passed({}, 5);
    EXPECT_THAT(out.numbers(), ElementsAre(0, 1, 2, 3, 4));
    EXPECT_EQ(out.frames.rbegin()->first, 4 * kPeriodNs);
    EXPECT_EQ(out.frames.begin()->second, numbered(0));
}

/// Lost frames, and the mean length of a run of them.
std::pair<double, double> losses(Impairments const& impairments, int frames = 200'000) {
    Impairment sut{{impairments, {}, {}, {}, {}}, 5, "cable"};
    int lost = 0, bursts = 0;
    bool before = false;
    for (int i = 0; i < frames; ++i) {
        Outcome out;
        sut.pass({numbered(0), 0}, out);
        bool const gone = out.frames.empty();
        lost += gone ? 1 : 0;
        bursts += gone && !before ? 1 : 0;
        before = gone;
    }
    return {static_cast<double>(lost) / frames, bursts == 0 ? 0 : static_cast<double>(lost) / bursts};
}

TEST(Impairment, ALineWithTwoStatesLosesWhatGilbertAndElliottSay) {
    // Bad for p / (p + r) of the time, 1 / r frames each time.
    auto const [share, burst] = losses({.to_bad_percent = 1, .to_good_percent = 20});
    EXPECT_NEAR(share, 0.01 / 0.21, 0.004);
    EXPECT_NEAR(burst, 5, 0.3);
    auto const [half, shorter] = losses({.to_bad_percent = 1, .to_good_percent = 20, .bad_loss_percent = 50});
    EXPECT_NEAR(half, share / 2, 0.004);
    EXPECT_LT(shorter, 2.5);
    auto const [more, unused] = losses({.loss_percent = 2, .to_bad_percent = 1, .to_good_percent = 20});
    EXPECT_NEAR(more, share + 0.02 * (1 - share), 0.005);
    EXPECT_EQ(losses({.to_good_percent = 20}).first, 0) << "a line that never turns bad";
    EXPECT_EQ(losses({.to_bad_percent = 1, .to_good_percent = 20}), (std::pair{share, burst})) << "seeded";
}

TEST(Impairment, LosesTheWantedShareInBurstsOfTheWantedLength) {
    for (double const burst : {1.0, 8.0}) {
        constexpr int kFrames = 200'000;
        Impairment sut{{{.loss_percent = 10, .loss_burst = burst}, {}, {}, {}, {}}, 5, "cable"};
        int lost = 0, bursts = 0;
        bool before = false;
        for (int i = 0; i < kFrames; ++i) {
            Outcome out;
            sut.pass({numbered(0), 0}, out);
            bool const gone = out.frames.empty();
            lost += gone ? 1 : 0;
            bursts += gone && !before ? 1 : 0;
            before = gone;
        }
        EXPECT_NEAR(100.0 * lost / kFrames, 10, 0.6) << burst; // six standard deviations of the coarser one
        EXPECT_NEAR(static_cast<double>(lost) / bursts, burst == 1 ? 1.0 / 0.9 : 8.1, burst == 1 ? 0.02 : 0.3);
        EXPECT_EQ(sut.counters().lost, static_cast<std::uint64_t>(lost));
    }
}

TEST(Impairment, IsTheSameForTheSameSeedAndAnotherForAnother) {
    Impairments const bad{
        .loss_percent = 20, .jitter_us = 400, .duplicate_percent = 20, .reorder_percent = 20, .corrupt_percent = 20};
    EXPECT_EQ(passed(bad, 200, 3).frames, passed(bad, 200, 3).frames);
    EXPECT_NE(passed(bad, 200, 3).frames, passed(bad, 200, 4).frames);
}

TEST(Impairment, LosesTheSameFramesWhateverElseItDoes) {
    auto const lost_only = passed({.loss_percent = 30}, 100).numbers();
    auto const and_more = passed({.loss_percent = 30, .delay_us = 50, .jitter_us = 20}, 100).numbers();
    EXPECT_EQ(lost_only, and_more);
    EXPECT_LT(lost_only.size(), 90U);
}

TEST(Impairment, KeepsTheOrderUnderJitterThatIsLongerThanAPeriod) {
    auto const out = passed({.delay_us = 100, .jitter_us = 2000}, 100);
    std::vector<int> expected(100);
    std::iota(expected.begin(), expected.end(), 0);
    EXPECT_EQ(out.numbers(), expected);
    EXPECT_GE(out.frames.begin()->first, 100'000);
    EXPECT_NE(out.frames.begin()->first, 100'000);
}

TEST(Impairment, LetsTheWantedNumberOfFramesOvertake) {
    auto const out = passed({.reorder_percent = 100, .reorder_by = 2}, 6);
    EXPECT_THAT(out.numbers(), ElementsAre(1, 2, 0, 4, 5, 3));
}

TEST(Impairment, LetsAHeldFrameGoWhenNobodyOvertakesIt) {
    auto const out = passed({.reorder_percent = 100}, 1);
    EXPECT_THAT(out.numbers(), ElementsAre(0));
    EXPECT_EQ(out.frames.begin()->first, 100'000'000);
}

TEST(Impairment, SendsDuplicatesAsOftenAndAsLateAsWanted) {
    auto const out = passed({.duplicate_percent = 100, .duplicate_after_us = 70}, 2);
    EXPECT_THAT(out.numbers(), ElementsAre(0, 0, 1, 1));
    EXPECT_EQ(std::next(out.frames.begin())->first, 70'000);
}

TEST(Impairment, TurnsSoManyBitsOverBehindTheEthertype) {
    auto const original = numbered(7);
    int turned = 0;
    for (std::uint64_t seed = 0; seed < 50; ++seed) {
        Impairment sut{{{.corrupt_percent = 100, .corrupt_bits = 3}, {}, {}, {}, {}}, seed, "cable"};
        Outcome out;
        sut.pass({original, 0}, out);
        auto const& damaged = out.frames.begin()->second;
        ASSERT_EQ(damaged.size(), original.size());
        EXPECT_TRUE(std::equal(original.begin(), original.begin() + 14, damaged.begin()));
        int bits = 0;
        for (std::size_t i = 0; i < damaged.size(); ++i) {
            bits += std::popcount(static_cast<unsigned>(damaged[i] ^ original[i]));
        }
        EXPECT_LE(bits, 3);
        turned += bits;
    }
    EXPECT_GT(turned, 140); // the same bit twice is rare
}

TEST(Impairment, SpreadsFramesAtTheRateOfTheLineAndLosesWhatWouldWaitTooLong) {
    // 100 octets and 24 of preamble, check and gap: 992 bits are 99.2 us at 10 Mbit/s. All come at once.
    auto const out = passed({.rate_mbps = 10, .queue_ms = 0.35}, 10, 1, 0);
    EXPECT_THAT(out.numbers(), ElementsAre(0, 1, 2, 3));
    EXPECT_EQ(out.frames.begin()->first, 99'200);
    EXPECT_EQ(out.frames.rbegin()->first, 4 * 99'200);
}

TEST(Impairment, ChangesWhenTheTimelineSaysSo) {
    Impairment sut{{{}, {{2 * kPeriodNs, "up", 0}, {4 * kPeriodNs, "up", 1}}, {}, {}, {}}, 1, "cable"};
    Outcome out;
    for (std::uint8_t i = 0; i < 6; ++i) {
        out.now_ns = i * kPeriodNs;
        sut.pass({numbered(i), out.now_ns}, out);
    }
    EXPECT_THAT(out.numbers(), ElementsAre(0, 1, 4, 5));
}

/// An SMV stream with its frames.
struct Stream {
    explicit Stream(std::uint16_t app_id) {
        iec61850::Address address;
        address.destination = *iec61850::Mac::parse("01:0C:CD:04:00:21");
        address.app_id = app_id;
        iec61850::AsduDescription asdu;
        asdu.sv_id = "MU";
        asdu.sample_octets = 12;
        publisher.emplace(std::move(*iec61850::SvTemplate::create(address, {asdu})), 4800);
        mark = {"S", iec61850::kSvEthertype, app_id, address.destination, 4800};
    }
    iec61850::Octets frame(std::int64_t index) {
        (void)publisher->sample(index);
        return publisher->commit();
    }
    std::optional<iec61850::SvPublisher> publisher;
    StreamMark mark;
};

std::vector<std::int64_t> lost_of(Impairment& sut, Stream& stream, std::int64_t from, std::int64_t until) {
    std::vector<std::int64_t> lost;
    for (std::int64_t i = from; i < until; ++i) {
        Outcome out;
        sut.pass({stream.frame(i), i * 1'000'000'000 / 4800 + 120'000}, out);
        if (out.frames.empty()) {
            lost.push_back(i);
        }
    }
    return lost;
}

TEST(Impairment, LosesTheSamplesThatAreNamedAlsoBehindTheWrapOfTheCounter) {
    Stream stream{0x4021}, other{0x4022};
    ImpairmentPlan plan;
    plan.marks = {stream.mark};
    plan.samples = {{0, 4799, 3, SampleImpairment::What::lose, 0}, {0, 9605, 1, SampleImpairment::What::lose, 0}};
    Impairment sut{plan, 1, "cable"};
    EXPECT_THAT(lost_of(sut, stream, 0, 9700), ElementsAre(4799, 4800, 4801, 9605));
    Impairment again{plan, 1, "cable"};
    EXPECT_THAT(lost_of(again, other, 0, 9700), ElementsAre()); // another stream
}

TEST(Impairment, LeavesStreamsAloneThatAreNotMeant) {
    Stream meant{0x4021}, other{0x4022};
    ImpairmentPlan plan;
    plan.first.loss_percent = 100;
    plan.marks = {meant.mark};
    plan.only = {0};
    Impairment sut{plan, 1, "cable"};
    EXPECT_EQ(lost_of(sut, meant, 0, 10).size(), 10U);
    EXPECT_EQ(lost_of(sut, other, 0, 10).size(), 0U);
    EXPECT_EQ(sut.counters().seen, 10U);
}

TEST(Impairment, FindsStreamsAndSamplesOverUdpAndDamagesNoHeaderThere) {
    Stream stream{0x4021};
    iec61850::RoutableAddress address;
    address.ip_destination = {239, 192, 0, 21};
    iec61850::RoutableSender sender{address};
    stream.mark.destination = address.group();
    ImpairmentPlan plan;
    plan.first.corrupt_percent = 100;
    plan.first.corrupt_bits = 1000;
    plan.marks = {stream.mark};
    plan.only = {0};
    plan.samples = {{0, 3, 2, SampleImpairment::What::lose, 0}};
    Impairment sut{plan, 1, "cable"};
    for (std::int64_t i = 0; i < 10; ++i) {
        iec61850::FrameHeader header;
        ASSERT_TRUE(iec61850::decode_header(stream.frame(i), header));
        std::vector<std::uint8_t> frame;
        sender.wrap(header, frame);
        Outcome out;
        sut.pass({frame, i * 1'000'000'000 / 4800 + 120'000}, out);
        ASSERT_EQ(out.frames.size(), i == 3 || i == 4 ? 0U : 1U) << i;
        for (auto const& [at, damaged] : out.frames) {
            EXPECT_NE(damaged, frame);
            EXPECT_EQ(iec61850::stream_ethertype(damaged), iec61850::kSvEthertype);
        }
    }
    EXPECT_EQ(sut.counters().corrupted, 8U);
}

TEST(AbsoluteIndex, FollowsFromTheCounterAndHalfASecondsKnowledgeOfTime) {
    EXPECT_EQ(iec61850::absolute_index(0, 4800, 120'000), 0);
    EXPECT_EQ(iec61850::absolute_index(4799, 4800, 999'900'000), 4799);
    EXPECT_EQ(iec61850::absolute_index(4799, 4800, 1'400'000'000), 4799);
    EXPECT_EQ(iec61850::absolute_index(3, 4800, 5'000'700'000), 24'003);
    EXPECT_EQ(iec61850::absolute_index(3, 4800, 4'600'000'000), 24'003);
}

TEST(ImpairmentKeys, AreCheckedByName) {
    Impairments sut;
    EXPECT_TRUE(set_impairment(sut, "loss_percent", 5));
    EXPECT_EQ(sut.loss_percent, 5);
    EXPECT_FALSE(set_impairment(sut, "loss", 5));
    EXPECT_EQ(wrong_with_impairment("loss_percent", 101), "expected a number from 0 to 100");
    EXPECT_EQ(wrong_with_impairment("up", 0.5), "expected true or false");
    for (std::string const& key : impairment_keys()) {
        EXPECT_TRUE(set_impairment(sut, key, 1)) << key;
        EXPECT_EQ(wrong_with_impairment(key, 1), "") << key;
    }
}

} // namespace
} // namespace gridspace::gateways
