// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/frame_forger.hpp"
#include "agents/attacker/goose_forger.hpp"
#include "agents/attacker/stream_condition.hpp"
#include "agents/attacker/sv_forger.hpp"
#include "common/config/yaml.hpp"

#include <gmock/gmock.h>

namespace gridspace::attacker {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

constexpr char const* kConditionStreams = R"(
SMV:  {kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: MU1, conf_rev: 1, rate_hz: 4800, samples_per_frame: 1,
       data_set: {Ia: int32, Ib: int32, Ic: int32}}
SMV2: {kind: smv, mac: "01:0C:CD:04:00:22", app_id: 0x4022, sv_id: MU2, conf_rev: 1, rate_hz: 4800, samples_per_frame: 1,
       data_set: {Ia: float32, Ib: float32, Ic: float32}}
TRIP: {kind: goose, mac: "01:0C:CD:01:00:02", app_id: 0x8002, control_block: IED/LLN0$GO$Trip, conf_rev: 1,
       data_set: {other: boolean, status: boolean}}
)";

class StreamConditionTest : public ::testing::Test {
  protected:
    void SetUp() override {
        config::Diagnostics diagnostics;
        auto const node =
            config::parse_yaml(kConditionStreams, config::make_source("streams.yaml", kConditionStreams), diagnostics);
        all_ = streams::read_streams(*node, diagnostics);
        ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    }
    [[nodiscard]] streams::Stream const& stream(std::string_view name) const {
        return *streams::find_stream(all_, name);
    }

