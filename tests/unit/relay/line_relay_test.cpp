// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/line_relay.hpp"
#include "agents/relay/waveform_window.hpp"

#include "tests/unit/relay/waves.hpp"

#include <gtest/gtest.h>

#include <limits>
#include <vector>

namespace gridspace::relay {
namespace {

using Kind = ElementParams::Kind;
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

RelayParams params(Kind kind = Kind::rms, double pickup_a = 30) {
    RelayParams p;
    p.element.kind = kind;
    p.element.pickup_a = pickup_a;
    p.element.slope_percent = 30;
    return p;
}

/// Healthy samples `from` .. `until` - 1.
void run_healthy(LineRelay& sut, std::int64_t from, std::int64_t until) {
    for (std::int64_t k = from; k < until; ++k) {
        sut.step(through(k));
        ASSERT_FALSE(sut.output().pickup) << k;
    }
}

/// An internal fault, steady: 300 A into the line at the `from` end, 80 A at the `to` end.
LineSample internal_fault(std::int64_t k) {
    return {k, good(wave(300, 0, k)), good(wave(80, 180, k))};
}

/// The published fault: three phases to ground in the middle of TL-2, from 12.66 A of load, phase a of the source at
/// its crest. Both ends are RL circuits of nearly the same X/R (0.148 ohm and 0.785 mH in all, 77 % and 23 % of the
/// current), so that the current has a closed form: a steady part and an offset that decays with L/R and starts from
/// the load.
LineSample published_fault(std::int64_t k) {
    constexpr double kOmega = 2 * std::numbers::pi * 60, kR = 0.148, kL = 0.785e-3, kLoad = 12.66;
    double const rms = 208 / std::numbers::sqrt3 / std::hypot(kR, kOmega * kL);
    double const angle = -std::atan2(kOmega * kL, kR) * 180 / std::numbers::pi;
    auto end = [&](double share, double sign) {
        Abc const load = wave(kLoad, -10, k), fault = wave(share * rms, angle, k);
        Abc const load0 = wave(kLoad, -10, 0), fault0 = wave(share * rms, angle, 0);
        Abc i = load;
        for (std::size_t p = 0; p < 3 && k > 0; ++p) {
            double const decay = std::exp(-static_cast<double>(k) / 4800 * kR / kL);
            i[p] = sign * fault[p] + (load0[p] - sign * fault0[p]) * decay;
        }
        return good(i);
    };
    return {k, end(0.77, 1), end(0.23, -1)};
}

TEST(LineRelay, PicksUpSevenSamplesAfterThePublishedFault) {
    LineRelay sut{params()};
    std::int64_t pickup = -1, trip = -1;
    for (std::int64_t k = -480; k < 480; ++k) {
        RelayOutput const& out = sut.step(published_fault(k));
        pickup = out.pickup && pickup < 0 ? k : pickup;
        trip = out.trip && trip < 0 ? k : trip;
    }
    EXPECT_EQ(pickup, 7); // 1.46 ms
    EXPECT_EQ(trip, pickup);
}

TEST(LineRelay, AgreesSampleBySampleWithTheEquationsWrittenOut) {
    LineRelay sut{params()};
    std::vector<LineSample> all;
    for (std::int64_t k = -160; k < 160; ++k) {
        all.push_back(published_fault(k));
        RelayOutput const& out = sut.step(all.back());
        if (all.size() < 80) {
            EXPECT_FALSE(out.evaluated);
            continue;
        }
        bool expected = false;
        for (std::size_t p = 0; p < 3; ++p) {
            long double from = 0, to = 0;
            for (std::size_t j = all.size() - 80; j < all.size(); ++j) {
                from += static_cast<long double>(all[j].from.i_a[p]) * all[j].from.i_a[p];
                to += static_cast<long double>(all[j].to.i_a[p]) * all[j].to.i_a[p];
            }
            auto const difference = static_cast<double>(std::fabs(std::sqrt(from / 80) - std::sqrt(to / 80)));
            EXPECT_NEAR(out.values.differential_a[p], difference, 1e-9) << k;
            expected = expected || difference >= 30;
        }
        EXPECT_EQ(out.pickup, expected) << k;
    }
}

TEST(LineRelay, DoesNotTripOnAHealthyLineWhateverTheCurrent) {
    for (Kind const kind : {Kind::rms, Kind::phasor}) {
        LineRelay sut{params(kind)};
        for (std::int64_t k = 0; k < 800; ++k) {
            sut.step(through(k, k < 400 ? 12.66 : 900)); // an external fault
            EXPECT_FALSE(sut.output().pickup);
        }
    }
}

TEST(LineRelay, WrongPolarityIsSeenByThePhasorElementOnly) {
    for (Kind const kind : {Kind::rms, Kind::phasor}) {
        RelayParams p = params(kind, 10);
        p.to_positive = Positive::into_line; // but the CT counts along the line
        LineRelay sut{p};
        for (std::int64_t k = 0; k < 80; ++k) {
            sut.step(through(k));
        }
        EXPECT_EQ(sut.output().pickup, kind == Kind::phasor);
    }
}

TEST(LineRelay, PolaritiesIntoTheLineAndAlongTheLineDecideAlike) {
    RelayParams along = params(Kind::phasor), into = along;
    into.to_positive = into.from_positive = Positive::into_line;
    LineRelay a{along}, b{into};
    for (std::int64_t k = -100; k < 100; ++k) {
        LineSample s = published_fault(k);
        a.step(s);
        for (double& i : s.to.i_a) {
            i = -i;
        }
        b.step(s);
        EXPECT_EQ(a.output().values, b.output().values);
        EXPECT_EQ(a.output().pickup, b.output().pickup);
    }
    EXPECT_TRUE(a.output().trip);
}

TEST(LineRelay, SealsInUntilItIsResetAndRefusesTheResetDuringPickup) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 80);
    std::int64_t k = 80;
    for (; k < 160; ++k) {
        sut.step(internal_fault(k));
    }
    ASSERT_TRUE(sut.output().trip);
    EXPECT_FALSE(sut.reset());
    for (; k < 320; ++k) { // both currents are zero after opening
        sut.step({k, good({}), good({})});
    }
    EXPECT_FALSE(sut.output().pickup);
    EXPECT_TRUE(sut.output().trip);
    EXPECT_TRUE(sut.reset());
    EXPECT_FALSE(sut.output().trip);
    run_healthy(sut, k, k + 160);
    EXPECT_FALSE(sut.output().trip);
}

