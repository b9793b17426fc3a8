// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attack_window.hpp"
#include "agents/attacker/goose_attack.hpp"
#include "agents/attacker/sample_attack.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <set>

namespace gridspace::attacker {
namespace {

constexpr std::int64_t kMs = 1'000'000;

Abc truth(std::int64_t k) {
    double const w = 2 * 3.141592653589793 / 80 * static_cast<double>(k);
    return {18 * std::cos(w), 18 * std::cos(w - 2.0943951), 18 * std::cos(w + 2.0943951)};
}

SampleAttackParams biased() {
    SampleAttackParams p;
    p.name = "attack";
    p.kind = SampleAttackParams::Kind::bias;
    p.bias_a = 5;
    p.channels = 1;
    p.from = 100;
    p.until = 120;
    return p;
}

std::set<std::int64_t> altered(SampleAttackParams const& p, std::int64_t samples = 1000) {
    auto sut = *SampleAttack::create(p, 1);
    std::set<std::int64_t> out;
    for (std::int64_t k = 0; k < samples; ++k) {
        if (sut.apply(k, truth(k)).altered != 0) {
            out.insert(k);
        }
    }
    return out;
}

TEST(AttackWindow, ActsFromItsStartToJustBeforeItsEnd) {
    AttackWindow const sut{{100, 120}};
    EXPECT_FALSE(sut.acts(99));
    EXPECT_EQ(sut.start(100), 100);
    EXPECT_EQ(sut.start(119), 100);
    EXPECT_FALSE(sut.acts(120));
    EXPECT_EQ(sut.next(0), 100);
    EXPECT_EQ(sut.next(120), std::nullopt);
}

TEST(AttackWindow, ComesAgainAsOftenAsAsked) {
    SampleAttackParams p = biased();
    p.every = 200;
    p.times = 3;
    auto const found = altered(p);
    EXPECT_EQ(found.size(), 60U);
    EXPECT_TRUE(found.contains(100) && found.contains(300) && found.contains(519));
    EXPECT_FALSE(found.contains(120) || found.contains(299) || found.contains(700));
    AttackWindow const sut{{100, 120, 200, 3}};
    EXPECT_EQ(sut.next(130), 300);
    EXPECT_EQ(sut.next(521), std::nullopt);
    p.every = 10;
    EXPECT_FALSE(SampleAttack::create(p, 1)) << "windows that overlap";
}

TEST(AttackWindow, GrowsFromNothingToTheWholeAttack) {
    SampleAttackParams p = biased();
    p.until = 300;
    p.ramp = 100;
    auto sut = *SampleAttack::create(p, 1);
    for (std::int64_t k = 0; k < 300; ++k) {
        double const added = sut.apply(k, truth(k)).sent_a[0] - truth(k)[0];
        EXPECT_NEAR(added, k < 100 ? 0 : std::min(5.0 * static_cast<double>(k - 100) / 100, 5.0), 1e-9) << k;
    }
}

TEST(AttackWindow, WaitsForTheCurrentThatItIsToHide) {
    SampleAttackParams p = biased();
    p.until = 500;
    p.above_a = 40;
    EXPECT_TRUE(altered(p).empty()) << "18 A never are 40 A";
    auto sut = *SampleAttack::create(p, 1);
    for (std::int64_t k = 0; k < 600; ++k) {
        Abc i = truth(k);
        i[1] = k == 200 ? 90 : i[1]; // a phase that is not attacked
        i[0] = k == 300 ? 90 : i[0];
        EXPECT_EQ(sut.apply(k, i).altered != 0, k >= 300 && k < 500) << k;
    }
}

TEST(AttackWindow, ForgedMessagesWaitForWhatThePublisherSays) {
    GooseAttackParams p;
    p.kind = GooseAttackParams::Kind::masquerade_normal;
    p.interval_ms = 2;
    p.said = true;
    GooseAttack sut{p, {100 * kMs, 200 * kMs}, 1};
    GooseState state;
    (void)sut.pass(50 * kMs, state);
    EXPECT_FALSE(sut.next_ns()) << "nobody has said it";
    state.value = true;
    (void)sut.pass(90 * kMs, state);
    EXPECT_FALSE(sut.next_ns()) << "before the window";
    (void)sut.pass(130 * kMs, state);
    ASSERT_EQ(sut.next_ns(), 130 * kMs);
    int forged = 0;
    for (auto due = sut.next_ns(); due; due = sut.next_ns()) {
        forged += sut.forge(*due) ? 1 : 0;
    }
    EXPECT_EQ(forged, 35);
}

TEST(AttackWindow, ForgedMessagesComeInEachWindow) {
    GooseAttackParams p;
    p.kind = GooseAttackParams::Kind::flooding;
    p.interval_ms = 2;
    GooseAttack sut{p, {100 * kMs, 110 * kMs, 50 * kMs, 2}, 1};
    (void)sut.pass(0, {});
    std::vector<std::int64_t> at;
    for (auto due = sut.next_ns(); due; due = sut.next_ns()) {
        at.push_back(*due / kMs);
        (void)sut.forge(*due);
    }
    EXPECT_EQ(at, (std::vector<std::int64_t>{100, 102, 104, 106, 108, 150, 152, 154, 156, 158}));
}

TEST(ClockAttack, ShowsTheCurrentOfAnEarlierInstant) {
    for (double const offset_us : {80.0, 200.0, 1000.0, 5100.0}) {
        SampleAttackParams p = biased();
        p.kind = SampleAttackParams::Kind::clock;
        p.channels = 7;
        p.until = 900;
        p.offset_s = offset_us * 1e-6;
        auto sut = *SampleAttack::create(p, 1);
        for (std::int64_t k = 0; k < 900; ++k) {
            auto const out = sut.apply(k, truth(k));
            double const then = static_cast<double>(k) - (k < 100 ? 0 : p.offset_s * 4800);
            EXPECT_NEAR(out.sent_a[0], 18 * std::cos(2 * 3.141592653589793 / 80 * then), 0.002)
                << offset_us << " " << k;
        }
    }
}

TEST(ClockAttack, DriftsAndCannotShowTheFuture) {
    SampleAttackParams p = biased();
    p.kind = SampleAttackParams::Kind::clock;
    p.until = 100 + 4800;
    p.drift = 1e-3; // a millisecond a second
    auto sut = *SampleAttack::create(p, 1);
    for (std::int64_t k = 0; k < 4800; ++k) {
        auto const out = sut.apply(k, truth(k));
        double const then = static_cast<double>(k) - (k < 100 ? 0 : 1e-3 * static_cast<double>(k - 100));
        EXPECT_NEAR(out.sent_a[0], 18 * std::cos(2 * 3.141592653589793 / 80 * then), 0.002) << k;
    }
    p.drift = -1e-3;
    EXPECT_FALSE(SampleAttack::create(p, 1));
}

TEST(RecordingAttack, PlaysWhatWasRecordedAgainAndAgain) {
    SampleAttackParams p = biased();
    p.kind = SampleAttackParams::Kind::recording;
    p.channels = 7;
    p.recording = {{1, 2, 3}, {4, 5, 6}, {7, 8, 9}};
    auto sut = *SampleAttack::create(p, 1);
    for (std::int64_t k = 0; k < 130; ++k) {
        auto const out = sut.apply(k, truth(k));
        EXPECT_EQ(out.sent_a, k < 100 || k >= 120 ? truth(k) : p.recording[static_cast<std::size_t>(k - 100) % 3]);
    }
    p.recording.clear();
    EXPECT_FALSE(SampleAttack::create(p, 1));
}

} // namespace
} // namespace gridspace::attacker
