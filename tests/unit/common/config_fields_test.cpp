// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/fields.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>

namespace gridspace::config {
namespace {

enum class Kind { rms, phasor };

struct Relay {
    double pickup_a{0};
    std::int64_t cycles{1};
    Kind kind{Kind::phasor};
    bool seal_in{true};
    Rational step_s{1};
    std::vector<double> points;
    std::vector<Ref> streams;
};

void describe(Fields& f, Relay& r) {
    f.number("pickup_a", r.pickup_a, {.required = true, .above = 0});
    f.integer("window_cycles", r.cycles, {.min = 1, .max = 10});
    f.choice<Kind>("kind", r.kind, {{"rms", Kind::rms}, {"phasor", Kind::phasor}});
    f.flag("seal_in", r.seal_in);
    f.fraction("step_s", r.step_s, {.above = 0});
    f.numbers("points", r.points);
    f.references("streams", r.streams);
}

Relay read(std::string_view text, Diagnostics& diagnostics) {
    auto const root = parse_yaml(text, make_source("r.yaml", text), diagnostics);
    Relay relay;
    read_fields(*root, "", diagnostics, [&](Fields& f) {
        f.object("relay", {.required = true}, [&](Fields& inner) { describe(inner, relay); });
    });
    return relay;
}

TEST(Fields, ReadWhatIsGivenAndKeepDefaults) {
    Diagnostics diagnostics;
    Relay const r =
        read("relay: {pickup_a: 30, kind: rms, step_s: 1/48000, points: [0, 1/2], streams: [A, B]}", diagnostics);
    ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    EXPECT_EQ(r.pickup_a, 30);
    EXPECT_EQ(r.cycles, 1);
    EXPECT_EQ(r.kind, Kind::rms);
    EXPECT_TRUE(r.seal_in);
    EXPECT_EQ(r.step_s, Rational(1, 48000));
    EXPECT_EQ(r.points, (std::vector<double>{0, 0.5}));
    EXPECT_EQ(r.streams[1].name, "B");
}

TEST(Fields, UnknownKeysNameTheNearestOne) {
    Diagnostics diagnostics;
    (void)read("relay:\n  pick_up_a: 400\n", diagnostics);
    // That pickup_a is missing follows from it, and is not said again.
    EXPECT_EQ(diagnostics.render(), "r.yaml:2:3: error: unknown key 'pick_up_a' in relay\n"
                                    "   2 |   pick_up_a: 400\n"
                                    "     |   ^~~~~~~~~ did you mean 'pickup_a'? (in A)\n"
                                    "1 error.");
}

TEST(Fields, ARequiredKeyThatNothingResemblesIsMissed) {
    Diagnostics diagnostics;
    (void)read("relay:\n  window_cycles: 1\n", diagnostics);
    ASSERT_EQ(diagnostics.errors(), 1);
    EXPECT_EQ(diagnostics.sorted()[0].message, "relay lacks the key 'pickup_a'");
}

TEST(Fields, AnotherUnitOfTheSameQuantityIsRecognised) {
    Diagnostics diagnostics;
    (void)read("relay: {pickup_a: 1, step_ms: 20}", diagnostics);
    ASSERT_EQ(diagnostics.errors(), 1);
    EXPECT_EQ(diagnostics.sorted()[0].hint, "did you mean 'step_s'? (in seconds)");
}

TEST(Fields, ReportEveryMistakeInOnePass) {
    Diagnostics diagnostics;
    (void)read(
        "relay: {pickup_a: -1, window_cycles: 1.5, kind: fast, seal_in: yes, step_s: 1/0, points: 3, streams: [[]]}",
        diagnostics);
    EXPECT_EQ(diagnostics.errors(), 7) << diagnostics.render();
}

TEST(Fields, AUnitInTheValueIsExplained) {
    Diagnostics diagnostics;
    (void)read("relay: {pickup_a: 30 A}", diagnostics);
    ASSERT_EQ(diagnostics.errors(), 1);
    EXPECT_EQ(diagnostics.sorted()[0].message, "relay.pickup_a is '30 A'");
    EXPECT_EQ(diagnostics.sorted()[0].hint, "expected a number in A > 0; the unit is in the key");
}

TEST(Fields, QuotedNumbersAreText) {
    Diagnostics diagnostics;
    (void)read("relay: {pickup_a: \"30\"}", diagnostics);
    EXPECT_EQ(diagnostics.errors(), 1);
}

TEST(Fields, NotANumberAndInfinityAreRefused) {
    for (char const* text :
         {"relay: {pickup_a: .nan}", "relay: {pickup_a: nan}", "relay: {pickup_a: inf}", "relay: {pickup_a: 1e999}"}) {
        Diagnostics diagnostics;
        (void)read(text, diagnostics);
        EXPECT_EQ(diagnostics.errors(), 1) << text;
    }
}

} // namespace
} // namespace gridspace::config