TEST(LineRelay, WithoutSealInTheTripFallsWithThePickup) {
    RelayParams p = params();
    p.seal_in = false;
    LineRelay sut{p};
    run_healthy(sut, 0, 80);
    for (std::int64_t k = 80; k < 160; ++k) {
        sut.step(internal_fault(k));
    }
    ASSERT_TRUE(sut.output().trip);
    for (std::int64_t k = 160; k < 320; ++k) {
        sut.step({k, good({}), good({})});
    }
    EXPECT_FALSE(sut.output().trip);
}

TEST(LineRelay, ConfirmsForAsManySamplesAsConfigured) {
    RelayParams p = params();
    p.confirm_samples = 5;
    LineRelay plain{params()}, sut{p};
    std::int64_t pickup = -1, trip = -1;
    for (std::int64_t k = -100; k < 100; ++k) {
        plain.step(published_fault(k));
        sut.step(published_fault(k));
        pickup = plain.output().trip && pickup < 0 ? k : pickup;
        trip = sut.output().trip && trip < 0 ? k : trip;
    }
    EXPECT_EQ(trip, pickup + 4);
}

TEST(LineRelay, BridgesUpToThreeLostSamplesAndTripsWithTheFirstThatComes) {
    for (int lost = 1; lost <= 3; ++lost) {
        LineRelay sut{params()};
        std::int64_t trip = -1;
        for (std::int64_t k = -400; k < 100; ++k) {
            LineSample s = published_fault(k);
            s.to.present = k < 7 || k >= 7 + lost; // 7: where it would have picked up
            sut.step(s);
            if (!s.to.present) {
                EXPECT_EQ(sut.output().blocked, kToLost);
                EXPECT_FALSE(sut.output().pickup);
            }
            trip = sut.output().trip && trip < 0 ? k : trip;
        }
        EXPECT_EQ(trip, 7 + lost);
        EXPECT_EQ(sut.counters().interpolated, static_cast<std::uint64_t>(lost));
    }
}

