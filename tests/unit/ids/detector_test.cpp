// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/sample_attack.hpp"
#include "agents/relay/line_relay.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/detector/line_detector.hpp"
#include "ids/training/train.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gridspace::ids {
namespace {

SyntheticParams quiet_grid() {
    SyntheticParams s;
    s.noise_percent = {0.05, 0.2};
    s.harmonics_percent = 0; // the oscillator knows none
    s.frequency_spread_hz = 0.1;
    s.nominal_peak_a = 18;
    s.fault = {3, 20};
    return s;
}

/// The recommended forecaster, trained on the test grid.
Model const& autoregression() {
    static Model const model = [] {
        std::vector<LineWaveform> recordings;
        SyntheticParams grid = quiet_grid();
        grid.noise_percent = {0, 0.5};
        for (std::uint64_t n = 0; n < 30; ++n) {
            recordings.push_back(synthesise(grid, static_cast<Situation>(n % 10), 99, n));
        }
        Model like;
        like.name = like.kind = "ar";
        like.window = 20;
        like.rate_hz = 4800;
        like.frequency_hz = 60;
        WindowParams windows;
        windows.count = 20'000;
        TrainParams training;
        training.epochs = 10;
        training.threads = 1;
        return *train(draw_windows(recordings, windows, 1), like, training, 1);
    }();
    return model;
}

DetectorParams params(Mode mode) {
    DetectorParams p;
    p.guard.mode = mode;
    p.guard.threshold.of = mode == Mode::supervise ? ThresholdParams::Of::adaptive : ThresholdParams::Of::nominal_peak;
    p.guard.threshold.nominal_peak_a = 18;
    return p;
}

relay::RelayParams phasor_relay() {
    relay::RelayParams p;
    p.element.kind = relay::ElementParams::Kind::phasor;
    p.element.pickup_a = 0.3 * 18 / std::sqrt(2.0);
    return p;
}

/// A relay with a detector in front, as the program couples them.
struct Protection {
    explicit Protection(DetectorParams const& p, Model const& model = oscillator(4800, 60))
        : detector{model, p}, relay{phasor_relay()} {}

