// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/guarded_relay.hpp"
#include "common/source_tree.hpp"
#include "ids/data/synthetic.hpp"
#include "ids/forecaster/model_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gridspace::relay {
namespace {

ids::Model shipped(char const* name) {
    return *ids::load_model(source_tree("configs/models/") + name);
}

RelayParams relay_params() {
    RelayParams p;
    p.element.pickup_a = 2;
    return p;
}

ids::DetectorParams detector_params(ids::Mode mode) {
    ids::DetectorParams p;
    p.guard.mode = mode;
    p.guard.threshold.nominal_peak_a = 10;
    p.supervisor.on_unconfirmed = ids::SupervisorParams::OnUnconfirmed::block;
    return p;
}

LineSample sample_of(ids::LineWaveform const& w, std::size_t k) {
    LineSample s{static_cast<std::int64_t>(k), {}, {}};
    s.from.i_a = w.from[k];
    s.to.i_a = w.to[k];
    s.from.present = s.to.present = true;
    return s;
}

/// When it trips, with `change` done to each sample; -1: never.
template <class Change>
std::int64_t trip_of(GuardedRelay& sut, ids::LineWaveform const& w, Change&& change) {
    for (std::size_t k = 0; k < w.size(); ++k) {
        LineSample s = sample_of(w, k);
        change(s);
        if (sut.step(s).trip) {
            return s.index;
        }
    }
    return -1;
}
void nothing(LineSample&) {}

TEST(GuardedRelay, WithoutADetectorIsTheRelayItself) {
    auto const w = ids::synthesise({}, ids::Situation::internal_3ph, 3, 1);
    GuardedRelay sut{relay_params()};
    LineRelay bare{relay_params()};
    for (std::size_t k = 0; k < w.size(); ++k) {
        LineSample const s = sample_of(w, k);
        ASSERT_EQ(sut.step(s).trip, bare.step(s).trip) << k;
    }
    EXPECT_TRUE(bare.output().trip);
}

TEST(GuardedRelay, SupervisedTripsOnAFaultNoLaterThanWithout) {
    auto const w = ids::synthesise({}, ids::Situation::internal_3ph, 3, 1);
    GuardedRelay bare{relay_params()};
    GuardedRelay sut{relay_params(), shipped("ar_20.json"), detector_params(ids::Mode::supervise)};
    auto const without = trip_of(bare, w, nothing);
    ASSERT_GT(without, 0);
    EXPECT_EQ(trip_of(sut, w, nothing), without);
}

TEST(GuardedRelay, SupervisedWithholdsTheTripOfAForgeryOfOneEnd) {
    auto const w = ids::synthesise({}, ids::Situation::quiet, 3, 1);
    auto const forge = [](LineSample& s) {
        if (s.index >= 1200) {
            s.from.i_a[0] *= 5;
        }
    };
    GuardedRelay bare{relay_params()};
    GuardedRelay sut{relay_params(), shipped("ar_20.json"), detector_params(ids::Mode::supervise)};
    EXPECT_GE(trip_of(bare, w, forge), 1200); // an unprotected relay falls for it
    EXPECT_EQ(trip_of(sut, w, forge), -1);
    EXPECT_TRUE(sut.relay().output().withheld);
    EXPECT_GT(sut.detector()->alarms(), 0U);
}

TEST(GuardedRelay, CurrentsCountedIntoTheLineAreNotADifference) {
    // The `to` end counts into the line: opposite signs are a healthy line, and the detector must know.
    auto const w = ids::synthesise({}, ids::Situation::quiet, 3, 1);
    RelayParams params = relay_params();
    params.to_positive = Positive::into_line;
    GuardedRelay sut{params, shipped("ar_20.json"), detector_params(ids::Mode::supervise)};
    auto const turn = [](LineSample& s) {
        for (double& i : s.to.i_a) {
            i = -i;
        }
    };
    EXPECT_EQ(trip_of(sut, w, turn), -1);
    EXPECT_EQ(sut.detector()->supervisor().alarms(), 0U);
    EXPECT_FALSE(sut.detector()->supervisor().differing());
    GuardedRelay wrong{relay_params(), shipped("ar_20.json"), detector_params(ids::Mode::supervise)};
    (void)trip_of(wrong, w, turn); // a detector that believes in currents along the line sees nothing but differences
    EXPECT_TRUE(wrong.detector()->supervisor().differing());
}

TEST(GuardedRelay, SamplesThatAreNotNumbersOrAreLostNeverTrip) {
    for (auto const mode : {ids::Mode::paper, ids::Mode::hold_off, ids::Mode::supervise, ids::Mode::monitor}) {
        for (char const* model : {"ar_20.json", "mlp_20_10_1.json"}) {
            auto const w = ids::synthesise({}, ids::Situation::quiet, 3, 1);
            GuardedRelay sut{relay_params(), shipped(model), detector_params(mode)};
            auto const damage = [](LineSample& s) {
                std::int64_t const k = s.index % 200;
                if (k == 7) {
                    s.from.i_a[1] = std::numeric_limits<double>::quiet_NaN();
                } else if (k == 31 || k == 32) {
                    s.to.i_a[0] = std::numeric_limits<double>::infinity();
                } else if (k >= 60 && k < 66) { // more than can be bridged: the window is broken
                    s.from.present = false;
                } else if (k == 150) {
                    s.from.validity = Validity::invalid;
                }
            };
            EXPECT_EQ(trip_of(sut, w, damage), -1) << static_cast<int>(mode) << " " << model;
            EXPECT_GT(sut.detector()->from().counters().restarts, 0U);
            EXPECT_TRUE(std::isfinite(sut.detector()->verdict().from_accepted_a[0]));
        }
    }
}

TEST(GuardedRelay, TripsOnAFaultBehindALostSample) {
    auto const w = ids::synthesise({}, ids::Situation::internal_3ph, 3, 1);
    GuardedRelay sut{relay_params(), shipped("ar_20.json"), detector_params(ids::Mode::supervise)};
    GuardedRelay whole{relay_params(), shipped("ar_20.json"), detector_params(ids::Mode::supervise)};
    auto const with_all = trip_of(whole, w, nothing);
    ASSERT_GT(with_all, 100);
    auto const lose = [&](LineSample& s) { s.from.present = s.index != with_all - 60; };
    auto const trip = trip_of(sut, w, lose);
    EXPECT_GE(trip, with_all);
    EXPECT_LE(trip, with_all + 4);
}

} // namespace
} // namespace gridspace::relay