TEST(LineRelay, LostSamplesOfAHealthyLineNeverTripWhateverTheirNumber) {
    for (Kind const kind : {Kind::rms, Kind::phasor}) {
        for (int lost = 1; lost < 100; ++lost) {
            LineRelay sut{params(kind, 2)}; // far more sensitive than anybody would set it
            for (std::int64_t k = 0; k < 400; ++k) {
                LineSample s = through(k);
                s.from.present = k < 150 || k >= 150 + lost;
                s.from.i_a = s.from.present ? s.from.i_a : Abc{};
                sut.step(s);
                ASSERT_FALSE(sut.output().pickup) << lost << " lost, at " << k;
            }
            EXPECT_EQ(sut.output().blocked, 0U);
        }
    }
}

TEST(LineRelay, FourLostSamplesBlockUntilTheWindowIsFullAgain) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 100);
    for (std::int64_t k = 100; k < 104; ++k) {
        LineSample s = through(k);
        s.from.present = false;
        sut.step(s);
    }
    std::int64_t k = 104;
    for (; k < 104 + 79; ++k) {
        sut.step(internal_fault(k));
        EXPECT_EQ(sut.output().blocked, kFilling);
        EXPECT_FALSE(sut.output().trip);
    }
    sut.step(internal_fault(k));
    EXPECT_EQ(sut.output().blocked, 0U);
    EXPECT_TRUE(sut.output().trip); // the fault is still there
}

TEST(LineRelay, AJumpOfTheIndexCountsAsLostSamples) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 100);
    sut.step(through(103)); // 100, 101, 102 never came
    EXPECT_EQ(sut.output().blocked, 0U);
    EXPECT_EQ(sut.counters().interpolated, 3U);
    sut.step(through(108)); // four
    EXPECT_EQ(sut.output().blocked, kFilling);
    EXPECT_EQ(sut.counters().from_missing, 7U);
}

TEST(LineRelay, RepeatedAndOldSamplesAreIgnored) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 100);
    ElementValues const before = sut.output().values;
    sut.step(internal_fault(99));
    sut.step(internal_fault(50));
    EXPECT_EQ(sut.output().values, before);
    EXPECT_EQ(sut.counters().stale, 2U);
}

TEST(LineRelay, UnusableSamplesBlockAndNeverTrip) {
    struct Case {
        char const* name;
        void (*spoil)(EndSample&);
        BlockReasons expected;
    };
    std::vector<Case> const cases{
        {"invalid", [](EndSample& s) { s.validity = Validity::invalid; }, kFromQuality},
        {"questionable", [](EndSample& s) { s.validity = Validity::questionable; }, kFromQuality},
        {"not a number", [](EndSample& s) { s.i_a[1] = kNan; }, kFromQuality},
        {"infinite", [](EndSample& s) { s.i_a[2] = -std::numeric_limits<double>::infinity(); }, kFromQuality},
        {"implausible", [](EndSample& s) { s.i_a[0] = 1e30; }, kFromQuality},
        {"test", [](EndSample& s) { s.test = true; }, kFromTest},
        {"simulated", [](EndSample& s) { s.simulated = true; }, kFromTest},
        {"local clock", [](EndSample& s) { s.synch = Synch::local; }, kFromSynch},
        {"free running", [](EndSample& s) { s.synch = Synch::none; }, kFromSynch},
    };
    for (Case const& c : cases) {
        LineRelay sut{params()};
        run_healthy(sut, 0, 100);
        for (std::int64_t k = 100; k < 200; ++k) {
            LineSample s = internal_fault(k);
            c.spoil(s.from);
            sut.step(s);
            EXPECT_NE(sut.output().blocked & c.expected, 0U) << c.name;
            EXPECT_FALSE(sut.output().pickup || sut.output().trip) << c.name;
        }
    }
}

TEST(LineRelay, SettingsDecideWhichDoubtfulSamplesAreUsed) {
    RelayParams p = params();
    p.accept_questionable = p.test_mode = true;
    p.required_synch = Synch::local;
    LineRelay sut{p};
    for (std::int64_t k = 0; k < 100; ++k) {
        LineSample s = internal_fault(k);
        s.from.validity = Validity::questionable;
        s.to.test = s.from.simulated = true;
        s.from.synch = Synch::local;
        sut.step(s);
    }
    EXPECT_EQ(sut.output().blocked, 0U);
    EXPECT_TRUE(sut.output().trip);
}

TEST(LineRelay, ADesynchronisedStreamEmptiesTheWindowAtOnce) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 100);
    LineSample s = through(100);
    s.to.synch = Synch::none;
    sut.step(s);
    EXPECT_EQ(sut.output().blocked, kToSynch | kFilling);
    run_healthy(sut, 101, 180);
    EXPECT_EQ(sut.output().blocked, kFilling);
    run_healthy(sut, 180, 181);
    EXPECT_EQ(sut.output().blocked, 0U);
}

