// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/stream_alignment.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

constexpr std::int64_t kPeriod = 208'333;

SvSubscription subscription(std::uint32_t wrap = 4800) {
    SvSubscription out;
    out.sv_id = "MU";
    out.wrap = wrap;
    return out;
}

TEST(SvSubscriber, FollowsTheCounterOverTheWrap) {
    SvSubscriber sut{subscription()};
    EXPECT_EQ(sut.receive(4798, 0).event, SvEvent::first);
    EXPECT_EQ(sut.receive(4799, kPeriod).event, SvEvent::in_order);
    auto const wrapped = sut.receive(0, 2 * kPeriod);
    EXPECT_EQ(wrapped.event, SvEvent::in_order);
    EXPECT_EQ(wrapped.index, 4800);
}

TEST(SvSubscriber, TellsLossFromDuplicateFromLateFromRestart) {
    SvSubscription s = subscription();
    s.max_gap = 100;
    SvSubscriber sut{s};
    sut.receive(1000, 0);
    auto const lost = sut.receive(1004, 4 * kPeriod);
    EXPECT_EQ(lost.event, SvEvent::lost);
    EXPECT_EQ(lost.lost, 3U);
    EXPECT_EQ(sut.receive(1004, 4 * kPeriod).event, SvEvent::duplicate);
    auto const late = sut.receive(1002, 5 * kPeriod);
    EXPECT_EQ(late.event, SvEvent::late);
    EXPECT_FALSE(late.accepted);
    EXPECT_EQ(late.index, 1002);
    EXPECT_EQ(sut.receive(3000, 6 * kPeriod).event, SvEvent::unconfirmed);
    auto const restart = sut.receive(3001, 7 * kPeriod);
    EXPECT_EQ(restart.event, SvEvent::restart);
    EXPECT_EQ(restart.index, 3001);
    EXPECT_EQ(sut.receive(0, 8 * kPeriod).event, SvEvent::unconfirmed);
    auto const back = sut.receive(1, 9 * kPeriod);
    EXPECT_EQ(back.event, SvEvent::restart);
    EXPECT_EQ(back.index % 4800, 1);
    EXPECT_GT(back.index, restart.index) << "indices never go back";
    EXPECT_EQ(sut.counters().lost, 2U) << "1001 and 1003; 1002 came late";
    EXPECT_EQ(sut.counters().of(SvEvent::duplicate), 1U);
}

