// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/first_line/first_line.hpp"

#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/sv_template.hpp"

#include <gtest/gtest.h>

namespace gridspace::gateways {
namespace {

using namespace iec61850;

Address address(std::uint8_t last) {
    return {*Mac::parse("01:0C:CD:04:00:21"), Mac{{2, 0, 0, 0, 0, last}}, VlanTag{}, 0x4021, false};
}

/// A stream of sampled values, as frames that are really encoded and decoded.
class Samples {
  public:
    explicit Samples(std::size_t asdus = 1, std::uint8_t source = 1) : frame_{make(asdus, source)} {}

    SvFrame const& frame(std::uint16_t first, float value) {
        for (std::size_t i = 0; i < frame_.asdus(); ++i) {
            frame_.set_smp_cnt(i, static_cast<std::uint16_t>((first + i) % 4800));
            store_float(frame_.sample(i), 0, value + static_cast<float>(i));
        }
        EXPECT_TRUE(decode_sv(frame_.frame(), decoded_));
        return decoded_;
    }

  private:
    static SvTemplate make(std::size_t asdus, std::uint8_t source) {
        AsduDescription d;
        d.sv_id = "MU";
        d.sample_octets = 4;
        return *SvTemplate::create(address(source), std::vector(asdus, d));
    }
    SvTemplate frame_;
    SvFrame decoded_;
};

SvFirstLine rules(FirstLineConfig::OnFinding on_finding, bool judge_arrival = false) {
    return SvFirstLine{{.on_finding = on_finding}, 4800, false, judge_arrival};
}
constexpr auto kRefuse = FirstLineConfig::OnFinding::refuse, kReport = FirstLineConfig::OnFinding::report;

SvFirstLine::Verdict judge(SvFirstLine& sut, SvFrame const& frame, std::int64_t arrival_ns = 0) {
    return sut.judge(frame.header, frame.asdus[0], 0, arrival_ns);
}

TEST(SvFirstLine, RefusesASecondPublisherAndKeepsTheBoundOne) {
    SvFirstLine sut = rules(kRefuse);
    Samples real, forged{1, 66};
    for (std::uint16_t n = 0; n < 100; ++n) {
        ASSERT_TRUE(judge(sut, real.frame(n, 1)).use);
        auto const verdict = judge(sut, forged.frame(static_cast<std::uint16_t>(n + 1), 200));
        EXPECT_FALSE(verdict.use);
        EXPECT_FALSE(verdict.contested) << "its address gives it away: nothing is in doubt";
        EXPECT_EQ(verdict.findings, static_cast<std::uint32_t>(ids::kWrongSource));
    }
    EXPECT_EQ(sut.refused(), 100U);
    EXPECT_EQ(sut.counters()[0], 100U);
}

TEST(SvFirstLine, CallsBothQuestionableWhenOneAddressClaimsASampleTwice) {
    SvFirstLine sut = rules(kRefuse);
    Samples real, spoofed;
    ASSERT_TRUE(judge(sut, real.frame(10, 1)).use);
    ASSERT_TRUE(judge(sut, spoofed.frame(11, 200)).use) << "nothing tells it from the real one yet";
    auto const verdict = judge(sut, real.frame(11, 1.5F));
    EXPECT_FALSE(verdict.use);
    EXPECT_TRUE(verdict.contested);
    EXPECT_EQ(sut.contested(), 1U);
}

TEST(SvFirstLine, DoesNotDoubtACopy) {
    SvFirstLine sut = rules(kRefuse);
    Samples real;
    for (std::uint16_t n = 0; n < 100; ++n) {
        ASSERT_TRUE(judge(sut, real.frame(n, 1)).use);
        auto const copy = judge(sut, real.frame(n, 1));
        EXPECT_FALSE(copy.use);
        EXPECT_FALSE(copy.contested) << "a parallel network sends everything twice";
    }
    auto const late_copy = judge(sut, real.frame(97, 1));
    EXPECT_FALSE(late_copy.contested);
    auto const late_other = judge(sut, real.frame(96, 2));
    EXPECT_TRUE(late_other.contested);
    EXPECT_EQ(sut.contested(), 1U);
}

TEST(SvFirstLine, ReportsWithoutRefusing) {
    SvFirstLine sut = rules(kReport);
    Samples real, forged{1, 66};
    judge(sut, real.frame(0, 1));
    auto const verdict = judge(sut, forged.frame(1, 200));
    EXPECT_TRUE(verdict.use);
    EXPECT_NE(verdict.findings, 0U);
    EXPECT_EQ(sut.refused(), 0U);
    EXPECT_EQ(sut.counters()[0], 1U);
}

TEST(SvFirstLine, LooksAtNothingWhenItIsOff) {
    SvFirstLine sut = rules(FirstLineConfig::OnFinding::ignore);
    Samples real, forged{1, 66};
    judge(sut, real.frame(0, 1));
    EXPECT_EQ(judge(sut, forged.frame(0, 200)).findings, 0U);
}

TEST(SvFirstLine, JudgesTheArrivalOfAFrameOfTwoSamplesOnce) {
    SvFirstLine sut = rules(kRefuse, true);
    Samples two{2};
    for (int n = 0; n < 400; ++n) {
        SvFrame const& frame = two.frame(static_cast<std::uint16_t>(2 * n % 4800), 1);
        std::int64_t const arrival = std::int64_t{n} * 416'667;
        for (std::size_t place = 0; place < 2; ++place) {
            EXPECT_EQ(sut.judge(frame.header, frame.asdus[place], place, arrival).findings, 0U) << n << " " << place;
        }
    }
}

class Messages {
  public:
    explicit Messages(std::uint8_t source = 1) : frame_{make(source)} {}
    GooseFrame const& message(std::uint32_t st_num, std::uint32_t sq_num, bool value, std::uint32_t live_ms = 30) {
        frame_.set(0, Value::of(value));
        GooseState s;
        s.st_num = st_num;
        s.sq_num = sq_num;
        s.live_ms = live_ms;
        s.t = UtcTime::from_nanoseconds(1'575'158'400'000'000'000 + std::int64_t{st_num} * 1'000'000);
        EXPECT_TRUE(decode_goose(frame_.frame(s), decoded_));
        return decoded_;
    }