TEST(LineRelay, OutOfServiceMeasuresAndNeverTrips) {
    RelayParams p = params();
    p.in_service = false;
    LineRelay sut{p};
    for (std::int64_t k = 0; k < 200; ++k) {
        sut.step(internal_fault(k));
        EXPECT_FALSE(sut.output().trip);
    }
    EXPECT_EQ(block_names(sut.output().blocked), "out_of_service");
    sut.set_in_service(true);
    EXPECT_TRUE(sut.step(internal_fault(200)).trip);
}

TEST(LineRelay, RestartsWithAnEmptyWindowAndKeepsTheSeal) {
    LineRelay sut{params()};
    run_healthy(sut, 1000, 1080);
    sut.restart();
    EXPECT_FALSE(sut.step(internal_fault(0)).pickup); // the indices start again
    for (std::int64_t k = 1; k < 79; ++k) {
        EXPECT_FALSE(sut.step(internal_fault(k)).trip);
    }
    EXPECT_TRUE(sut.step(internal_fault(79)).trip);
    sut.restart();
    EXPECT_TRUE(sut.step(through(80)).trip);
}

TEST(LineRelay, WithholdsTheTripUntilItIsPermitted) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 80);
    for (std::int64_t k = 80; k < 120; ++k) {
        sut.step(internal_fault(k), {false});
        EXPECT_FALSE(sut.output().trip);
    }
    EXPECT_TRUE(sut.output().withheld);
    sut.step(internal_fault(120), {true});
    EXPECT_TRUE(sut.output().trip);
    EXPECT_FALSE(sut.output().withheld);
    EXPECT_TRUE(sut.step(internal_fault(121), {false}).trip); // a permission taken away later changes nothing
}

TEST(LineRelay, TellsItsStoryInEvents) {
    LineRelay sut{params()};
    for (std::int64_t k = -100; k < 20; ++k) {
        sut.step(published_fault(k));
    }
    std::vector<RelayEvent> events;
    sut.events().drain([&](RelayEvent const& e) { events.push_back(e); });
    ASSERT_EQ(events.size(), 3U);
    EXPECT_EQ(events[0].kind, RelayEvent::Kind::unblock);
    EXPECT_EQ(events[0].index, -21); // 80 samples from -100
    EXPECT_EQ(events[1].kind, RelayEvent::Kind::pickup);
    EXPECT_EQ(events[2].kind, RelayEvent::Kind::trip);
    EXPECT_EQ(events[2].index, 7);
    EXPECT_FALSE(phase_names(events[2].phases).empty());
    EXPECT_EQ(sut.events().size(), 0U);
}

TEST(LineRelay, SaysOnceWhyItNeverBeganToWork) {
    LineRelay sut{params()};
    std::vector<RelayEvent> events;
    for (std::int64_t k = 0; k < 300; ++k) {
        LineSample s = through(k);
        s.from.synch = k >= 24 ? Synch::none : Synch::global; // 5 ms after the start
        s.to.present = k < 200 || k % 2 == 0;                 // comes and goes
        sut.step(s);
    }
    sut.events().drain([&](RelayEvent const& e) { events.push_back(e); });
    std::erase_if(events, [](RelayEvent const& e) { return e.kind == RelayEvent::Kind::window_emptied; });
    ASSERT_EQ(events.size(), 2U);
    EXPECT_EQ(events[0].kind, RelayEvent::Kind::block);
    EXPECT_EQ(events[0].index, 24);
    EXPECT_EQ(events[0].reasons, kFromSynch | kFilling);
    EXPECT_EQ(events[1].index, 201);
    EXPECT_EQ(events[1].reasons, kFromSynch | kToLost | kFilling);

    LineRelay never{params()};
    LineSample s = through(0);
    s.from.synch = s.to.synch = Synch::none;
    never.step(s);
    events.clear();
    never.events().drain([&](RelayEvent const& e) { events.push_back(e); });
    ASSERT_EQ(events.size(), 1U);
    EXPECT_EQ(block_names(events[0].reasons), "filling, from_synch, to_synch");
}

