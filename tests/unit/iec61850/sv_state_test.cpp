// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/stream_alignment.hpp"
#include "gateways/iec61850/sv_publisher.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kPeriod = 208'333;

SvSubscription subscription(std::uint32_t wrap = 4800) {
    SvSubscription out;
    out.sv_id = "MU";
    out.wrap = wrap;
    return out;
}

TEST(SampleGrid, NeverAddsUpRoundedPeriods) {
    SampleGrid const sut{Rational{4800}};
    EXPECT_EQ(sut.nanoseconds(0), 0);
    EXPECT_EQ(sut.nanoseconds(1), 208'333);
    EXPECT_EQ(sut.nanoseconds(2), 416'667);
    EXPECT_EQ(sut.nanoseconds(3), 625'000);
    EXPECT_EQ(sut.nanoseconds(4800LL * 86'400 * 365), 86'400LL * 365 * 1'000'000'000);
    EXPECT_EQ(sut.nanoseconds(-1), -208'333);
}

TEST(SvPublisher, GivesAFrameOutWithItsLastSampleAndWrapsOnTheSecond) {
    SvPublisher sut{*SvTemplate::create(sv_address(), std::vector(2, asdu("MU", 4))), 4800};
    (void)sut.sample(4798);
    EXPECT_TRUE(sut.commit().empty());
    (void)sut.sample(4799);
    SvFrame frame;
    ASSERT_TRUE(decode_sv(sut.commit(), frame));
    EXPECT_EQ(frame.asdus[0].smp_cnt, 4798);
    EXPECT_EQ(frame.asdus[1].smp_cnt, 4799);
    (void)sut.sample(4800);
    (void)sut.sample(4801);
    ASSERT_TRUE(decode_sv(sut.commit(), frame));
    EXPECT_EQ(frame.asdus[0].smp_cnt, 0);
    EXPECT_EQ(sut.sent(), 2U);
}

TEST(SvPublisher, SendsOnlyFramesOfConsecutiveSamples) {
    SvPublisher sut{*SvTemplate::create(sv_address(), std::vector(2, asdu("MU", 4))), 4800};
    std::vector<std::pair<int, int>> frames;
    // From the middle of a frame; 7 to 9 are missing, then 16; 18 and 19 come twice; back to 4 of an earlier second.
    for (std::int64_t const index : {3, 4, 5, 6, 10, 11, 12, 13, 14, 15, 17, 18, 19, 18, 19, 20, 21, 4, 5}) {
        (void)sut.sample(index);
        SvFrame frame;
        if (auto const octets = sut.commit(); !octets.empty()) {
            ASSERT_TRUE(decode_sv(octets, frame));
            frames.emplace_back(frame.asdus[0].smp_cnt, frame.asdus[1].smp_cnt);
        }
    }
    EXPECT_THAT(frames, ElementsAre(std::pair{4, 5}, std::pair{10, 11}, std::pair{12, 13}, std::pair{14, 15},
                                    std::pair{18, 19}, std::pair{20, 21}, std::pair{4, 5}));
    EXPECT_EQ(sut.sent(), 7U);
}

TEST(SvPublisher, CountsTheFramesThatLackedASample) {
    SvPublisher sut{*SvTemplate::create(sv_address(), std::vector(4, asdu("MU", 4))), 4800};
    for (std::int64_t const index : {2, 3, 4, 5, 6, 7, 8, 9, 11, 12, 13, 14, 15, 18}) {
        (void)sut.sample(index);
        (void)sut.commit();
    }
    EXPECT_EQ(sut.sent(), 2U);
    EXPECT_EQ(sut.incomplete(), 1U) << "8 to 11: it began at 2, and 16 to 19 may still come";
}

TEST(SendSchedule, OwesEverySampleOnceHoweverLateItWakes) {
    SendSchedule sut{Rational{4800}, 1, 1'000'000};
    EXPECT_EQ(sut.owed(999'999, 16), 0U);
    EXPECT_EQ(sut.owed(1'000'000, 16), 1U);
    sut.sent(1);
    EXPECT_EQ(sut.late_wakeups(), 0U);
    std::int64_t frames = 1;
    std::int64_t const now = 1'000'000 + 100 * kPeriod;
    while (std::size_t const owed = sut.owed(now, 16)) {
        frames += static_cast<std::int64_t>(owed);
        sut.sent(owed);
    }
    EXPECT_EQ(frames, 100);
    EXPECT_EQ(sut.next_frame(), 100);
    EXPECT_GT(sut.late_wakeups(), 0U);
    EXPECT_NEAR(static_cast<double>(sut.worst_late_ns()), 99.0 * kPeriod, 100);
}

TEST(SendSchedule, SendsAFrameOfTwoSamplesAtTheTimeOfItsSecond) {
    SendSchedule const sut{Rational{4800}, 2, 0};
    EXPECT_EQ(sut.due_ns(), 208'333);
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

using Alignment = StreamAlignment<int>;
constexpr std::int64_t kTimeout = 3'150'000;

std::vector<std::pair<std::int64_t, std::pair<int, int>>> drain(Alignment& sut, std::int64_t now) {
    std::vector<std::pair<std::int64_t, std::pair<int, int>>> out;
    while (auto const pair = sut.pop(now)) {
        out.emplace_back(pair->index, std::pair{pair->first.value_or(-1), pair->second.value_or(-1)});
    }
    return out;
}

auto entry(std::int64_t index, int a, int b) {
    return std::pair{index, std::pair{a, b}};
}

TEST(StreamAlignment, PairsByCounterHoweverTheStreamsAreDelayed) {
    Alignment sut{kTimeout, 4800};
    for (int i = 10; i < 15; ++i) {
        sut.push(0, static_cast<std::uint16_t>(i), 2, i, i * kPeriod);
    }
    EXPECT_TRUE(drain(sut, 15 * kPeriod).empty());
    for (int i = 10; i < 13; ++i) {
        sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, 15 * kPeriod);
    }
    EXPECT_THAT(drain(sut, 15 * kPeriod), ElementsAre(entry(10, 10, 110), entry(11, 11, 111), entry(12, 12, 112)));
}

TEST(StreamAlignment, GivesALostSampleAsAHoleAsSoonAsItIsCertain) {
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 1, 0);
    sut.push(1, 0, 2, 2, 0);
    sut.push(0, 1, 2, 3, kPeriod);
    EXPECT_THAT(drain(sut, kPeriod), ElementsAre(entry(0, 1, 2)));
    sut.push(1, 2, 2, 4, 2 * kPeriod); // stream 1 has no sample 1
    EXPECT_THAT(drain(sut, 2 * kPeriod), ElementsAre(entry(1, 3, -1)));
    sut.push(0, 2, 2, 5, 2 * kPeriod);
    EXPECT_THAT(drain(sut, 2 * kPeriod), ElementsAre(entry(2, 5, 4)));
    EXPECT_EQ(sut.counters().second_missing, 1U);
}

TEST(StreamAlignment, DoesNotWaitForAPartnerLongerThanItsTimeout) {
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 7, 1'000);
    EXPECT_EQ(sut.deadline(), 1'000 + kTimeout);
    EXPECT_TRUE(drain(sut, kTimeout).empty());
    EXPECT_THAT(drain(sut, kTimeout + 1'000), ElementsAre(entry(0, 7, -1)));
    sut.push(1, 0, 2, 8, kTimeout + 2'000);
    EXPECT_TRUE(drain(sut, kTimeout + 2'000).empty());
    EXPECT_EQ(sut.counters().too_late, 1U);
}

TEST(StreamAlignment, GivesOutWhatIsAloneHoweverManySamplesPassWithinTheTimeout) {
    for (std::uint32_t const rate : {4800U, 15'360U, 65'535U}) {
        std::int64_t const period = 1'000'000'000 / rate;
        Alignment sut{20'000'000, rate};
        std::int64_t expected = 0;
        for (std::int64_t i = 0; i < rate; ++i) {
            sut.push(0, static_cast<std::uint16_t>(i), 2, 1, i * period);
            for (auto const& [index, pair] : drain(sut, i * period)) {
                ASSERT_EQ(index, expected++);
                ASSERT_EQ(pair, (std::pair{1, -1}));
                ASSERT_GE((i - index) * period, 20'000'000);
            }
        }
        EXPECT_NEAR(static_cast<double>(expected), 0.98 * rate, 2) << "all but those of the last 20 ms";
        EXPECT_EQ(sut.counters().restarts, 0U);
    }
}

/// Two frames of four samples of stream 0 as far as 8, of stream 1 without those from 4 on.
Alignment one_frame_missing(std::int64_t bridged) {
    Alignment sut{kTimeout, 4800, 0, {2 * 4 * kPeriod, bridged}};
    for (int first = 0; first < 12; first += 4) {
        for (int i = first; i < first + 4; ++i) {
            sut.push(0, static_cast<std::uint16_t>(i), 2, i, (first + 4) * kPeriod);
            if (first != 4) {
                sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, (first + 4) * kPeriod);
            }
        }
    }
    return sut;
}

TEST(StreamAlignment, WaitsForAFrameThatWasOvertaken) {
    Alignment sut = one_frame_missing(3);
    EXPECT_EQ(drain(sut, 12 * kPeriod).size(), 4U);
    EXPECT_EQ(sut.deadline(), 12 * kPeriod + 8 * kPeriod);
    for (int i = 4; i < 8; ++i) {
        sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, 12 * kPeriod + 1);
        EXPECT_THAT(drain(sut, 12 * kPeriod + 1), testing::Contains(entry(i, i, 100 + i)));
    }
    EXPECT_EQ(sut.counters().pairs, 12U) << "what came behind it waited no longer";
    EXPECT_EQ(sut.counters().second_missing + sut.counters().too_late, 0U);
}

TEST(StreamAlignment, GivesAFrameUpThatDoesNotComeLateEither) {
    Alignment sut = one_frame_missing(3);
    EXPECT_EQ(drain(sut, 20 * kPeriod - 1).size(), 4U);
    auto const out = drain(sut, 20 * kPeriod);
    ASSERT_EQ(out.size(), 8U);
    EXPECT_EQ(out[3], entry(7, 7, -1));
    EXPECT_EQ(out[4], entry(8, 8, 108));
}

TEST(StreamAlignment, DoesNotWaitForWhatIsBridged) {
    Alignment sut = one_frame_missing(4);
    EXPECT_EQ(drain(sut, 12 * kPeriod).size(), 12U);
}

TEST(StreamAlignment, DoesNotGiveAHoleUpBeforeTheOtherStreamIsThere) {
    Alignment sut{kTimeout, 4800, 0, {2 * kPeriod, 3}};
    for (int i = 0; i < 10; ++i) {
        if (i < 4 || i == 9) {
            sut.push(0, static_cast<std::uint16_t>(i), 2, i, i * kPeriod);
        }
    }
    std::int64_t const late = 13 * kPeriod; // stream 1 is on a slower way
    EXPECT_TRUE(drain(sut, late).empty());
    for (int i = 0; i < 10; ++i) {
        sut.push(1, static_cast<std::uint16_t>(i), 2, 100 + i, late);
    }
    auto const out = drain(sut, late);
    ASSERT_EQ(out.size(), 10U);
    EXPECT_EQ(out[4], entry(4, -1, 104));
    EXPECT_EQ(sut.counters().too_late, 0U);
}

TEST(StreamAlignment, CountsHolesOfBothStreamsThatFollowEachOther) {
    Alignment sut{kTimeout, 4800, 0, {8 * kPeriod, 3}};
    for (int i = 0; i < 8; ++i) { // 1 and 2 of one stream, 3 and 4 of the other one: four in a row
        for (std::size_t stream = 0; stream < 2; ++stream) {
            if (i == 0 || i > 4 || (i < 3) != (stream == 0)) {
                sut.push(stream, static_cast<std::uint16_t>(i), 2, i, i * kPeriod);
            }
        }
        drain(sut, i * kPeriod);
    }
    EXPECT_GT(sut.counters().pairs, 1U) << "the first holes are bridged as far as anybody knows";
    EXPECT_LT(sut.counters().pairs, 8U) << "the fourth one is not";
    drain(sut, 5 * kPeriod + 8 * kPeriod);
    EXPECT_EQ(sut.counters().pairs, 8U);
}

TEST(StreamAlignment, JoinsStreamsOnBothSidesOfTheWrap) {
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 1, 0); // already in the new second
    sut.push(1, 4799, 2, 2, 0);
    sut.push(1, 0, 2, 3, kPeriod);
    auto const pairs = drain(sut, kPeriod);
    ASSERT_EQ(pairs.size(), 2U);
    EXPECT_EQ(pairs[0].second, (std::pair{-1, 2}));
    EXPECT_EQ(pairs[1].second, (std::pair{1, 3}));
}

TEST(StreamAlignment, SaysWhetherTheClocksAreTheSame) {
    EXPECT_TRUE(same_clock(2, 2));
    EXPECT_TRUE(same_clock(1, 1));
    EXPECT_TRUE(same_clock(17, 17));
    EXPECT_FALSE(same_clock(0, 0));
    EXPECT_FALSE(same_clock(1, 2));
    EXPECT_FALSE(same_clock(17, 18));
    EXPECT_FALSE(same_clock(3, 3)) << "reserved";
    Alignment sut{kTimeout, 4800};
    sut.push(0, 0, 2, 1, 0);
    sut.push(1, 0, 0, 1, 0);
    EXPECT_FALSE(sut.pop(0)->coherent());
}

TEST(StreamAlignment, HoldsAPairBackAndShowsItMeanwhile) {
    Alignment sut{kTimeout, 4800, 1};
    std::uint16_t const last = 4799;
    sut.push(0, last, 2, 1, 0, {.restarted = true});
    sut.push(1, last, 2, 2, 0, {.restarted = true});
    EXPECT_FALSE(sut.pop(0));
    ASSERT_NE(sut.waiting(0, last), nullptr);
    *sut.waiting(0, last) = 7;
    EXPECT_EQ(sut.waiting(0, 0), nullptr) << "not here yet";
    sut.push(0, 0, 2, 3, kPeriod);
    EXPECT_FALSE(sut.pop(kPeriod)) << "the other stream may still say something";
    sut.push(1, 0, 2, 4, kPeriod);
    auto const pair = sut.pop(kPeriod);
    ASSERT_TRUE(pair);
    EXPECT_EQ(*pair->first, 7);
    EXPECT_EQ(sut.waiting(0, last), nullptr) << "given out";
    EXPECT_NE(sut.waiting(0, 0), nullptr) << "behind the wrap";
    auto const by_time = sut.pop(kPeriod + kTimeout);
    ASSERT_TRUE(by_time) << "nothing waits for ever";
    EXPECT_EQ(*by_time->second, 4);
}

TEST(StreamAlignment, BeginsAnewAfterAJumpOfBothStreams) {
    Alignment sut{kTimeout, 4800};
    for (std::size_t stream : {0U, 1U}) {
        sut.push(stream, 0, 2, 1, 0);
    }
    EXPECT_EQ(drain(sut, 0).size(), 1U);
    for (std::size_t stream : {0U, 1U}) {
        sut.push(stream, 2000, 2, 5, kPeriod, {.restarted = true});
    }
    EXPECT_THAT(drain(sut, kPeriod), ElementsAre(entry(2000, 5, 5)));
}

TEST(StreamAlignment, JoinsAStreamThatWasSilentForMoreThanHalfOfAWrap) {
    Alignment sut{kTimeout, 4800};
    for (std::int64_t i = 0; i <= 3400; ++i) {
        auto const count = static_cast<std::uint16_t>(i);
        sut.push(0, count, 2, 1, i * kPeriod);
        if (i == 0 || i == 3400) {
            sut.push(1, count, 2, 2, i * kPeriod, {.samples = i == 0 ? 1 : 3400});
        }
        if (i < 3400) {
            drain(sut, i * kPeriod);
        }
    }
    EXPECT_EQ(drain(sut, 3400 * kPeriod).back(), entry(3400, 1, 2));
    EXPECT_EQ(sut.counters().too_late, 0U);
}

TEST(StreamAlignment, GoesOnBehindASilenceOfBothStreamsAndNotBesideIt) {
    for (std::int64_t const silent : {2000, 3000, 4800, 8000, 9600}) {
        bool const restarted = silent > 4800; // as a subscriber judges it
        Alignment sut{kTimeout, 4800};
        for (std::size_t stream : {0U, 1U}) {
            sut.push(stream, 7, 2, 1, 0);
        }
        EXPECT_THAT(drain(sut, 0), ElementsAre(entry(7, 1, 1)));
        for (std::size_t stream : {0U, 1U}) {
            sut.push(stream, static_cast<std::uint16_t>((7 + silent) % 4800), 2, 2, silent * kPeriod,
                     {silent, restarted});
        }
        EXPECT_THAT(drain(sut, silent * kPeriod), ElementsAre(entry(7 + silent, 2, 2))) << silent;
    }
}

TEST(SampleHold, BridgesOneSampleAndNotTwo) {
    using State = SampleHold::State;
    SampleHold sut{1, 3};
    EXPECT_EQ(sut.step(true), State::invalid) << "nothing is known about the stream yet";
    sut.step(true);
    EXPECT_EQ(sut.step(true), State::good);
    EXPECT_EQ(sut.step(false), State::held);
    EXPECT_EQ(sut.step(true), State::good);
    EXPECT_EQ(sut.step(false), State::held);
    EXPECT_EQ(sut.step(false), State::invalid);
    EXPECT_EQ(sut.step(true), State::invalid);
    EXPECT_EQ(sut.step(true), State::invalid);
    EXPECT_EQ(sut.step(true), State::good);
}

} // namespace
} // namespace gridspace::iec61850