  private:
    static GooseTemplate make(std::uint8_t source) {
        GooseDescription d;
        d.gocb_ref = "IED/LLN0$GO$g";
        d.dat_set = "IED/LLN0$d";
        d.data_set.members.push_back(DataNode::leaf("trip", BasicType::boolean));
        return *GooseTemplate::create(address(source), d);
    }
    GooseTemplate frame_;
    GooseFrame decoded_;
};

TEST(GooseFirstLine, RefusesATripFromAnotherAddress) {
    GooseFirstLine sut{{.on_finding = kRefuse}, 1, 10, false, 30};
    Messages relay, forged{66};
    std::int64_t now = 1'575'158'400'000'000'000;
    for (std::uint32_t sq = 0; sq < 20; ++sq) {
        ASSERT_TRUE(sut.judge(relay.message(1, sq, false), now += 10'000'000).use);
    }
    EXPECT_FALSE(sut.judge(forged.message(2, 0, true), now += 1'000'000).use);
    EXPECT_TRUE(sut.judge(relay.message(1, 20, false), now += 9'000'000).use) << "and does not lose the real one by it";
    EXPECT_TRUE(sut.judge(relay.message(2, 0, true), now += 1'000'000).use) << "nor a real trip";
    EXPECT_EQ(sut.refused(), 1U);
}

TEST(GooseFirstLine, TakesARestartedPublisherWhenTheLastMessageHasExpired) {
    GooseFirstLine sut{{.on_finding = kRefuse}, 1, 10, false, 30};
    Messages relay;
    std::int64_t now = 1'575'158'400'000'000'000;
    ASSERT_TRUE(sut.judge(relay.message(7, 3, true), now).use);
    EXPECT_FALSE(sut.judge(relay.message(1, 0, false), now += 5'000'000).use) << "a replay looks just so";
    sut.expired();
    EXPECT_TRUE(sut.judge(relay.message(1, 1, false), now += 50'000'000).use);
}

TEST(GooseFirstLine, FindsNothingInATimeToLiveThatGrowsWithTheIntervalsAndSomethingInOneThatDoesNot) {
    GooseFirstLine sut{{.on_finding = kReport}, 4, 1000, false, 3000};
    Messages relay;
    std::int64_t now = 1'575'158'400'000'000'000;
    std::uint32_t sq = 0;
    for (std::uint32_t const live_ms : {12U, 24U, 48U, 96U, 192U, 384U, 768U, 1536U, 3000U, 3000U}) {
        EXPECT_EQ(sut.judge(relay.message(1, sq++, false, live_ms), now += live_ms * 333'333LL).findings, 0U)
            << live_ms;
    }
    EXPECT_NE(sut.judge(relay.message(1, sq++, false, 60'000), now += 1'000'000'000).findings, 0U);
}

TEST(FirstLineAlarm, TellsEachKindOnceAndGoesOffAfterAQuietInterval) {
    FirstLineAlarm sut;
    EXPECT_TRUE(sut.raise(1));
    EXPECT_FALSE(sut.raise(1));
    EXPECT_TRUE(sut.raise(2));
    EXPECT_FALSE(sut.settle()) << "something came in this interval";
    EXPECT_TRUE(sut.on());
    EXPECT_TRUE(sut.settle());
    EXPECT_FALSE(sut.on());
    EXPECT_FALSE(sut.settle());
    EXPECT_TRUE(sut.raise(1)) << "news again";
}

TEST(FirstLineCounters, HaveANameEach) {
    EXPECT_EQ(first_line_counters(true).size(), rules(kReport).counters().size() + 2);
    EXPECT_EQ(first_line_counters(false).size(), GooseFirstLine({}, 1, 10, false, 30).counters().size() + 1);
    EXPECT_EQ(first_line_counters(true).front(), "wrong_source");
    EXPECT_EQ(first_line_counters(true).back(), "contested");
}

} // namespace
} // namespace gridspace::gateways