    void step(std::int64_t k, Abc const& from, Abc const& to, bool from_received = true) {
        LineVerdict const& v = detector.step(k, {from, from_received}, {to, true}, relay.output().pickup);
        relay::LineSample s{k, {}, {}};
        s.from.i_a = v.from_accepted_a;
        s.from.present = from_received;
        s.to.i_a = v.to_accepted_a;
        s.to.present = true;
        relay.step(s, {v.granted});
        if (relay.output().trip && trip < 0) {
            trip = k;
        }
    }
    void run(LineWaveform const& w) {
        for (std::size_t k = 0; k < w.size(); ++k) {
            step(static_cast<std::int64_t>(k), w.from[k], w.to[k]);
        }
    }
    LineDetector detector;
    relay::LineRelay relay;
    std::int64_t trip{-1};
};

attacker::SampleAttack masquerade(std::int64_t from, double peak_a) {
    attacker::SampleAttackParams a;
    a.name = "masquerade";
    a.kind = attacker::SampleAttackParams::Kind::masquerade;
    a.channels = 7;
    a.from = from;
    a.until = from + 2000;
    a.peak_a = peak_a;
    a.angle_deg = 40;
    return *attacker::SampleAttack::create(a, 1);
}

TEST(Threshold, IsRelativeToWhatIsConfigured) {
    using Of = ThresholdParams::Of;
    auto limit = [](Of of, double raw) {
        ThresholdParams p;
        p.of = of;
        p.nominal_peak_a = 10;
        Threshold sut{p};
        for (int k = 0; k < 80; ++k) {
            sut.update(k == 40 ? 30 : 1, -1);
        }
        for (int k = 0; k < 5000; ++k) { // silence
            sut.update(k % 80 == 40 ? 30 : 1, 0);
        }
        return sut.limit_a(raw);
    };
    EXPECT_DOUBLE_EQ(limit(Of::instantaneous, -4), 0.08);
    EXPECT_DOUBLE_EQ(limit(Of::nominal_peak, -4), 0.2);
    EXPECT_DOUBLE_EQ(limit(Of::running_peak, -4), 0.6);
    EXPECT_DOUBLE_EQ(limit(Of::larger_peak, -4), 0.6);
    EXPECT_DOUBLE_EQ(limit(Of::adaptive, -4), 0.6);
}

TEST(Threshold, TheAdaptiveOneFollowsTheNoiseUpToItsCeiling) {
    ThresholdParams p;
    p.nominal_peak_a = 10;
    Threshold sut{p};
    for (int k = 0; k < 5000; ++k) {
        sut.update(10, 0.05); // mean error 0.5 %, sigma 0.625 %
    }
    EXPECT_NEAR(sut.sigma_percent(), 0.625, 0.01);
    EXPECT_NEAR(sut.limit_a(0), 10 * 0.0375, 0.01);
    for (int k = 0; k < 5000; ++k) {
        sut.update(10, 5);
    }
    EXPECT_NEAR(sut.limit_a(0), 10 * 0.045, 1e-12);
    EXPECT_NEAR(sut.sigma_percent(), 125 * 0.0075, 1e-9);
}

TEST(RunningPeak, IsTheLargestOfTheLastValues) {
    RunningPeak sut{3};
    std::vector<double> const in{1, -5, 2, 3, 1, 0, 0, 0}, expected{1, 5, 5, 5, 3, 3, 1, 0};
    for (std::size_t k = 0; k < in.size(); ++k) {
        sut.push(in[k]);
        EXPECT_EQ(sut.value(), expected[k]) << k;
    }
}

TEST(StreamGuard, PaperModeReplacesAnIsolatedFakeByItsForecast) {
    LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 1, 1);
    StreamGuard sut{autoregression(), params(Mode::paper).guard};
    for (std::int64_t k = 0; k < 200; ++k) {
        Abc i = w.from[static_cast<std::size_t>(k)];
        double const truth = i[0];
        i[0] = k == 150 ? truth + 8 : truth;
        StreamVerdict const& v = sut.step(k, i);
        EXPECT_EQ(v.phases[0].flagged, k == 150) << k;
        EXPECT_NEAR(v.phases[0].accepted_a, truth, 0.3) << k;
        EXPECT_FALSE(v.phases[1].flagged);
    }
    EXPECT_EQ(sut.counters().replaced, 1U);
}

/// A recording whose current is tripled at sample 150, for good.
LineWaveform stepped() {
    SyntheticParams grid = quiet_grid();
    grid.noise_percent = {0.01, 0.02};
    LineWaveform w = synthesise(grid, Situation::quiet, 1, 1);
    for (std::size_t k = 150; k < w.size(); ++k) {
        for (double& x : w.from[k]) {
            x *= 3;
        }
    }
    return w;
}

TEST(StreamGuard, HoldOffBelievesTheSamplesAfterKReplacements) {
    GuardParams p = params(Mode::hold_off).guard;
    p.hold_off_samples = 4;
    StreamGuard sut{autoregression(), p};
    LineWaveform const w = stepped();
    for (std::int64_t k = 0; k < 300; ++k) {
        StreamVerdict const& v = sut.step(k, w.from[static_cast<std::size_t>(k)]);
        if (k >= 150 + 24) {
            EXPECT_EQ(v.accepted_a(), w.from[static_cast<std::size_t>(k)]) << k;
        }
    }
    EXPECT_GE(sut.counters().replaced, 4U);
    EXPECT_FALSE(sut.locked_out());
}

TEST(StreamGuard, PaperModeLocksOutOnAStepThatStaysAndSaysSo) {
    StreamGuard sut{autoregression(), params(Mode::paper).guard};
    LineWaveform const w = stepped();
    for (std::int64_t k = 0; k < 900; ++k) {
        sut.step(k, w.from[static_cast<std::size_t>(k)]);
    }
    EXPECT_TRUE(sut.locked_out());
    EXPECT_GT(sut.counters().flagged, 600U);
    EXPECT_LT(sut.counters().open_flagged, 40U); // the forecaster itself follows at once
}

