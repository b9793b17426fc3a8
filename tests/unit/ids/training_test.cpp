// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/data/synthetic.hpp"
#include "ids/training/cholesky.hpp"
#include "ids/training/train.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>

namespace gridspace::ids {
namespace {

using Method = TrainParams::Method;

std::vector<LineWaveform> recordings(std::uint64_t count, std::uint64_t seed = 3) {
    SyntheticParams s;
    s.duration_s = 0.3;
    std::vector<LineWaveform> out;
    for (std::uint64_t n = 0; n < count; ++n) {
        out.push_back(synthesise(s, static_cast<Situation>(n % 10), seed, n));
    }
    return out;
}

Model like(int window, int channels = 1) {
    Model m;
    m.name = "test";
    m.window = window;
    m.channels = channels;
    m.rate_hz = 4800;
    m.frequency_hz = 60;
    m.scale = Model::Scale::window_peak;
    m.scale_a = 0.1;
    return m;
}

Windows windows(std::vector<LineWaveform> const& from, int window, std::size_t count, int channels = 1) {
    WindowParams p;
    p.window = window;
    p.channels = channels;
    p.count = count;
    p.scale_a = 0.1;
    return draw_windows(from, p, 1);
}

TEST(Cholesky, SolvesAndRefusesWhatIsNotPositiveDefinite) {
    std::vector<double> a{4, 0, 0, 2, 5, 0, 1, 3, 6}, b{1, 2, 3}; // lower triangle
    ASSERT_TRUE(solve_positive_definite(a, b, 3));
    EXPECT_NEAR(4 * b[0] + 2 * b[1] + 1 * b[2], 1, 1e-12);
    EXPECT_NEAR(2 * b[0] + 5 * b[1] + 3 * b[2], 2, 1e-12);
    EXPECT_NEAR(1 * b[0] + 3 * b[1] + 6 * b[2], 3, 1e-12);
    std::vector<double> bad{1, 0, 2, 1}, c{1, 1};
    EXPECT_FALSE(solve_positive_definite(bad, c, 2));
}

TEST(Training, LeastSquaresFindsTheRecursionOfASinusoid) {
    SyntheticParams s;
    s.noise_percent = {0, 0};
    s.harmonics_percent = 0;
    s.ct_error_percent = 0;
    s.off_nominal_share = 0;
    s.quantum_a = 0;
    std::vector<LineWaveform> const clean{synthesise(s, Situation::quiet, 1, 1)};
    TrainParams p;
    p.method = Method::least_squares;
    p.ridge = 1e-14;
    auto const m = train(windows(clean, 2, 2000), like(2), p, 1);
    ASSERT_TRUE(m) << m.error().message;
    EXPECT_NEAR(m->layers[0].weights[0], -1, 1e-6);
    EXPECT_NEAR(m->layers[0].weights[1], 2 * std::cos(2 * 3.141592653589793 * 60 / 4800), 1e-6);
}

TEST(Training, HuberGivesEventsLessWeightThanLeastSquares) {
    // A line through the origin with a tenth of wild points: the slope of the others is found.
    Windows data{1, 1, {}, {}};
    for (int k = 1; k <= 1000; ++k) {
        data.x.push_back(k * 0.001);
        data.y.push_back(k % 10 == 0 ? 50 : 2 * k * 0.001 + (k % 2 == 0 ? 1e-3 : -1e-3));
    }
    TrainParams p;
    p.epochs = 100;
    p.method = Method::huber;
    auto const robust = train(data, like(1), p, 1);
    p.method = Method::least_squares;
    auto const plain = train(data, like(1), p, 1);
    ASSERT_TRUE(robust && plain);
    EXPECT_NEAR(robust->layers[0].weights[0], 2, 0.02);
    EXPECT_GT(plain->layers[0].weights[0], 5);
}

TEST(Training, BothWaysOfTrainingTheNetworkBeatHoldingTheLastValueAndMarquardtIsTheBetter) {
    auto const all = recordings(20);
    Windows const data = windows(all, 20, 3000),
                  fresh = windows({synthesise({}, Situation::quiet, 77, 1), synthesise({}, Situation::quiet, 77, 2)},
                                  20, 3000);
    TrainParams p;
    p.hidden = 4;
    p.method = Method::back_propagation;
    p.epochs = 20;
    auto const bp = train(data, like(20), p, 1);
    p.method = Method::levenberg_marquardt;
    p.epochs = 15;
    auto const lm = train(data, like(20), p, 1);
    ASSERT_TRUE(bp && lm);
    double const held = rms_error(
        [] {
            Model m = hold_last(4800, 60);
            Layer& l = m.layers[0];
            l.inputs = m.window = 20;
            l.weights.assign(20, 0);
            l.weights[19] = 1;
            return m;
        }(),
        fresh);
    EXPECT_LT(rms_error(*bp, fresh), held / 2);
    EXPECT_LT(rms_error(*lm, fresh), held / 4);
    EXPECT_LT(rms_error(*lm, fresh), rms_error(*bp, fresh));
}

TEST(Training, GivesTheSameBitsWithOneThreadAndWithThree) {
    Windows const data = windows(recordings(10), 20, 3000);
    for (Method const method : {Method::huber, Method::levenberg_marquardt}) {
        TrainParams p;
        p.method = method;
        p.hidden = method == Method::huber ? 0 : 3;
        p.epochs = 3;
        p.threads = 1;
        auto const one = train(data, like(20), p, 5);
        p.threads = 3;
        auto const three = train(data, like(20), p, 5);
        ASSERT_TRUE(one && three);
        EXPECT_EQ(*one, *three);
    }
}

TEST(Training, TheJointModelForecastsAllPhasesTogether) {
    auto const all = recordings(20);
    TrainParams p;
    p.epochs = 5;
    auto const joint = train(windows(all, 20, 8000, 3), like(20, 3), p, 1);
    ASSERT_TRUE(joint) << joint.error().message;
    EXPECT_EQ(joint->layers[0].inputs, 60);
    EXPECT_EQ(joint->layers[0].outputs, 3);
    EXPECT_LT(rms_error(*joint, windows(recordings(5, 50), 20, 2000, 3)), 0.05);
}

TEST(Training, SaysWhatIsWrong) {
    TrainParams p;
    p.method = Method::huber;
    p.hidden = 3;
    EXPECT_FALSE(train(windows(recordings(1), 20, 500), like(20), p, 1));
    p.hidden = 0;
    auto const few = train(windows(recordings(1), 20, 30), like(20), p, 1);
    ASSERT_FALSE(few);
    EXPECT_EQ(few.error().message, "30 windows for 20 parameters");
    Windows zero{4, 1, std::vector<double>(4000), std::vector<double>(1000)};
    EXPECT_FALSE(train(zero, like(4), p, 1));
}

TEST(DrawWindows, LeavesOutValuesThatAreNotNumbersAndKeepsTheShareOfEvents) {
    auto all = recordings(4);
    all[0].from[100][0] = std::numeric_limits<double>::quiet_NaN();
    Windows const w = windows(all, 20, 1'000'000); // more than there are
    for (double const v : w.x) {
        ASSERT_TRUE(std::isfinite(v));
    }
    EXPECT_EQ(w.count(), 4U * 6 * (1440 - 20) - 21);
    EXPECT_LE(windows(all, 20, 1000).count(), 1000U);
}

} // namespace
} // namespace gridspace::ids
