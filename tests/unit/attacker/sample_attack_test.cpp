// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/sample_attack.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gridspace::attacker {
namespace {

using Kind = SampleAttackParams::Kind;

Abc truth(std::int64_t k) {
    double const w = 2 * 3.141592653589793 / 80 * static_cast<double>(k);
    return {18 * std::cos(w), 18 * std::cos(w - 2.0943951), 18 * std::cos(w + 2.0943951)};
}

SampleAttackParams params(Kind kind) {
    SampleAttackParams p;
    p.name = "attack";
    p.kind = kind;
    p.channels = 1;
    p.from = 1000;
    p.until = 2000;
    return p;
}

SampleAttack make(SampleAttackParams const& p, std::uint64_t seed = 7) {
    auto out = SampleAttack::create(p, seed);
    EXPECT_TRUE(out) << (out ? "" : out.error().message);
    return *out;
}

SampleAttackParams fakes() {
    SampleAttackParams p = params(Kind::random);
    p.from = 2400;
    p.until = 45600;
    p.spacing = SampleAttackParams::Spacing::random;
    p.count = 400;
    p.min_gap = 80;
    p.low_a = -20;
    p.high_a = 20;
    p.min_error_a = 1;
    return p;
}

TEST(SampleAttack, MakesAsManyIsolatedFakesAsAskedAndLabelsEachOfThem) {
    SampleAttack sut = make(fakes());
    std::vector<Label> labels;
    for (std::int64_t k = 0; k < 48000; ++k) {
        auto const out = sut.apply(k, truth(k));
        labels_of(k, truth(k), out, [&](Label const& l) { labels.push_back(l); });
        if (out.altered == 0) {
            EXPECT_EQ(out.sent_a, truth(k));
        }
    }
    ASSERT_EQ(labels.size(), 400U);
    for (std::size_t i = 0; i < labels.size(); ++i) {
        EXPECT_EQ(labels[i].channel, 0);
        EXPECT_EQ(labels[i].true_a, truth(labels[i].index)[0]);
        EXPECT_GE(std::fabs(labels[i].sent_a - labels[i].true_a), 1.0);
        EXPECT_LE(std::fabs(labels[i].sent_a), 20.0);
        EXPECT_GE(labels[i].index, 2400);
        EXPECT_LT(labels[i].index, 45600);
        if (i > 0) {
            EXPECT_GE(labels[i].index - labels[i - 1].index, 80);
        }
    }
}

TEST(SampleAttack, RepeatsWithItsSeedAndDiffersWithAnother) {
    SampleAttack a = make(fakes(), 1), b = make(fakes(), 1), c = make(fakes(), 2);
    EXPECT_EQ(a.chosen(), b.chosen());
    EXPECT_NE(a.chosen(), c.chosen());
    for (std::int64_t k = 0; k < 48000; ++k) {
        ASSERT_EQ(a.apply(k, truth(k)).sent_a, b.apply(k, truth(k)).sent_a);
    }
}

TEST(SampleAttack, FillsItsWindowToTheLastSampleThatFits) {
    SampleAttackParams p = fakes();
    p.from = 0;
    p.until = 399 * 80 + 1;
    SampleAttack const tight = make(p);
    for (std::size_t i = 0; i < 400; ++i) {
        EXPECT_EQ(tight.chosen()[i], static_cast<std::int64_t>(i) * 80);
    }
    p.until = 399 * 80;
    auto const broken = SampleAttack::create(p, 1);
    ASSERT_FALSE(broken);
    EXPECT_EQ(broken.error().message, "attack 'attack': 400 samples at least 80 apart do not fit into 31920 samples");
}

TEST(SampleAttack, ComputesEachKind) {
    std::int64_t const k = 1040;
    auto after = [&](SampleAttackParams const& p) {
        SampleAttack sut = make(p);
        Abc sent{};
        for (std::int64_t j = 0; j <= k; ++j) {
            sent = sut.apply(j, truth(j)).sent_a;
        }
        return sent[0];
    };
    SampleAttackParams p = params(Kind::bias);
    p.bias_a = 0.5;
    EXPECT_DOUBLE_EQ(after(p), truth(k)[0] + 0.5);
    p = params(Kind::scale);
    p.factor = 2;
    EXPECT_DOUBLE_EQ(after(p), truth(k)[0] * 2);
    p = params(Kind::ramp);
    p.ramp_per_cycle = 0.5;
    EXPECT_DOUBLE_EQ(after(p), truth(k)[0] * 1.25); // half a cycle after the start
    p = params(Kind::replay);
    p.delay = 30;
    EXPECT_DOUBLE_EQ(after(p), truth(k - 30)[0]);
    p = params(Kind::freeze);
    EXPECT_DOUBLE_EQ(after(p), truth(999)[0]);
    p = params(Kind::masquerade);
    p.peak_a = 50;
    EXPECT_NEAR(after(p), truth(k)[0] + 50 * (-1 - std::exp(-40.0 / 4800 / 0.02)), 1e-9);
}

TEST(SampleAttack, AMasqueradeStartsWithoutAStep) {
    SampleAttackParams p = params(Kind::masquerade);
    p.peak_a = 90;
    p.angle_deg = 35;
    p.channels = 7;
    SampleAttack sut = make(p);
    for (std::int64_t k = 0; k < 1001; ++k) {
        Abc const sent = sut.apply(k, truth(k)).sent_a;
        for (std::size_t c = 0; c < 3; ++c) {
            EXPECT_NEAR(sent[c], truth(k)[c], 1e-12);
        }
    }
}

TEST(SampleAttack, RefusesWhatCannotBeDone) {
    SampleAttackParams p = params(Kind::random);
    EXPECT_FALSE(SampleAttack::create(p, 1)); // empty range
    p = params(Kind::bias);
    p.until = p.from;
    EXPECT_FALSE(SampleAttack::create(p, 1));
    p = params(Kind::bias);
    p.channels = 0;
    EXPECT_FALSE(SampleAttack::create(p, 1));
    p = fakes();
    p.min_error_a = 25;
    EXPECT_FALSE(SampleAttack::create(p, 1));
    p = params(Kind::replay);
    p.delay = 0;
    EXPECT_FALSE(SampleAttack::create(p, 1));
}

} // namespace
} // namespace gridspace::attacker