TEST(StreamGuard, LostSamplesDoNotShiftTheWindow) {
    LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 1, 2);
    for (int lost = 1; lost <= 10; ++lost) {
        StreamGuard sut{autoregression(), params(Mode::monitor).guard};
        for (std::int64_t k = 0; k < 400; ++k) {
            if (k >= 200 && k < 200 + lost) {
                if (k % 2 == 0) { // told, or simply not there
                    EXPECT_FALSE(sut.step_lost(k).ready);
                }
                continue;
            }
            StreamVerdict const& v = sut.step(k, w.from[static_cast<std::size_t>(k)]);
            EXPECT_FALSE(v.any_flagged()) << lost << " lost, at " << k;
            if (lost > 3 && k == 200 + lost) {
                EXPECT_FALSE(v.ready);
            }
        }
        EXPECT_EQ(sut.counters().restarts, lost > 3 ? 1U : 0U) << lost;
    }
}

TEST(StreamGuard, SamplesThatAreNotNumbersAreLostOnes) {
    LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 1, 3);
    StreamGuard sut{autoregression(), params(Mode::paper).guard};
    for (std::int64_t k = 0; k < 300; ++k) {
        Abc i = w.from[static_cast<std::size_t>(k)];
        if (k == 150) {
            i[1] = std::numeric_limits<double>::quiet_NaN();
        }
        StreamVerdict const& v = sut.step(k, i);
        EXPECT_EQ(v.ready, k >= 20 && k != 150);
        EXPECT_FALSE(v.any_flagged());
    }
    EXPECT_EQ(sut.counters().filled, 1U);
}

TEST(Supervisor, PermitsFaultsFedFromBothEndsWithoutDelayAndOthersAfterTwentyMilliseconds) {
    for (double const radial : {0.0, 1.0}) {
        SyntheticParams grid = quiet_grid();
        grid.radial_share = radial;
        int at_once = 0, faults = 0;
        for (auto const situation : {Situation::internal_3ph, Situation::internal_2ph, Situation::internal_1ph}) {
            for (std::uint64_t n = 0; n < 20; ++n, ++faults) {
                LineWaveform const w = synthesise(grid, situation, 11, n);
                Protection with{params(Mode::supervise)}, without{params(Mode::monitor)};
                with.run(w);
                without.run(w);
                ASSERT_GE(without.trip, w.event);
                ASSERT_GE(with.trip, w.event) << w.name;
                EXPECT_LE(with.trip - without.trip, 96) << w.name;
                at_once += with.trip == without.trip ? 1 : 0;
            }
        }
        EXPECT_GE(at_once, radial > 0 ? faults / 3 : faults * 95 / 100);
    }
}

TEST(Supervisor, WithholdsTheTripOnAForgeryOfOneStreamAndRaisesTheAlarm) {
    DetectorParams p = params(Mode::supervise);
    p.supervisor.on_unconfirmed = SupervisorParams::OnUnconfirmed::block;
    for (std::uint64_t n = 0; n < 10; ++n) {
        LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 3, n);
        attacker::SampleAttack attack = masquerade(700 + static_cast<std::int64_t>(n), 90);
        Protection sut{p}, unprotected{params(Mode::monitor)};
        for (std::size_t k = 0; k < w.size(); ++k) {
            auto const index = static_cast<std::int64_t>(k);
            Abc const sent = attack.apply(index, w.from[k]).sent_a;
            sut.step(index, sent, w.to[k]);
            unprotected.step(index, sent, w.to[k]);
        }
        EXPECT_GE(unprotected.trip, 0); // the negative control
        EXPECT_EQ(sut.trip, -1);
        EXPECT_TRUE(sut.relay.output().withheld);
        EXPECT_NE(sut.detector.verdict().alarms & kUnconfirmed, 0U);
        EXPECT_GE(sut.detector.supervisor().alarms(), 1U);
    }
}

TEST(Supervisor, InDelayModeALastingForgeryTripsAfterTwentyMilliseconds) {
    LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 3, 1);
    attacker::SampleAttack attack = masquerade(700, 90), again = masquerade(700, 90);
    Protection sut{params(Mode::supervise)}, unprotected{params(Mode::monitor)};
    for (std::size_t k = 0; k < w.size(); ++k) {
        auto const index = static_cast<std::int64_t>(k);
        sut.step(index, attack.apply(index, w.from[k]).sent_a, w.to[k]);
        unprotected.step(index, again.apply(index, w.from[k]).sent_a, w.to[k]);
    }
    EXPECT_EQ(sut.trip - unprotected.trip, 96);
}