TEST(LineRelay, SaysAgainWhyItBlocksAfterItHasWorked) {
    LineRelay sut{params()};
    std::vector<std::int64_t> blocks;
    for (std::int64_t k = 0; k < 400; ++k) {
        LineSample s = through(k);
        bool const bad = (k >= 100 && k < 104) || (k >= 300 && k < 304); // one more than is bridged
        s.from.validity = bad ? Validity::invalid : Validity::good;
        sut.step(s);
    }
    sut.events().drain([&](RelayEvent const& e) {
        if (e.kind == RelayEvent::Kind::block) {
            blocks.push_back(e.index);
            EXPECT_EQ(e.reasons, kFromQuality | kFilling);
        }
    });
    EXPECT_EQ(blocks, (std::vector<std::int64_t>{103, 303}));
}

TEST(LineRelay, BlocksAndSaysSoWhenNothingComesAnyMore) {
    for (bool const lone_sample : {false, true}) { // the last sample of one end may have no partner
        LineRelay sut{params()};
        run_healthy(sut, 0, 100);
        if (lone_sample) {
            LineSample s = through(100);
            s.to.present = false;
            sut.step(s);
        }
        sut.events().drain([](RelayEvent const&) {});
        EXPECT_NE(sut.lost(kFromLost).blocked & kFromLost, 0U);
        EXPECT_NE(sut.lost(kToLost).blocked & (kFromLost | kToLost), 0U);
        BlockReasons told = 0;
        sut.events().drain([&](RelayEvent const& e) {
            EXPECT_EQ(e.kind, RelayEvent::Kind::block);
            told |= e.reasons;
        });
        EXPECT_EQ(told, kFromLost | kToLost);
        std::int64_t k = 400; // both come back, behind a long gap
        for (; k < 479; ++k) {
            EXPECT_EQ(sut.step(through(k)).blocked, kFilling) << k;
        }
        EXPECT_EQ(sut.step(through(k)).blocked, 0U);
    }
}

TEST(LineRelay, GoesOnAfterASilenceInWhichNothingWasLost) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 100);
    sut.lost(kFromLost | kToLost);
    EXPECT_EQ(sut.step(through(100)).blocked, 0U) << "late, and all there";
}

TEST(LineRelay, DropsThePickupWhenNothingComesAnyMoreAndKeepsTheSeal) {
    for (bool const seal_in : {false, true}) {
        RelayParams p = params();
        p.seal_in = seal_in;
        LineRelay sut{p};
        run_healthy(sut, 0, 80);
        for (std::int64_t k = 80; k < 200; ++k) {
            sut.step(internal_fault(k));
        }
        ASSERT_TRUE(sut.output().trip);
        RelayOutput const& out = sut.lost(kFromLost | kToLost);
        EXPECT_FALSE(out.pickup || out.evaluated);
        EXPECT_EQ(out.trip, seal_in);
    }
}

TEST(LineRelay, ABridgedGapHoldsTheTripAndALongerOneDropsIt) {
    for (int lost = 1; lost <= 4; ++lost) {
        RelayParams p = params();
        p.seal_in = false;
        LineRelay sut{p};
        run_healthy(sut, 0, 80);
        for (std::int64_t k = 80; k < 200; ++k) {
            sut.step(internal_fault(k));
        }
        ASSERT_TRUE(sut.output().trip);
        sut.events().drain([](RelayEvent const&) {});
        std::int64_t k = 200;
        for (; k < 200 + lost; ++k) {
            LineSample s = internal_fault(k);
            s.from.validity = k % 2 == 0 ? Validity::invalid : Validity::good; // a bad sample is as good as none
            s.to.present = k % 2 == 0;
            sut.step(s);
            bool const bridged = k < 203;
            EXPECT_EQ(sut.output().trip, bridged) << k;
            EXPECT_EQ(sut.output().pickup, bridged) << k;
            EXPECT_FALSE(sut.output().evaluated);
            EXPECT_NE(sut.output().blocked, 0U);
        }
        sut.step(internal_fault(k));
        EXPECT_EQ(sut.output().trip, lost <= 3);
        EXPECT_EQ(sut.output().blocked, lost <= 3 ? 0U : kFilling);
        EXPECT_EQ(sut.events().size(), lost <= 3 ? 0U : 3U); // restart, dropout, block
        EXPECT_EQ(sut.counters().trips, 1U);
    }
}