    /// A frame of one sample.
    [[nodiscard]] std::vector<std::uint8_t> sample(std::string_view name, std::array<double, 3> const& currents_a,
                                                   std::uint16_t smp_cnt = 0) const {
        streams::Stream const& s = stream(name);
        auto frame = *s.sv_template(*iec61850::Mac::parse("02:00:00:00:00:01"));
        iec61850::SvLayout const layout{s.data_set};
        for (std::size_t i = 0; i < 3; ++i) {
            auto const type = layout.slots()[i].leaf.type;
            double const scale = iec61850::is_integer(type) ? 1000 : 1;
            layout.write(i, iec61850::Value::from_number(type, currents_a[i] * scale), frame.sample(0));
        }
        frame.set_smp_cnt(0, smp_cnt);
        return {frame.frame().begin(), frame.frame().end()};
    }
    [[nodiscard]] std::vector<std::uint8_t> message(bool other, bool status, std::uint32_t st_num) const {
        auto frame = *stream("TRIP").goose_template(*iec61850::Mac::parse("02:00:00:00:00:02"));
        (void)frame.set(0, iec61850::Value::of(other));
        (void)frame.set(1, iec61850::Value::of(status));
        iec61850::GooseState state;
        state.st_num = st_num;
        state.live_ms = 100;
        state.t = iec61850::UtcTime::from_nanoseconds(st_num * 1'000'000'000LL, 0);
        auto const octets = frame.frame(state);
        return {octets.begin(), octets.end()};
    }

    std::vector<streams::Stream> all_;
};

AttackConfig::Condition above(double amperes) {
    AttackConfig::Condition out;
    out.above_a = amperes;
    return out;
}

AttackConfig::Condition said(bool value) {
    AttackConfig::Condition out;
    out.said = value;
    return out;
}

/// An attack from 0.1 to 0.2 s that waits for another stream.
AttackConfig waiting() {
    AttackConfig out;
    out.name.name = "x";
    out.place = AttackConfig::Place::between;
    out.from_s = Rational{1, 10};
    out.until_s = Rational{2, 10};
    out.when = above(30);
    out.when->stream.name = "OTHER";
    return out;
}

TEST_F(StreamConditionTest, IsMetByAnyOfTheCurrentsThatItNames) {
    auto any = *StreamCondition::create(stream("SMV"), "x", above(30), {});
    EXPECT_FALSE(any.met(sample("SMV", {29, -30, 0}), 0));
    EXPECT_TRUE(any.met(sample("SMV", {0, 0, -31}), 0)) << "milliamperes are scaled, and the sign does not count";
    EXPECT_FALSE(any.met(sample("SMV", {0, 0, -31}), -1)) << "before the start";
    EXPECT_FALSE(any.met(sample("SMV2", {0, 0, -31}), 0)) << "another stream";
    EXPECT_FALSE(any.met(message(true, true, 1), 0));
    auto one = *StreamCondition::create(stream("SMV2"), "x", above(30), {"Ib"});
    EXPECT_FALSE(one.met(sample("SMV2", {99, 0, 99}), 0));
    EXPECT_TRUE(one.met(sample("SMV2", {0, 31, 0}), 0));
}

TEST_F(StreamConditionTest, IsMetByWhatThePublisherSaysAndByNothingThatIsOutOfDate) {
    auto first = *StreamCondition::create(stream("TRIP"), "x", said(true), {});
    auto named = *StreamCondition::create(stream("TRIP"), "x", said(true), {"status"});
    EXPECT_FALSE(first.met(message(false, true, 5), 1'000'000)) << "the first Boolean is meant";
    EXPECT_TRUE(named.met(message(false, true, 5), 1'000'000));
    EXPECT_FALSE(named.met(message(false, false, 6), 2 * 1'000'000));
    EXPECT_FALSE(named.met(message(false, true, 5), 3 * 1'000'000)) << "an older state";
    EXPECT_TRUE(named.met(message(false, true, 5), 500 * 1'000'000)) << "a publisher that came back after its loss";
}

TEST_F(StreamConditionTest, FailsWhereTheStreamHasNoSuchThing) {
    auto const why = [&](char const* name, AttackConfig::Condition const& condition,
                         std::vector<std::string> const& channels) {
        auto const made = StreamCondition::create(stream(name), "x", condition, channels);
        return made ? std::string{} : made.error().message;
    };
    EXPECT_EQ(why("TRIP", above(1), {}), "attack 'x' waits for a current of 'TRIP', and it has none");
    EXPECT_EQ(why("SMV", above(1), {"Id"}), "attack 'x' waits for the current 'Id' of 'SMV'");
    EXPECT_THAT(why("SMV", said(true), {}), HasSubstr("no Boolean member"));
    EXPECT_THAT(why("TRIP", said(true), {"Ia"}), HasSubstr("no Boolean member 'Ia'"));
}

TEST_F(StreamConditionTest, AnAttackOnValuesBeginsWithTheNextSample) {
    AttackConfig config = waiting();
    config.samples.bias_a = 5;
    config.samples.kind = SampleAttackParams::Kind::bias;
    auto const sut = *SvForger::create(stream("SMV"), config, 60, 1);
    std::vector<std::int64_t> altered;
    auto const pass = [&](std::int64_t n) {
        auto const frame = sample("SMV", {1, 2, 3}, static_cast<std::uint16_t>(n));
        sut->pass(
            frame, n * 1'000'000'000 / 4800 + 100'000, [](auto) {},
            [&](Label const& label) {
                if (label.channel == 0) {
                    altered.push_back(label.index);
                }
            });
    };
    pass(470);
    sut->trigger(); // before the window
    for (std::int64_t n = 471; n < 955; ++n) {
        pass(n);
    }
    EXPECT_THAT(altered, ElementsAre()) << "it was met before the window only";
    sut->trigger();
    for (std::int64_t n = 955; n < 970; ++n) {
        pass(n);
    }
    EXPECT_THAT(altered, ElementsAre(955, 956, 957, 958, 959));
}

TEST_F(StreamConditionTest, AttacksOnFramesAndMessagesBeginAtTheInstant) {
    AttackConfig config = waiting();
    config.frames.emplace();
    auto const frames = *FrameForger::create(stream("SMV"), config, 1);
    int passed = 0;
    auto const pass = [&](std::int64_t at_ms) {
        frames->pass(sample("SMV", {1, 2, 3}), at_ms * 1'000'000, [&](auto) { ++passed; }, [](auto const&) {});
    };
    frames->trigger(90 * 1'000'000); // before the window
    pass(120);
    EXPECT_EQ(passed, 1);
    frames->trigger(130 * 1'000'000);
    pass(131);
    EXPECT_EQ(passed, 1) << "dropped";
    pass(201);
    EXPECT_EQ(passed, 2) << "the window is over";

    config.frames.reset();
    config.goose.emplace();
    auto const messages = *GooseForger::create(stream("TRIP"), config, 1);
    messages->pass(message(false, false, 1), 1'000'000, [](auto) {}, [](auto const&) {});
    EXPECT_FALSE(messages->due());
    messages->trigger(150 * 1'000'000);
    EXPECT_EQ(messages->due(), 150 * 1'000'000);
}

} // namespace
} // namespace gridspace::attacker