TEST(SvSubscriber, FollowsAnUnknownPublisherThatSendsInHeapsOverItsWrap) {
    constexpr std::int64_t kSpacing = 250'000; // 4000 samples a second, in heaps of forty or so, the last one in time
    for (int const heap : {37, 40, 64}) {
        SvSubscription s = subscription(0);
        s.rate_hz = 4000;
        SvSubscriber sut{s};
        std::int64_t time = 0;
        for (int i = 0; i < 12'000; ++i) {
            std::int64_t const due = ((i / heap + 1) * heap - 1) * kSpacing;
            time = std::max(time + 5'000, due);
            ASSERT_TRUE(sut.receive(static_cast<std::uint16_t>(i % 4000), time).accepted) << heap << ' ' << i;
        }
        EXPECT_EQ(sut.counters().of(SvEvent::restart) + sut.counters().lost, 0U) << heap;
    }
}

TEST(SvSubscriber, ASingleForgedFrameMovesNothingHoweverManySamplesItHolds) {
    for (int const samples : {1, 2, 8}) {
        SvSubscriber sut{subscription()};
        std::int64_t time = 0;
        auto const frame = [&](int first) {
            time += samples * kPeriod / 2;
            SvEvent last{};
            for (int k = 0; k < samples; ++k) {
                last = sut.receive(static_cast<std::uint16_t>((first + k) % 4800), time).event;
            }
            time += samples * kPeriod - samples * kPeriod / 2;
            return last;
        };
        for (int first = 0; first < 960; first += samples) {
            EXPECT_NE(frame(first), SvEvent::unconfirmed);
        }
        time -= samples * kPeriod; // between two frames
        EXPECT_EQ(frame(3000), SvEvent::unconfirmed) << samples;
        EXPECT_EQ(frame(960), SvEvent::in_order);
        EXPECT_EQ(sut.counters().of(SvEvent::restart) + sut.counters().lost, 0U);
        EXPECT_EQ(frame(3000), SvEvent::unconfirmed);
        EXPECT_NE(frame(3000 + samples), SvEvent::unconfirmed) << "a second frame says so too";
    }
}

TEST(SvSubscriber, TakesFramesThatComeTwiceForCopiesHoweverManySamplesTheyHold) {
    for (int const samples : {1, 2, 4, 8, 16}) {
        SvSubscription s = subscription();
        s.late_window = 31;
        SvSubscriber sut{s};
        for (int first = 0; first < 9600; first += samples) {
            for (int copy = 0; copy < (first % 5 == 0 ? 2 : 1); ++copy) {
                for (int k = 0; k < samples; ++k) {
                    SvArrival const arrival =
                        sut.receive(static_cast<std::uint16_t>((first + k) % 4800), (first + samples) * kPeriod);
                    ASSERT_EQ(arrival.accepted, copy == 0);
                    ASSERT_EQ(arrival.event == SvEvent::duplicate, copy == 1) << first + k;
                }
            }
        }
        EXPECT_EQ(sut.counters().samples, 9600U);
        EXPECT_EQ(sut.counters().lost, 0U);
        EXPECT_EQ(sut.counters().of(SvEvent::late), 0U);
    }
}

TEST(SvSubscriber, TakesWhatIsOvertakenForLateAndNotForLost) {
    SvSubscriber sut{subscription()};
    auto const receive = [&](int first) {
        SvEvent out{};
        for (int k = 0; k < 4; ++k) {
            out = sut.receive(static_cast<std::uint16_t>(first + k), (first + 4) * kPeriod).event;
        }
        return out;
    };
    receive(0);
    receive(8);
    EXPECT_EQ(sut.counters().lost, 4U);
    EXPECT_EQ(sut.lost_for_good(), 0U) << "it may still come";
    EXPECT_EQ(receive(4), SvEvent::late);
    EXPECT_EQ(sut.counters().lost, 0U);
    EXPECT_EQ(receive(4), SvEvent::duplicate) << "a copy of what came late";
    EXPECT_EQ(receive(8), SvEvent::duplicate);
    receive(16);
    for (int first = 20; first < 40; first += 4) {
        EXPECT_EQ(sut.lost_for_good(), first < 32 ? 0U : first < 36 ? 3U : 4U) << first; // 15 is 16 behind 31
        receive(first);
    }
    EXPECT_EQ(sut.counters().lost, 4U);
    EXPECT_EQ(sut.counters().of(SvEvent::late), 4U);
    EXPECT_EQ(sut.counters().of(SvEvent::duplicate), 8U);
}

TEST(SvSubscriber, FindsNothingLostInWhatCameBeforeTheFirstSample) {
    SvSubscriber sut{subscription()};
    sut.receive(100, 0);
    EXPECT_EQ(sut.receive(98, kPeriod).event, SvEvent::late);
    EXPECT_EQ(sut.receive(98, kPeriod).event, SvEvent::duplicate);
    EXPECT_EQ(sut.counters().lost, 0U);
    EXPECT_EQ(sut.lost_for_good(), 0U);
}

TEST(SvSubscriber, LosesNoSecondInALongGap) {
    SvSubscription s = subscription();
    s.max_gap = 100'000;
    SvSubscriber sut{s};
    sut.receive(100, 0);
    auto const after = sut.receive(110, 3'000'000'000LL + 10 * kPeriod);
    EXPECT_EQ(after.index, 100 + 3 * 4800 + 10);
    EXPECT_EQ(after.lost, 3U * 4800 + 9);
}

TEST(SvSubscriber, LearnsTheWrapOfAnUnknownStream) {
    SvSubscriber sut{subscription(0)};
    EXPECT_EQ(sut.wrap(), 65536U);
    for (int i = 3900; i < 4000; ++i) {
        sut.receive(static_cast<std::uint16_t>(i), i * kPeriod);
    }
    EXPECT_EQ(sut.receive(0, 4000 * kPeriod).event, SvEvent::in_order);
    EXPECT_EQ(sut.wrap(), 4000U);
    EXPECT_EQ(sut.counters().lost, 0U);
}

TEST(SvSubscriber, TakesAPublisherThatIsStartedAnewForOneAndNotForAWrap) {
    SvSubscriber sut{subscription(0)};
    std::int64_t time = 0;
    for (std::uint16_t i = 0; i <= 776; ++i) {
        (void)sut.receive(i, time += kPeriod);
    }
    EXPECT_EQ(sut.receive(0, time += kPeriod).event, SvEvent::unconfirmed);
    EXPECT_EQ(sut.receive(1, time += kPeriod).event, SvEvent::restart);
    EXPECT_FALSE(sut.wrap_known());
    EXPECT_EQ(sut.receive(2, time += kPeriod).event, SvEvent::in_order);
}

TEST(SvSubscriber, IsMovedByNoSingleCounterThatIsForgedOrDamaged) {
    SvSubscriber sut{subscription()};
    std::int64_t time = 0;
    for (int i = 0; i < 1000; ++i) {
        SvArrival const arrival = sut.receive(static_cast<std::uint16_t>(i), time += kPeriod);
        EXPECT_TRUE(arrival.accepted);
        EXPECT_EQ(arrival.index, i);
        if (i % 100 == 50) {
            for (int const forged : {60000, 65535, i + 2000, i + 100, i + 4700}) {
                EXPECT_EQ(sut.receive(static_cast<std::uint16_t>(forged), time + 1000).event, SvEvent::unconfirmed)
                    << i << ' ' << forged;
            }
        }
    }
    EXPECT_EQ(sut.counters().lost, 0U);
    EXPECT_EQ(sut.counters().of(SvEvent::restart), 0U);
    EXPECT_EQ(sut.wrap(), 4800U);
}

TEST(SvSubscriber, BelievesAGapThatTimeExplainsAtOnce) {
    SvSubscriber sut{subscription()};
    sut.receive(100, 0);
    auto const plugged_in_again = sut.receive(1061, 961 * kPeriod);
    EXPECT_EQ(plugged_in_again.event, SvEvent::lost);
    EXPECT_EQ(plugged_in_again.lost, 960U);
    EXPECT_EQ(sut.receive(2000, 962 * kPeriod).event, SvEvent::unconfirmed) << "time does not explain this one";
    auto const confirmed = sut.receive(2001, 963 * kPeriod);
    EXPECT_EQ(confirmed.event, SvEvent::lost);
    EXPECT_EQ(confirmed.lost, 938U) << "1062 to 1999: the sample that waited was there";
}

TEST(SvSubscriber, FollowsAPeerThatCountsBeyondTheExpectedWrap) {
    SvSubscriber sut{subscription()};
    std::int64_t time = 0;
    std::uint64_t taken = 0;
    for (int i = 4700; i < 5000; ++i) {
        taken += sut.receive(static_cast<std::uint16_t>(i), time += kPeriod).accepted ? 1U : 0U;
    }
    EXPECT_EQ(taken, 299U);
    EXPECT_EQ(sut.counters().lost, 0U);
    EXPECT_EQ(sut.counters().of(SvEvent::restart), 0U);
}

TEST(SvSubscriber, LearnsAnOddWrapThatTheArrivalsConfirm) {
    SvSubscriber sut{subscription(0)};
    std::int64_t time = 0;
    for (std::uint16_t i = 0; i < 777; ++i) {
        (void)sut.receive(i, time += 1'000'000'000 / 777);
    }
    EXPECT_EQ(sut.receive(0, time + 1'000'000'000 / 777).event, SvEvent::in_order);
    EXPECT_EQ(sut.wrap(), 777U);
}

TEST(SvSubscriber, LearnsTheWrapWhenSamplesAreLostJustThere) {
    for (auto const& [last, next] : {std::pair{4798, 1}, {4799, 2}, {4797, 0}}) {
        SvSubscriber sut{subscription(0)};
        std::int64_t time = 0;
        for (int i = 100; i <= last; ++i) {
            (void)sut.receive(static_cast<std::uint16_t>(i), time += kPeriod);
        }
        SvArrival const arrival = sut.receive(static_cast<std::uint16_t>(next), time += 3 * kPeriod);
        EXPECT_EQ(sut.wrap(), 4800U);
        EXPECT_EQ(arrival.event, SvEvent::lost);
        EXPECT_EQ(arrival.lost, 2U);
    }
}

TEST(SvSubscriber, DoesNotLearnFromAPeerThatStartsAnewInEveryFrame) {
    SvSubscriber sut{subscription(0)};
    for (int i = 0; i < 200; ++i) {
        sut.receive(static_cast<std::uint16_t>(i % 16), i * kPeriod);
    }
    EXPECT_FALSE(sut.wrap_known());
}

/// Samples of a second's counter that wraps at `rate`, those of `kept` only.
template <class Kept>
SvSubscriber listened(int rate, int samples, Kept kept) {
    SvSubscriber sut{subscription(0)};
    for (int n = 0; n < samples; ++n) {
        if (kept(n)) {
            (void)sut.receive(static_cast<std::uint16_t>(n % rate), std::int64_t{n} * 1'000'000'000 / rate);
        }
    }
    return sut;
}

TEST(SvSubscriber, FollowsSlowStreamsOfAnUnknownRate) {
    for (int const rate : {10, 50, 80, 200, 1000}) {
        SvSubscriber const sut = listened(rate, 6 * rate, [&](int n) { return n <= 4 * rate || n > 4 * rate + 3; });
        EXPECT_EQ(sut.counters().lost, 3U) << rate;
        EXPECT_EQ(sut.counters().of(SvEvent::restart), 0U) << rate;
        EXPECT_EQ(sut.counters().of(SvEvent::duplicate) + sut.counters().of(SvEvent::late), 0U) << rate;
        EXPECT_NEAR(sut.arrivals().rate_hz(), rate, 1e-3 * rate);
        EXPECT_EQ(sut.wrap(), static_cast<std::uint32_t>(rate));
        ASSERT_TRUE(sut.deadline());
        EXPECT_NEAR(static_cast<double>(*sut.deadline()), 6e9 + 7e9 / rate, 1e3) << "eight periods behind the last";
    }
}

TEST(SvSubscriber, WhoListensFromJustBeforeTheSecondTakesTheFirstWrapForNoRestart) {
    for (int const rate : {10, 50, 80, 200}) {
        for (int before = 1; before <= 20; ++before) {
            std::int64_t const heap = before % 2 == 0 ? 3 : 1; // who listens got no processor meanwhile
            SvSubscriber sut{subscription(0)};
            std::int64_t const period = 1'000'000'000 / rate;
            for (int n = rate - before; n < 3 * rate; ++n) {
                std::int64_t const arrives =
                    (n + rate + heap - 1) / heap * heap * period + (n + rate + 2) % 3 * period / 20;
                (void)sut.receive(static_cast<std::uint16_t>((n + rate) % rate), arrives);
            }
            EXPECT_EQ(sut.counters().of(SvEvent::restart), 0U) << rate << ' ' << before;
            EXPECT_EQ(sut.counters().lost, 0U) << rate << ' ' << before;
            EXPECT_EQ(sut.wrap(), static_cast<std::uint32_t>(rate)) << before;
        }
    }
    SvSubscriber sut{subscription(0)}; // a second of 76 samples at 80 Hz: its publisher began anew
    std::int64_t now = 0;
    for (int const n : {73, 74, 75, 0, 1, 2}) {
        (void)sut.receive(static_cast<std::uint16_t>(n), now += 12'500'000);
    }
    EXPECT_EQ(sut.counters().of(SvEvent::restart), 1U);
}

TEST(SvSubscriber, CountsWhatIsLostInAnOutageOfAnUnknownStream) {
    for (int const rate : {80, 4000, 4800, 12800, 14400, 15360}) {
        for (int const before : {rate / 3, 3 * rate}) { // the wrap is not yet known; it is
            for (double const seconds : {0.3, 0.55, 1.0, 1.25, 10.0}) {
                int const lost = static_cast<int>(seconds * rate);
                SvSubscriber const sut =
                    listened(rate, before + lost + 2 * rate, [&](int n) { return n < before || n >= before + lost; });
                EXPECT_EQ(sut.counters().lost, static_cast<std::uint64_t>(lost)) << rate << ' ' << before;
                EXPECT_EQ(sut.counters().of(SvEvent::restart), 0U) << rate << ' ' << before << ' ' << seconds;
                EXPECT_NEAR(sut.arrivals().rate_hz(), rate, 1e-3 * rate);
            }
        }
    }
}

TEST(SvSubscriber, TakesAPublisherThatComesBackWithAnotherCounterForOneThatBeganAnew) {
    for (int const before : {2000, 12000}) {
        SvSubscriber sut = listened(4800, before, [](int) { return true; });
        std::int64_t const back = before * kPeriod + 2'000'000'000;
        int const counter = (before + 2400) % 4800; // half a second off
        (void)sut.receive(static_cast<std::uint16_t>(counter), back);
        (void)sut.receive(static_cast<std::uint16_t>(counter + 1), back + kPeriod);
        EXPECT_EQ(sut.counters().of(SvEvent::restart), 1U);
        EXPECT_EQ(sut.counters().lost, 0U);
    }
}

TEST(SvSubscriber, NoticesSilence) {
    SvSubscriber sut{subscription()};
    EXPECT_FALSE(sut.deadline());
    sut.receive(0, 0);
    ASSERT_TRUE(sut.deadline());
    EXPECT_NEAR(static_cast<double>(*sut.deadline()), 8 * 208'333.3, 1);
    EXPECT_FALSE(sut.expire(1'000'000));
    EXPECT_TRUE(sut.expire(2'000'000));
    EXPECT_FALSE(sut.expire(3'000'000));
    EXPECT_FALSE(sut.alive());
    EXPECT_EQ(sut.receive(20, 20 * kPeriod).event, SvEvent::lost);
    EXPECT_TRUE(sut.alive());
}

TEST(SvSubscriber, ChecksTheFrameAroundTheSample) {
    auto stream = SvTemplate::create(sv_address(), {asdu("MU", 12)});
    SvFrame frame;
    ASSERT_TRUE(decode_sv(stream->frame(), frame));
    SvSubscription s = subscription();
    s.sample_octets = 12;
    s.app_id = 0x4000;
    SvSubscriber sut{s};
    EXPECT_TRUE(sut.receive(frame.header, frame.asdus[0], 0).accepted);
    auto const event = [&](auto change) {
        SvFrame other = frame;
        other.asdus[0].smp_cnt = 1;
        change(other);
        return sut.receive(other.header, other.asdus[0], kPeriod).event;
    };
    EXPECT_EQ(event([](SvFrame& f) { f.header.app_id = 0x4001; }), SvEvent::identity_mismatch);
    EXPECT_EQ(event([](SvFrame& f) { f.asdus[0].conf_rev = 2; }), SvEvent::conf_rev_mismatch);
    EXPECT_EQ(event([](SvFrame& f) { f.asdus[0].sample = f.asdus[0].sample.first(8); }), SvEvent::size_mismatch);
    EXPECT_EQ(event([](SvFrame& f) { f.header.reserved1 = 0x8000; }), SvEvent::simulation_refused);
    EXPECT_EQ(event([](SvFrame&) {}), SvEvent::in_order);
}

TEST(SvSubscriber, PrefersSimulatedFramesWhenItIsAskedTo) {
    SvFrame frame;
    auto stream = SvTemplate::create(sv_address(), {asdu("MU", 12)});
    ASSERT_TRUE(decode_sv(stream->frame(), frame));
    SvSubscription s = subscription();
    s.simulation = true;
    SvSubscriber sut{s};
    std::uint16_t count = 0;
    auto const give = [&](bool simulated, std::uint32_t conf_rev = 1) {
        frame.header.reserved1 = simulated ? 0x8000 : 0;
        frame.asdus[0].smp_cnt = count++;
        frame.asdus[0].conf_rev = conf_rev;
        return sut.receive(frame.header, frame.asdus[0], count * kPeriod).accepted;
    };
    EXPECT_TRUE(give(false)) << "nobody simulates yet";
    EXPECT_FALSE(give(true, 2)) << "not of this stream";
    EXPECT_TRUE(give(false)) << "what was refused silences nobody";
    EXPECT_TRUE(give(true));
    EXPECT_FALSE(give(false)) << "the real one is silent while it is simulated";
    EXPECT_TRUE(give(true));
    EXPECT_EQ(sut.counters().of(SvEvent::simulation_refused), 1U);
}

TEST(ArrivalStatistics, GivesTheRateAsASlope) {
    ArrivalStatistics sut;
    SampleGrid const grid{Rational{4800}};
    for (std::int64_t i = 0; i <= 4800; ++i) {
        sut.add(i, grid.nanoseconds(i) + (i % 2) * 50'000);
    }
    EXPECT_NEAR(sut.rate_hz(), 4800, 1e-6);
    EXPECT_NEAR(static_cast<double>(sut.longest_ns()), 258'333, 1);
    EXPECT_NEAR(static_cast<double>(sut.shortest_ns()), 158'333, 1);
}

TEST(ArrivalStatistics, SamplesThatShareAFrameDoNotMakeTheSlopeSteeper) {
    ArrivalStatistics sut;
    SampleGrid const grid{Rational{4800}};
    for (std::int64_t frame = 0; frame < 100; ++frame) { // short: 7 samples too many would be 1 % of it
        for (std::int64_t k = 0; k < 8; ++k) {
            sut.add(frame * 8 + k, grid.nanoseconds(frame * 8 + 7));
        }
    }
    EXPECT_EQ(sut.count(), 100U);
    EXPECT_NEAR(sut.rate_hz(), 4800, 1e-3);
}

TEST(ArrivalStatistics, LeavesTheStepOfAClockThatIsSetBackOut) {
    ArrivalStatistics sut;
    for (std::int64_t i = 0; i < 200; ++i) {
        sut.add(i, i * kPeriod - (i >= 100 ? 10'000'000'000 : 0));
    }
    EXPECT_NEAR(sut.rate_hz(), 4800, 0.01);
    EXPECT_EQ(sut.shortest_ns(), kPeriod);
    EXPECT_EQ(sut.longest_ns(), kPeriod);
}

} // namespace
} // namespace gridspace::iec61850