TEST(LineRelay, ATripDoesNotOutliveSynchronismTestOrServiceInAGap) {
    void (*const spoil[])(LineSample&, LineRelay&){
        [](LineSample& s, LineRelay&) { s.to.synch = Synch::none; },
        [](LineSample& s, LineRelay&) { s.to.test = true; },
        [](LineSample&, LineRelay& r) { r.set_in_service(false); },
    };
    for (auto const how : spoil) {
        RelayParams p = params();
        p.seal_in = false;
        LineRelay sut{p};
        for (std::int64_t k = 0; k < 200; ++k) {
            sut.step(internal_fault(k));
        }
        ASSERT_TRUE(sut.output().trip);
        LineSample s = internal_fault(200);
        s.from.present = false;
        sut.step(s);
        EXPECT_TRUE(sut.output().trip);
        s.index = 201;
        how(s, sut);
        sut.step(s);
        EXPECT_FALSE(sut.output().trip || sut.output().pickup);
    }
}

TEST(LineRelay, ConfirmationGoesOnBehindABridgedGapAndCountsOnlyWhatCame) {
    RelayParams p = params();
    p.confirm_samples = 20;
    for (int lost = 0; lost <= 3; ++lost) {
        LineRelay sut{p};
        std::int64_t trip = -1, confirmed = 0;
        for (std::int64_t k = -400; k < 100 && trip < 0; ++k) {
            LineSample s = published_fault(k);
            s.to.present = k < 15 || k >= 15 + lost; // amid the confirmation, that begins with 7
            sut.step(s);
            confirmed += sut.output().evaluated && sut.output().pickup ? 1 : 0;
            EXPECT_TRUE(s.to.present || !sut.output().trip);
            trip = sut.output().trip ? k : trip;
        }
        EXPECT_EQ(trip, 26 + lost);
        EXPECT_EQ(confirmed, 20);
        EXPECT_EQ(sut.counters().pickups, 1U);
    }
}

TEST(LineRelay, NoTripComesInAGapHoweverNearTheConfirmationWas) {
    RelayParams p = params();
    p.confirm_samples = 5;
    LineRelay sut{p};
    for (std::int64_t k = -400; k < 11; ++k) { // four of five
        sut.step(published_fault(k));
    }
    ASSERT_TRUE(sut.output().pickup);
    for (std::int64_t k = 11; k < 400; ++k) { // the stream is dead from now on
        LineSample s = published_fault(k);
        s.to.present = false;
        sut.step(s);
        EXPECT_FALSE(sut.output().trip) << k;
        EXPECT_EQ(sut.output().pickup, k < 14) << k;
    }
}

TEST(LineRelay, WritesNoEventAboutSamplesThatAreBridged) {
    LineRelay sut{params()};
    run_healthy(sut, 0, 80);
    sut.events().drain([](RelayEvent const&) {});
    for (std::int64_t k = 80; k < 400; ++k) {
        LineSample s = through(k);
        s.from.present = k % 10 != 0;
        sut.step(s);
        EXPECT_EQ(sut.output().blocked, k % 10 == 0 ? kFromLost : 0U);
    }
    EXPECT_EQ(sut.events().size(), 0U);
    EXPECT_EQ(sut.counters().interpolated, 32U);
}

TEST(EventLog, KeepsTheFirstEventsAndCountsTheRest) {
    EventLog sut{2};
    for (std::int64_t k = 0; k < 5; ++k) {
        sut.push({k, RelayEvent::Kind::pickup, 1, 0, {}});
    }
    std::vector<std::int64_t> taken;
    sut.drain([&](RelayEvent const& e) { taken.push_back(e.index); });
    EXPECT_EQ(taken, (std::vector<std::int64_t>{0, 1}));
    EXPECT_EQ(sut.dropped(), 3U);
}

TEST(WaveformWindow, KeepsTheSamplesAroundTheTrip) {
    LineRelay relay{params()};
    WaveformWindow sut{10, 5};
    bool complete = false, tripped = false;
    for (std::int64_t k = -100; k < 100 && !complete; ++k) {
        RelayOutput const& out = relay.step(published_fault(k));
        if (out.trip && !tripped) {
            sut.trigger();
            tripped = true;
        }
        complete = sut.push(published_fault(k), out);
    }
    ASSERT_TRUE(complete);
    std::vector<std::int64_t> indices;
    sut.drain([&](WaveformWindow::Row const& row) { indices.push_back(row.index); });
    ASSERT_EQ(indices.size(), 15U);
    EXPECT_EQ(indices.front(), 7 - 9);
    EXPECT_EQ(indices.back(), 7 + 5);
}

} // namespace
} // namespace gridspace::relay
