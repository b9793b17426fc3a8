// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/intrusion_score.hpp"

#include "common/config/yaml.hpp"
#include "launcher/judge/detector_roc.hpp"
#include "launcher/report/detector_tables.hpp"

#include <gtest/gtest.h>

#include <cmath>

namespace gridspace::launcher {
namespace {

config::Node yaml(char const* text) {
    config::Diagnostics diagnostics;
    auto const node = config::parse_yaml(text, config::make_source("test.yaml", text), diagnostics);
    EXPECT_TRUE(node && diagnostics.ok()) << diagnostics.render();
    return node ? *node : config::Node::map();
}

constexpr char const* kScenario = R"(
simulation: {gateways: {TL2: {publish: {TL_21: CT21, TL_22: CT22}}}}
processes:
  mu21: {program: gridspace-mu, host: a, from: TL_21, to: SMV21}
  mu22: {program: gridspace-mu, host: a, from: TL_22, to: SMV22}
  relay2: {program: gridspace-relay, host: b, currents: {from: SMV21, to: SMV22}, trip: T, element: {kind: rms, pickup_a: 3},
           ids: {mode: paper, model: x.json}}
events: {fault: {at_s: 0.5, apply_fault: {line: TL2}}, other: {at_s: 0.2, apply_fault: {bus: B4}}}
)";
constexpr char const* kNetwork = R"(
cts: {CT21: {line: TL2, end: from, positive: from_to}, CT22: {line: TL2, end: to, positive: from_to}}
)";

/// One second of both ends; from 0.5 s on they differ. Sample 1000, phase a of SMV21 is forged, and flagged; sample
/// 2000 of phase b is flagged for nothing.
IntrusionRecording recording() {
    IntrusionRecording out;
    for (char const* stream : {"SMV21", "SMV22"}) {
        IntrusionRecording::Track track{"relay2", stream, 4800, {}};
        for (std::int64_t n = 0; n < 4800; ++n) {
            IntrusionRecording::Sample s;
            s.index = n;
            for (std::size_t p = 0; p < 3; ++p) {
                double const scale = n >= 2400 && track.stream == "SMV21" ? 5 : 1;
                double const i =
                    10 * std::cos(6.283185307179586 * (static_cast<double>(n) / 80 - static_cast<double>(p) / 3));
                auto const a = static_cast<float>(scale * i);
                s.phases[p] = {a, a, a, 0.2F, a, n >= 20, false, false};
            }
            if (track.stream == "SMV21" && n == 1000) {
                s.phases[0].raw_a = -12;
                s.phases[0].flagged = s.phases[0].open_flagged = true;
            }
            if (track.stream == "SMV21" && n == 2000) {
                s.phases[1].flagged = true;
            }
            track.samples.push_back(s);
        }
        out.tracks.push_back(std::move(track));
    }
    out.labels.push_back({"fakes", "random", "SMV21", 1000, 0, -10, -12});
    out.labels.push_back({"messages", "flooding", "T", 0, 0, 0, 1});
    return out;
}

TEST(IntrusionScore, JoinsVerdictsWithLabelsAndTripsWithFaults) {
    SignalStore signals;
    signals["ids.relay2.alarm"] = {
        "", {0, 208'400'000, 250'000'000, 417'000'000}, {0, 1, 0, 1}}; // 0.2084 s: sample 1000
    std::vector<LoggedEvent> const events{{0.5035, "relay2", "trip", "sample 2416, phases abc"},
                                          {0.5, "sim", "event", "fault"}};
    IntrusionScore const sut = score_intrusion(recording(), yaml(kScenario), {yaml(kNetwork), 60}, signals, events, 1);

    ASSERT_EQ(sut.streams.size(), 2U);
    EXPECT_EQ(sut.streams[0].score.true_positives, 1U);
    EXPECT_EQ(sut.streams[0].score.false_positives, 1U);
    EXPECT_EQ(sut.streams[0].score.true_negatives, 3 * 4780U - 2);
    EXPECT_EQ(sut.streams[0].score.open_false_positive.count, 0U);
    EXPECT_EQ(sut.streams[0].packets.count, 1U);
    EXPECT_EQ(sut.streams[1].score.false_positives, 0U);
    ASSERT_EQ(sut.attacks.size(), 1U);
    EXPECT_EQ(sut.attacks[0].score.delay_samples, 0);
    ASSERT_EQ(sut.unjudged.size(), 1U); // nobody watches the messages
    EXPECT_EQ(sut.unjudged[0].attack, "messages");

    ASSERT_EQ(sut.relays.size(), 1U);
    IntrusionScore::Relay const& r = sut.relays[0];
    EXPECT_EQ(r.line, "TL2");
    EXPECT_EQ(r.faults_s, std::vector<double>{0.5}); // the fault at the bus is not on its line
    EXPECT_EQ(r.with.tripped, 1U);
    EXPECT_EQ(r.with.false_trips, 0U);
    EXPECT_EQ(r.without.tripped, 1U);
    ASSERT_FALSE(r.trips_without.empty());
    ASSERT_TRUE(r.added_ms);
    EXPECT_NEAR(*r.added_ms, static_cast<double>(2416 - r.trips_without[0]) / 4.8, 1e-9);
    EXPECT_EQ(r.alarms, 2U);
    EXPECT_EQ(r.false_alarms, 1U); // nothing was forged near 0.417 s

    add_intrusion_signals(sut, 1, signals);
    EXPECT_EQ(signals.at("score.fakes.detected_percent").values[0], 100);
    EXPECT_EQ(signals.at("ids.relay2.false_alarms").values[0], 1);
    EXPECT_NEAR(signals.at("ids.relay2.SMV21.false_positive_percent").values[0], 100.0 / (3 * 4780 - 1), 1e-9);
}

TEST(IntrusionScore, ATripWithoutAFaultIsFalseAndAFaultWithoutATripIsBlocked) {
    std::vector<LoggedEvent> const events{{0.3001, "relay2", "trip", "sample 1440, phases a"}};
    IntrusionScore const sut = score_intrusion(recording(), yaml(kScenario), {yaml(kNetwork), 60}, {}, events, 1);
    EXPECT_EQ(sut.relays[0].with.false_trips, 1U);
    EXPECT_EQ(sut.relays[0].with.late_or_blocked, 1U);
    EXPECT_FALSE(sut.relays[0].added_ms);
}

TEST(IntrusionScore, ARunWithoutDetectorsHasNothingToSay) {
    IntrusionScore const sut = score_intrusion({}, config::Node::map(), {}, {}, {}, 1);
    EXPECT_TRUE(sut.streams.empty());
    EXPECT_TRUE(detector_tables(sut).empty());
}

TEST(IntrusionScore, TheCurveOverThresholdsFallsFromEverythingToNothing) {
    IntrusionRecording const r = recording();
    auto const sut = roc_of(r, r.tracks[0]);
    ASSERT_GT(sut.size(), 10U);
    EXPECT_EQ(sut.front().detected_percent, 100);
    EXPECT_EQ(sut.back().detected_percent, 0); // 2 A is not 40 thresholds of 0.2 A away
    for (std::size_t i = 1; i < sut.size(); ++i) {
        EXPECT_LE(sut[i].detected_percent, sut[i - 1].detected_percent);
        EXPECT_LE(sut[i].false_positive_percent, sut[i - 1].false_positive_percent);
    }
}

} // namespace
} // namespace gridspace::launcher