TEST(Supervisor, SaysWithin100MsThatAStandingDifferenceKeepsItFromConfirmingFaults) {
    for (double const ratio :
         {1.0, 1.05, 1.3}) { // of a current transformer; up to 11 % of the nominal current are taken away
        LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 3, 1);
        Protection sut{params(Mode::supervise)};
        std::int64_t said = -1, usable = -1;
        for (std::size_t k = 0; k < w.size(); ++k) {
            auto const index = static_cast<std::int64_t>(k);
            Abc from = w.from[k];
            for (double& i : from) {
                i *= ratio;
            }
            sut.step(index, from, w.to[k]);
            usable = usable < 0 && sut.detector.from().verdict().ready ? index : usable;
            if (said < 0 && (sut.detector.verdict().alarms & kNotArmed) != 0) {
                said = index;
            }
        }
        ASSERT_GE(usable, 0);
        if (ratio > 1.11) {
            EXPECT_GE(said, 0);
            EXPECT_LE(said - usable, 480);
        } else {
            EXPECT_EQ(said, -1) << ratio;
        }
        EXPECT_EQ(sut.trip, -1);
    }
}

TEST(Supervisor, ACoordinatedForgeryOfBothEndsPasses) { // what no detector of currents can tell from a fault
    LineWaveform const w = synthesise(quiet_grid(), Situation::quiet, 3, 1);
    attacker::SampleAttack from = masquerade(700, 90), to = masquerade(700, -60);
    Protection sut{params(Mode::supervise)};
    for (std::size_t k = 0; k < w.size(); ++k) {
        auto const index = static_cast<std::int64_t>(k);
        sut.step(index, from.apply(index, w.from[k]).sent_a, to.apply(index, w.to[k]).sent_a);
    }
    EXPECT_GE(sut.trip, 700);
    EXPECT_LT(sut.trip, 720);
}

TEST(Supervisor, HealthyDisturbancesNeitherTripNorAlarm) {
    for (auto const situation :
         {Situation::quiet, Situation::load_step, Situation::line_trip, Situation::generator_trip, Situation::swing,
          Situation::external_3ph, Situation::external_1ph}) {
        for (std::uint64_t n = 0; n < 10; ++n) {
            Protection sut{params(Mode::supervise)};
            LineWaveform const w = synthesise(quiet_grid(), situation, 21, n);
            sut.run(w);
            EXPECT_EQ(sut.trip, -1) << w.name;
            EXPECT_EQ(sut.detector.alarms(), 0U) << w.name << " " << alarm_names(sut.detector.verdict().alarms);
        }
    }
}

TEST(Supervisor, LostSamplesNeverTrip) {
    for (int lost = 1; lost < 60; lost += 7) {
        LineWaveform const w = synthesise(quiet_grid(), Situation::load_step, 5, 1);
        Protection sut{params(Mode::supervise)};
        for (std::size_t k = 0; k < w.size(); ++k) {
            auto const index = static_cast<std::int64_t>(k);
            bool const there = index < w.event - 3 || index >= w.event - 3 + lost;
            sut.step(index, there ? w.from[k] : Abc{}, w.to[k], there);
        }
        EXPECT_EQ(sut.trip, -1) << lost;
    }
}

TEST(LineDetector, AForecasterInPaperModeBlindsTheRelayToRealFaults) { // why it is not the default
    DetectorParams p = params(Mode::paper);
    int tripped = 0;
    for (std::uint64_t n = 0; n < 20; ++n) {
        Protection sut{p};
        LineWaveform const w = synthesise(quiet_grid(), Situation::internal_3ph, 11, n);
        sut.run(w);
        tripped += sut.trip >= w.event && sut.trip < w.event + 96 ? 1 : 0;
    }
    EXPECT_LT(tripped, 15); // all twenty without it
}

} // namespace
} // namespace gridspace::ids
