// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/attack_config.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>

namespace gridspace::attacker {
namespace {

std::vector<AttackConfig> read(std::string const& text, config::Diagnostics& diagnostics) {
    std::vector<AttackConfig> out;
    auto const node = config::parse_yaml(text, config::make_source("attacks.yaml", text), diagnostics);
    if (node) {
        config::read_fields(*node, "", diagnostics, [&](config::Fields& f) { describe_attacks(f, out); });
    }
    return out;
}

constexpr char const* kFakes = "attacks:\n"
                               "  fakes:\n"
                               "    by: attacker\n"
                               "    place: {between: [mu21, process_bus]}\n"
                               "    target: {stream: SMV21, channels: [Ia]}\n"
                               "    window: {from_s: 0.5, until_s: 9.5}\n"
                               "    samples: {count: 400, spacing: random, min_gap: 80}\n"
                               "    value: {uniform_a: [-20, 20], min_error_a: 1.0}\n";

TEST(AttackConfig, ReadsThePublishedAttack) {
    config::Diagnostics diagnostics;
    auto const attacks = read(kFakes, diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    ASSERT_EQ(attacks.size(), 1U);
    EXPECT_EQ(attacks[0].place, AttackConfig::Place::between);
    EXPECT_EQ(attacks[0].between[1].name, "process_bus");
    auto const sut = make_sample_attack(attacks[0], {"Ia", "Ib", "Ic"}, 4800, 60, 7);
    ASSERT_TRUE(sut) << sut.error().message;
    EXPECT_EQ(sut->params().from, 2400);
    EXPECT_EQ(sut->params().until, 45600);
    EXPECT_EQ(sut->params().channels, 1);
    EXPECT_EQ(sut->chosen().size(), 400U);
    EXPECT_FALSE(make_sample_attack(attacks[0], {"I1", "I2", "I3"}, 4800, 60, 7));
}

TEST(AttackConfig, ReadsEachKindOfValueAndMessage) {
    std::string const head = "attacks:\n  x:\n    by: attacker\n    place: {second_publisher: true}\n    target: "
                             "{stream: S}\n    window: {from_s: 1, until_s: 2}\n";
    auto kind_of = [&](std::string const& line) {
        config::Diagnostics diagnostics;
        auto const a = read(head + "    " + line + "\n", diagnostics);
        EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
        return a.at(0);
    };
    using Kind = SampleAttackParams::Kind;
    EXPECT_EQ(kind_of("value: {bias_a: 1}").samples.kind, Kind::bias);
    EXPECT_EQ(kind_of("value: {factor: 2}").samples.kind, Kind::scale);
    EXPECT_EQ(kind_of("value: {ramp_per_cycle: 0.1}").samples.kind, Kind::ramp);
    EXPECT_EQ(kind_of("value: {freeze: true}").samples.kind, Kind::freeze);
    EXPECT_EQ(kind_of("value: {clock: {offset_us: 200}}").samples.kind, Kind::clock);
    EXPECT_EQ(kind_of("value: {recording: {file: x.csv}}").samples.kind, Kind::recording);
    EXPECT_EQ(kind_of("frames: {kind: counter_jump, jump: 20}").frames->jump, 20);
    EXPECT_EQ(kind_name(kind_of("frames: {kind: flood}")), "flood");
    EXPECT_EQ(kind_of("value: {masquerade: {peak_a: 90}}").samples.kind, Kind::masquerade);
    AttackConfig const replay = kind_of("value: {replay_s: 1/30}");
    EXPECT_EQ(make_sample_attack(replay, {"Ia", "Ib", "Ic"}, 4800, 60, 1)->params().delay, 160);
    EXPECT_EQ(kind_of("message: {kind: high_st_num, jump: 99}").goose->jump, 99U);
}

TEST(AttackConfig, NamesMistakesWithTheirPlace) {
    auto error_of = [](std::string const& from, std::string const& to) {
        std::string text = kFakes;
        text.replace(text.find(from), from.size(), to);
        config::Diagnostics diagnostics;
        static_cast<void>(read(text, diagnostics));
        EXPECT_FALSE(diagnostics.ok()) << to;
        return diagnostics.render();
    };
    EXPECT_NE(error_of("until_s: 9.5", "until_s: 0.2").find("attacks.yaml:6:"), std::string::npos);
    EXPECT_NE(error_of("[-20, 20]", "[20, -20]").find("the smaller first"), std::string::npos);
    EXPECT_NE(error_of("min_error_a: 1.0", "bias_a: 1.0").find("more than one thing"), std::string::npos);
    EXPECT_NE(error_of("uniform_a: [-20, 20], ", "").find("does not say what happens"), std::string::npos);
    EXPECT_NE(error_of("stream: SMV21, ", "").find("a stream or a topic expected"), std::string::npos);
    EXPECT_NE(error_of("{between: [mu21, process_bus]}", "{between: [mu21]}").find("a host and a link"),
              std::string::npos);
    EXPECT_NE(error_of("count: 400, ", "").find("random spacing needs it"), std::string::npos);
    EXPECT_NE(error_of("min_gap", "min_gapp").find("min_gap"), std::string::npos);
}

TEST(AttackConfig, ReadsWindowsThatRepeatGrowAndWait) {
    config::Diagnostics diagnostics;
    auto const attacks =
        read("attacks:\n  x:\n    by: attacker\n    place: {between: [a, b]}\n    target: {stream: S}\n"
             "    window: {from_s: 1, until_s: 2, repeat: {every_s: 3, times: 4}, ramp_s: 0.5, when: "
             "{above_a: 30}}\n    value: {bias_a: 1}\n",
             diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(attacks[0].end_s(), 11);
    AttackTimes const expected{1'000'000'000, 2'000'000'000, 3'000'000'000, 4, 500'000'000, true};
    EXPECT_EQ(times_in_ns(attacks[0]), expected);
    auto const sut = make_sample_attack(attacks[0], {"Ia", "Ib", "Ic"}, 4800, 60, 7);
    ASSERT_TRUE(sut);
    EXPECT_EQ(sut->params().every, 14'400);
    EXPECT_EQ(sut->params().ramp, 2400);
}

TEST(AttackConfig, RefusesWhatFitsTogetherNowhere) {
    auto const refused = [&](std::string const& window, std::string const& what) {
        config::Diagnostics diagnostics;
        read("attacks:\n  x:\n    by: attacker\n    place: {between: [a, b]}\n    target: {stream: S}\n    window: "
             "{from_s: "
             "1, until_s: 2" +
                 window + "}\n    " + what + "\n",
             diagnostics);
        return !diagnostics.ok();
    };
    EXPECT_FALSE(refused("", "value: {bias_a: 1}"));
    EXPECT_TRUE(refused(", repeat: {every_s: 0.5, times: 2}", "value: {bias_a: 1}"));
    EXPECT_TRUE(refused(", when: {said: true}", "value: {bias_a: 1}"));
    EXPECT_TRUE(refused(", when: {above_a: 1}", "message: {kind: grayhole}"));
    EXPECT_TRUE(refused(", when: {}", "value: {bias_a: 1}"));
    EXPECT_FALSE(refused(", when: {stream: T, said: true}", "value: {bias_a: 1}"));
    EXPECT_FALSE(refused(", when: {stream: T, channels: [Ib], above_a: 1}", "message: {kind: grayhole}"));
    EXPECT_TRUE(refused(", when: {stream: T}", "value: {bias_a: 1}"));
    EXPECT_TRUE(refused(", when: {stream: T, channels: [a, b], said: true}", "value: {bias_a: 1}"));
    EXPECT_TRUE(refused(", when: {channels: [Ib], above_a: 1}", "value: {bias_a: 1}")) << "the target has its own";
    EXPECT_TRUE(refused(", ramp_s: 0.1", "message: {kind: grayhole}"));
    EXPECT_TRUE(refused(", ramp_s: 0.1", "frames: {kind: drop}"));
    EXPECT_FALSE(refused(", ramp_s: 0.1", "frames: {kind: delay, delay_us: 100}"));
    EXPECT_TRUE(refused("", "samples: {spacing: random, count: 2}\n    frames: {kind: drop}"));
    EXPECT_TRUE(refused("", "frames: {kind: delay}"));
    EXPECT_TRUE(refused("", "frames: {kind: counter_jump}"));
    EXPECT_TRUE(refused("", "value: {clock: {}}"));
    EXPECT_TRUE(refused("", "value: {bias_a: 1}\n    frames: {kind: drop}"));
}

} // namespace
} // namespace gridspace::attacker
