// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/goose_attack.hpp"
#include "ids/rules/goose_rules.hpp"

#include <gtest/gtest.h>

#include <set>

namespace gridspace::attacker {
namespace {

using Kind = GooseAttackParams::Kind;
constexpr std::int64_t kMs = 1'000'000;

GooseAttackParams params(Kind kind, double interval_ms = 7) {
    GooseAttackParams p;
    p.kind = kind;
    p.interval_ms = interval_ms;
    return p;
}

/// The publisher of a trip: every 10 ms, one change of state at 200 ms.
GooseState published(std::int64_t k) {
    GooseState s;
    s.st_num = k < 20 ? 5 : 6;
    s.sq_num = static_cast<std::uint32_t>(k < 20 ? k + 100 : k - 20);
    s.t_ns = k < 20 ? -1000 * kMs : 200 * kMs;
    s.live_ms = 30;
    s.value = k >= 20;
    return s;
}

ids::GooseFacts facts(GooseState const& s, std::int64_t now_ns, bool forged = false) {
    ids::GooseFacts f;
    f.source = {0, 1, 2, 3, 4, 5};
    f.st_num = s.st_num;
    f.sq_num = s.sq_num;
    f.t_ns = s.t_ns;
    f.live_ms = s.live_ms;
    f.value_hash = s.value ? 2 : 1;
    f.simulated = s.simulated;
    f.arrival_ns = now_ns + (forged ? 1 : 0);
    return f;
}

struct Outcome {
    std::set<std::uint32_t> findings_on_forged;
    int forged{0}, forged_accepted{0}, real_refused{0}, delivered{0};
};

/// Publisher, attacker and first-line rules for half a second; forged frames carry the publisher's own address (the
/// worst case).
Outcome run(GooseAttackParams const& p) {
    GooseAttack attack{p, 300 * kMs, 400 * kMs, 1};
    ids::GooseRules rules{{.min_time_ms = 1, .max_time_ms = 10}};
    Outcome out;
    for (std::int64_t ms = 0; ms < 500; ++ms) {
        std::int64_t const now = ms * kMs;
        if (ms % 10 == 0) {
            GooseState const real = published(ms / 10);
            if (auto const passed = attack.pass(now, real)) {
                auto const v = rules.judge(facts(*passed, now));
                out.delivered += v.accept ? 1 : 0;
                out.real_refused += v.accept ? 0 : 1;
                if (*passed != real) {
                    out.findings_on_forged.insert(v.findings);
                    ++out.forged;
                }
            }
        }
        while (auto const forged = attack.forge(now)) {
            auto const v = rules.judge(facts(*forged, now, true));
            ++out.forged;
            out.forged_accepted += v.accept ? 1 : 0;
            for (std::uint32_t bit = 1; bit <= v.findings; bit <<= 1U) {
                if ((v.findings & bit) != 0) {
                    out.findings_on_forged.insert(bit);
                }
            }
        }
    }
    return out;
}

TEST(GooseAttack, WithoutAnAttackTheRulesAcceptEverything) {
    Outcome const out = run(params(Kind::grayhole, 7));
    EXPECT_EQ(out.real_refused, 0);
    GooseAttackParams none = params(Kind::grayhole);
    none.drop_percent = 0;
    EXPECT_EQ(run(none).delivered, 50);
}

TEST(GooseAttack, ReplaysAreRefusedAndTheRealMessagesGoOn) {
    for (Kind const kind : {Kind::random_replay, Kind::inverse_replay}) {
        Outcome const out = run(params(kind));
        EXPECT_EQ(out.forged, 15);
        EXPECT_EQ(out.forged_accepted, 0);
        EXPECT_TRUE(out.findings_on_forged.contains(ids::kGooseOld));
        EXPECT_EQ(out.real_refused, 0);
    }
}

TEST(GooseAttack, OneHighStateNumberDoesNotShutTheRealPublisherOut) {
    Outcome const out = run(params(Kind::high_st_num, 1000));
    EXPECT_EQ(out.forged, 1);
    EXPECT_EQ(out.forged_accepted, 0);
    EXPECT_TRUE(out.findings_on_forged.contains(ids::kGooseJump));
    EXPECT_EQ(out.real_refused, 0);
}

TEST(GooseAttack, FloodingIsCutDown) {
    Outcome const out = run(params(Kind::flooding, 0.02));
    EXPECT_EQ(out.forged, 5000);
    EXPECT_EQ(out.forged_accepted, 0);
    EXPECT_TRUE(out.findings_on_forged.contains(ids::kGooseFlood));
}

TEST(GooseAttack, HeaderBitsAreSeen) {
    EXPECT_EQ(run(params(Kind::simulation)).forged_accepted, 0);
    Outcome const stretched = run(params(Kind::stretch));
    EXPECT_TRUE(stretched.findings_on_forged.contains(ids::kGooseStretched));
    EXPECT_EQ(stretched.real_refused, 0); // the values are good; the time to live is not believed
}

TEST(GooseAttack, AGrayholeDropsItsShare) {
    GooseAttackParams p = params(Kind::grayhole);
    EXPECT_EQ(run(p).delivered, 40);
    p.drop_percent = 50;
    int const delivered = run(p).delivered;
    EXPECT_GT(delivered, 40);
    EXPECT_LT(delivered, 50);
}

TEST(GooseAttack, AMasqueradeThatKnowsTheCountersPassesTheRules) { // why messages need authentication
    Outcome const out = run(params(Kind::masquerade_normal));
    EXPECT_GT(out.forged_accepted, 0);
}

TEST(GooseAttack, NeedsToHearAMessageFirst) {
    GooseAttack sut{params(Kind::masquerade_trip), 0, 100 * kMs, 1};
    EXPECT_FALSE(sut.forge(0));
    EXPECT_EQ(sut.next_ns(), 7 * kMs);
    static_cast<void>(sut.pass(1 * kMs, published(0)));
    auto const forged = sut.forge(7 * kMs);
    ASSERT_TRUE(forged);
    EXPECT_EQ(forged->st_num, 6U);
    EXPECT_TRUE(forged->value);
    EXPECT_FALSE(sut.forge(200 * kMs) && sut.forge(200 * kMs).has_value() && sut.next_ns().has_value() &&
                 *sut.next_ns() > 100 * kMs);
}

} // namespace
} // namespace gridspace::attacker
