// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/frame_forger.hpp"
#include "common/config/yaml.hpp"
#include "gateways/iec61850/sv_publisher.hpp"

#include <cmath>
#include <gtest/gtest.h>
#include <map>

namespace gridspace::attacker {
namespace {

using Kind = FrameAttackParams::Kind;

constexpr char const* kStreams = R"(
SMV: {kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: MU1, conf_rev: 1, rate_hz: 4800, samples_per_frame: 2,
      synch: global, data_set: {Ia: float32, Ib: float32, Ic: float32}}
OTHER: {kind: smv, mac: "01:0C:CD:04:00:22", app_id: 0x4022, sv_id: MU2, conf_rev: 1, rate_hz: 4800,
        samples_per_frame: 2, synch: global, data_set: {Ia: float32, Ib: float32, Ic: float32}}
)";

AttackConfig attack(FrameAttackParams const& frames, double from_s = 0.1, double until_s = 0.2) {
    AttackConfig a;
    a.name.name = "x";
    a.place = AttackConfig::Place::between;
    a.from_s = Rational{std::llround(from_s * 10'000), 10'000};
    a.until_s = Rational{std::llround(until_s * 10'000), 10'000};
    a.frames = frames;
    return a;
}

struct Sent {
    std::int64_t at_ns{0};
    std::vector<std::uint16_t> counts;
    int smp_synch{-1};
    std::vector<std::uint8_t> octets;
};

struct Outcome {
    std::vector<Sent> sent;
    std::vector<Label> labels;
    std::uint64_t forged{0};
};

/// A merging unit of `name` for 0.3 s from `first` on, its current `peak_a` from sample 1200 on, and the attacker.
Outcome passed(AttackConfig const& config, char const* name = "SMV", std::int64_t first = 0, double peak_a = 10,
               bool listens_only = false) {
    config::Diagnostics diagnostics;
    auto const node = config::parse_yaml(kStreams, config::make_source("streams.yaml", kStreams), diagnostics);
    auto const all = streams::read_streams(*node, diagnostics);
    streams::Stream const& target = *streams::find_stream(all, "SMV");
    streams::Stream const& publisher_of = *streams::find_stream(all, name);
    auto sut = *FrameForger::create(target, config, 7);
    sut->set_source(*iec61850::Mac::parse("02:00:00:00:00:66"));
    iec61850::SvLayout const layout{publisher_of.data_set};
    iec61850::SvPublisher publisher{*publisher_of.sv_template(*iec61850::Mac::parse("02:00:00:00:00:01")), 4800};
    Outcome out;
    std::int64_t now_ns = 0;
    Emit const emit = [&](std::span<std::uint8_t const> frame) {
        Sent sent{now_ns + sut->delay_ns(), {}, -1, {frame.begin(), frame.end()}};
        iec61850::SvFrame decoded;
        ASSERT_TRUE(iec61850::decode_sv(sent.octets, decoded));
        for (iec61850::Asdu const& asdu : decoded.view()) {
            sent.counts.push_back(asdu.smp_cnt);
            sent.smp_synch = asdu.smp_synch;
        }
        out.sent.push_back(std::move(sent));
    };
    Tell const tell = [&](Label const& label) { out.labels.push_back(label); };
    for (std::int64_t n = first; n < first + 1440; ++n) {
        auto const sample = publisher.sample(n);
        layout.write(0, iec61850::Value::from_number(layout.slots()[0].leaf.type, n >= 1200 ? peak_a : 10.0), sample);
        iec61850::Octets const frame = publisher.commit();
        if (frame.empty()) {
            continue;
        }
        std::int64_t const at_ns = std::llround(static_cast<double>(n) * 1e9 / 4800);
        while (sut->due() && *sut->due() < at_ns) {
            now_ns = *sut->due();
            sut->elapse(now_ns, emit, tell);
        }
        now_ns = at_ns;
        sut->pass(frame, now_ns, listens_only ? Emit{} : emit, tell);
    }
    out.forged = sut->forged();
    return out;
}

TEST(FrameForger, MovesTheCounterWithinTheWindowOnlyAndSaysEachSample) {
    auto const out = passed(attack({.kind = Kind::counter_jump, .jump = 20}));
    ASSERT_EQ(out.sent.size(), 720U);
    for (std::size_t f = 0; f < out.sent.size(); ++f) {
        bool const attacked = out.sent[f].at_ns >= 100'000'000 && out.sent[f].at_ns < 200'000'000;
        EXPECT_EQ(out.sent[f].counts[0], 2 * f + (attacked ? 20 : 0)) << f;
        EXPECT_EQ(out.sent[f].counts[1], 2 * f + 1 + (attacked ? 20 : 0)) << f;
        EXPECT_EQ(out.sent[f].smp_synch, 2);
    }
    ASSERT_EQ(out.labels.size(), 480U);
    EXPECT_EQ(out.labels.front().channel, 3);
    EXPECT_EQ(out.labels.front().sent_a, out.labels.front().true_a + 20);
    EXPECT_EQ(out.labels.front().index, 480);
    EXPECT_EQ(out.forged, 240U);
}

TEST(FrameForger, MovesTheCounterAcrossItsWrap) {
    auto const out = passed(attack({.kind = Kind::counter_jump, .jump = -20}, 0.95, 1.1), "SMV", 4320);
    std::map<std::uint16_t, int> seen;
    for (Label const& label : out.labels) {
        EXPECT_EQ(label.sent_a, std::fmod(label.true_a - 20 + 4800, 4800));
        EXPECT_EQ(label.index % 4800, static_cast<std::int64_t>(label.true_a));
    }
    EXPECT_EQ(out.labels.front().index, 4560);
    EXPECT_EQ(out.labels.size(), 720U);
}

TEST(FrameForger, LiesAboutTheClock) {
    auto const out = passed(attack({.kind = Kind::synch, .smp_synch = 0}));
    for (Sent const& sent : out.sent) {
        EXPECT_EQ(sent.smp_synch, sent.at_ns >= 100'000'000 && sent.at_ns < 200'000'000 ? 0 : 2);
    }
    EXPECT_EQ(out.labels.size(), 480U);
    EXPECT_TRUE(passed(attack({.kind = Kind::synch, .smp_synch = 2})).labels.empty()) << "what is true is no lie";
}

TEST(FrameForger, HoldsFramesBackAndLetsNoneOvertakeAnother) {
    auto const out = passed(attack({.kind = Kind::delay, .delay_us = 3000}));
    ASSERT_EQ(out.sent.size(), 720U);
    for (std::size_t f = 1; f < out.sent.size(); ++f) {
        EXPECT_GE(out.sent[f].at_ns, out.sent[f - 1].at_ns);
        EXPECT_EQ(out.sent[f].counts[0], 2 * f);
    }
    EXPECT_DOUBLE_EQ(out.labels.front().sent_a, 3e-3);
    EXPECT_GE(out.labels.size(), 480U) << "those that catch up are late too";
    AttackConfig slow = attack({.kind = Kind::delay, .delay_us = 3000});
    slow.ramp_s = Rational{1, 20};
    EXPECT_LT(passed(slow).labels.front().sent_a, 1e-3);
}

TEST(FrameForger, DropsTheShareThatItIsToldInBursts) {
    auto const all = passed(attack({.kind = Kind::drop, .drop_percent = 100}));
    EXPECT_EQ(all.sent.size(), 480U);
    EXPECT_EQ(all.labels.size(), 480U);
    auto const some = passed(attack({.kind = Kind::drop, .drop_percent = 30, .burst = 5}));
    EXPECT_NEAR(static_cast<double>(some.forged), 0.3 * 240, 30);
    auto const again = passed(attack({.kind = Kind::drop, .drop_percent = 30, .burst = 5}));
    EXPECT_EQ(some.sent.size(), again.sent.size()) << "seeded";
}

TEST(FrameForger, FloodsWithCopiesOfTheNewestFrame) {
    auto const out = passed(attack({.kind = Kind::flood, .interval_us = 100}));
    EXPECT_EQ(out.sent.size(), 720U + 1000U);
    EXPECT_EQ(out.forged, 1000U);
    EXPECT_EQ(out.labels.size(), 2000U) << "two samples a frame";
    std::map<std::uint16_t, int> of;
    for (Sent const& sent : out.sent) {
        ++of[sent.counts[0]];
    }
    EXPECT_EQ(of[2], 1);
    EXPECT_GE(of[600], 4);
}

TEST(FrameForger, BesideThePublisherACopyHasAnAddressOfItsOwnUnlessItIsToldNotTo) {
    for (bool const spoof : {false, true}) {
        AttackConfig config = attack({.kind = Kind::flood, .interval_us = 500});
        config.place = AttackConfig::Place::second_publisher;
        config.spoof = spoof;
        auto const out = passed(config, "SMV", 0, 10, true);
        ASSERT_EQ(out.sent.size(), 200U);
        EXPECT_EQ(out.sent.front().octets[11], spoof ? 0x01 : 0x66);
    }
    auto const in_the_cable = passed(attack({.kind = Kind::flood, .interval_us = 500}));
    for (Sent const& sent : in_the_cable.sent) {
        EXPECT_EQ(sent.octets[11], 0x01) << "a copy in a cable is a copy";
    }
}

TEST(FrameForger, WaitsForTheFaultThatItIsToHide) {
    AttackConfig config = attack({.kind = Kind::drop, .drop_percent = 100}, 0.1, 0.3);
    config.when.emplace().above_a = 30;
    EXPECT_EQ(passed(config).labels.size(), 0U);
    auto const out = passed(config, "SMV", 0, 90);
    ASSERT_FALSE(out.labels.empty());
    EXPECT_GE(out.labels.front().index, 1200);
    EXPECT_EQ(out.labels.size(), 240U);
}

TEST(FrameForger, LeavesOtherStreamsAlone) {
    for (Kind const kind : {Kind::counter_jump, Kind::delay, Kind::drop, Kind::synch}) {
        auto const out = passed(attack({.kind = kind, .jump = 5, .delay_us = 100, .smp_synch = 0}), "OTHER");
        EXPECT_EQ(out.sent.size(), 720U);
        EXPECT_TRUE(out.labels.empty());
    }
}

} // namespace
} // namespace gridspace::attacker
