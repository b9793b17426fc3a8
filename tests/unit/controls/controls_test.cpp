// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What agents ask for, and what of it reaches the engine.
#include "controls_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <limits>

namespace gridspace::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

/// What the engine was told, as "3 s batteries.BAT1.p_kw = 5".
class RecordingEngine final : public Engine {
  public:
    explicit RecordingEngine(std::vector<std::string>& told) : told_{told} {}
    Result<void> initialise() override { return {}; }
    Result<void> advance(SimTime until) override {
        now_ = until;
        return {};
    }
    Result<void> apply(Action const& action) override {
        if (auto const* set = std::get_if<SetParameter>(&action)) {
            told_.push_back(fmt::format("{} s {} = {}", now_.quanta, set->path, set->value));
        } else if (auto const* breaker = std::get_if<SwitchBreaker>(&action)) {
            told_.push_back(
                fmt::format("{} s {} {}", now_.quanta, breaker->close ? "close" : "open", breaker->breaker));
        } else if (auto const* mode = std::get_if<SetMode>(&action)) {
            told_.push_back(fmt::format("{} s mode of {}: {}", now_.quanta, mode->element, mode->mode));
        } else {
            return fail(ExitCode::usage, "the engine cannot");
        }
        return {};
    }
    [[nodiscard]] std::vector<SignalDef> const& signals() const override { return signals_; }
    [[nodiscard]] double value(std::size_t) const override { return 0; }

  private:
    std::vector<std::string>& told_;
    std::vector<SignalDef> signals_;
    SimTime now_;
};

/// A quantum and a step of 1 s.
struct Steering : testing::Test {
    std::vector<std::string> told, events;
    TimeBase base{Rational{1}};
    Simulation simulation{std::make_unique<RecordingEngine>(told), {base, {1}}, {}};
    std::optional<Controls> sut;

    void SetUp() override {
        ASSERT_TRUE(simulation.start([](SimTime) {}));
        simulation.on_refusal(
            [this](SimTime t, std::string const& what, Error const& error) { sut->refused_by_engine(t, what, error); });
    }
    void controls(std::string_view text) {
        config::Diagnostics diagnostics;
        auto const configs = read_controls(parse(text), diagnostics);
        ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
        sut.emplace(configs, grid(), false, Control::Grid{base, {1}});
        sut->on_event([this](SimTime t, std::string_view event, std::string const& text_) {
            events.push_back(fmt::format("{} s {}: {}", t.quanta, event, text_));
        });
    }
    void ask(double value, double valid_for_s = 0, std::string_view process = "ems",
             std::string_view element = "battery.BAT1", std::string_view quantity = "p_kw") {
        sut->set_point(simulation, {simulation.now(), simulation.now(), process, "", element, valid_for_s}, quantity,
                       value);
    }
    void run_until(std::int64_t s) {
        sut->advance(simulation, {s});
        ASSERT_TRUE(simulation.run_until({s}, [](SimTime) {}));
    }
};

TEST_F(Steering, ASetPointIsSetWhenItTakesEffectAndStays) {
    controls("battery.BAT1.p_kw: {from: ems}");
    run_until(3);
    ask(5);
    run_until(9);
    EXPECT_THAT(told, ElementsAre("3 s batteries.BAT1.p_kw = 5"));
    EXPECT_THAT(events, IsEmpty());
}

TEST_F(Steering, ARampGoesFromWhereItIsStepByStep) {
    controls("battery.BAT1.p_kw: {from: ems, ramp_kw_per_s: 2}");
    ask(7); // from 2
    run_until(2);
    ask(5); // from 6, on the way
    run_until(9);
    EXPECT_THAT(
        told, ElementsAre("1 s batteries.BAT1.p_kw = 4", "2 s batteries.BAT1.p_kw = 6", "3 s batteries.BAT1.p_kw = 5"));
}

TEST_F(Steering, ARepeatedSetPointDoesNotSlowARampDown) {
    controls("battery.BAT1.p_kw: {from: ems, ramp_kw_per_s: 2}");
    for (std::int64_t s = 0; s < 4; ++s) {
        ask(9);
        run_until(s + 1);
    }
    EXPECT_THAT(told, ElementsAre("1 s batteries.BAT1.p_kw = 4", "2 s batteries.BAT1.p_kw = 6",
                                  "3 s batteries.BAT1.p_kw = 8", "4 s batteries.BAT1.p_kw = 9"));
}

TEST_F(Steering, WhenNothingNewComesTheLastIsHeldAndThenFallsBack) {
    controls("battery.BAT1.p_kw: {from: ems, hold_s: 4, then: 1}");
    ask(5, 2);
    run_until(20);
    EXPECT_THAT(told, ElementsAre("0 s batteries.BAT1.p_kw = 5", "6 s batteries.BAT1.p_kw = 1"));
    EXPECT_THAT(events, ElementsAre("2 s control_lost: battery.BAT1.p_kw: nothing new from 'ems' since 0 s; held for "
                                    "4 s, then 1",
                                    "6 s control_fallback: battery.BAT1.p_kw: nothing new from 'ems' since 0 s; it "
                                    "goes to 1"));
    ask(3); // it is back
    run_until(21);
    EXPECT_EQ(told.back(), "20 s batteries.BAT1.p_kw = 3");
}

TEST_F(Steering, AFallbackGoesAlongTheRampToo) {
    controls("battery.BAT1.p_kw: {from: ems, ramp_kw_per_s: 1, hold_s: 2, then: 0}");
    ask(3);
    run_until(9);
    EXPECT_THAT(told, ElementsAre("1 s batteries.BAT1.p_kw = 3", "3 s batteries.BAT1.p_kw = 2",
                                  "4 s batteries.BAT1.p_kw = 1", "5 s batteries.BAT1.p_kw = 0"));
}

TEST_F(Steering, ANewerSetPointKeepsTheSource) {
    controls("battery.BAT1.p_kw: {from: ems, hold_s: 3, then: 0}");
    for (std::int64_t s = 2; s <= 20; s += 2) {
        ask(5);
        run_until(s);
    }
    EXPECT_THAT(events, IsEmpty());
}

TEST_F(Steering, WhatIsRefusedDoesNothingAndSaysWhoWhatAndWhy) {
    controls("battery.BAT1.p_kw: {from: [ems, backup], low_kw: -15, high_kw: 15}");
    auto const said = [&](std::string const& expected) {
        ASSERT_FALSE(events.empty()) << expected;
        EXPECT_EQ(events.back(), "0 s set_point_refused: " + expected + ", ignored");
    };
    ask(16);
    said("battery.BAT1.p_kw = 16 of 'ems': expected >= -15 and <= 15");
    ask(std::nan(""));
    said("battery.BAT1.p_kw = nan of 'ems': it is no number");
    ask(-std::numeric_limits<double>::infinity(), 0, "backup");
    said("battery.BAT1.p_kw = -inf of 'backup': it is no number");
    ask(1, -1);
    said("battery.BAT1.p_kw = 1 of 'ems': valid_for_s is -1");
    ask(1, std::nan(""));
    ask(1, 0, "stranger");
    said("battery.BAT1.p_kw = 1 of 'stranger': only 'ems' or 'backup' may");
    ask(1, 0, "ems", "battery.BAT9");
    said("battery.BAT9.p_kw = 1 of 'ems': there is no 'battery.BAT9'");
    ask(1, 0, "ems", "battery.BAT2");
    said("battery.BAT2.p_kw = 1 of 'ems': simulation.controls does not name 'battery.BAT2.p_kw'");
    ask(1, 0, "ems", "battery.BAT1", "soc_percent");
    said("battery.BAT1.soc_percent = 1 of 'ems': simulation.controls does not name 'battery.BAT1.soc_percent'");
    run_until(9);
    EXPECT_THAT(told, IsEmpty());
}

TEST_F(Steering, AFrequencyThatPhasorsDoNotDescribeIsRefusedWithoutLimitsToo) {
    controls("source.S.frequency_hz: {from: ems}");
    ask(1e9, 0, "ems", "source.S", "frequency_hz");
    ask(51, 0, "ems", "source.S", "frequency_hz");
    run_until(1);
    EXPECT_THAT(events, ElementsAre("0 s set_point_refused: source.S.frequency_hz = 1000000000 of 'ems': expected >= "
                                    "25 and <= 75, ignored"));
    EXPECT_THAT(told, ElementsAre("0 s sources.S.frequency_hz = 51"));
    EXPECT_EQ(simulation.last_request(), "source.S.frequency_hz = 51 at 0 s");
}

TEST_F(Steering, OneWhoComesTooLateIsRefused) {
    controls("battery.BAT1.p_kw: {from: ems}");
    run_until(9);
    sut->set_point(simulation, {{9}, {4}, "ems", "market", "battery.BAT1", 5}, "p_kw", 1);
    EXPECT_THAT(events, ElementsAre("9 s set_point_refused: battery.BAT1.p_kw = 1 of 'ems' for 'market': it was valid "
                                    "until 9 s, and it comes at 9 s, ignored"));
    sut->set_point(simulation, {{9}, {4}, "ems", "", "battery.BAT1", 6}, "p_kw", 1); // late, and not too late
    run_until(10);
    EXPECT_THAT(told, ElementsAre("9 s batteries.BAT1.p_kw = 1"));
}

TEST_F(Steering, ATimeThatNoRunHasIsRefused) {
    config::Diagnostics diagnostics;
    auto const configs = read_controls(parse("battery.BAT1.p_kw: {from: ems}"), diagnostics);
    sut.emplace(configs, grid(), false, Control::Grid{base, {1}, {100}});
    sut->on_event([this](SimTime, std::string_view, std::string const& text) { events.push_back(text); });
    sut->set_point(simulation, {{0}, {1'700'000'000}, "ems", "", "battery.BAT1", 0}, "p_kw", 1); // UTC
    EXPECT_THAT(events, ElementsAre(HasSubstr("its time is 1700000000 s, and the run ends at 100 s")));
    EXPECT_THAT(told, IsEmpty());
}

TEST_F(Steering, OfTwoTheFirstSteersUntilItIsLost) {
    controls("battery.BAT1.p_kw: {from: [ems, backup], hold_s: 100, then: 0}");
    ask(5, 3);
    run_until(2);
    ask(6, 3, "backup");
    run_until(4);
    ask(7, 3, "backup");
    run_until(5);
    ask(8, 3);
    run_until(6);
    EXPECT_THAT(told, ElementsAre("0 s batteries.BAT1.p_kw = 5", "4 s batteries.BAT1.p_kw = 7"));
    EXPECT_THAT(events.front(), HasSubstr("2 s set_point_refused: battery.BAT1.p_kw = 6 of 'backup': 'ems' steers it"));
    EXPECT_THAT(events.back(), HasSubstr("5 s set_point_refused: battery.BAT1.p_kw = 8 of 'ems': 'backup' steers it"));
}

TEST_F(Steering, ARefusalIsSaidOnceUntilOneIsObeyed) {
    controls("battery.BAT1.p_kw: {from: ems, high_kw: 15}");
    for (double const value : {16.0, 17.0, 18.0, 1.0, 19.0}) {
        ask(value);
    }
    EXPECT_EQ(events.size(), 2U);
    EXPECT_EQ(sut->refused(), 4U);
    for (int i = 0; i < 5000; ++i) { // nor does who sends ever other names fill a memory or a log
        ask(1, 0, "ems", fmt::format("battery.X{}", i));
    }
    EXPECT_LE(events.size(), 1002U);
    EXPECT_EQ(sut->refused(), 5004U);
}

TEST_F(Steering, AModeIsAWordOfItsKind) {
    controls("machine.M: {from: ems}");
    auto const order = [&](std::string_view mode) {
        sut->command(simulation, {simulation.now(), simulation.now(), "ems", "", "machine.M", 0},
                     static_cast<std::size_t>(Command::mode), mode);
    };
    order("fixed");
    order("droop");
    run_until(1);
    EXPECT_THAT(told, ElementsAre("0 s mode of M: droop"));
    EXPECT_THAT(events, ElementsAre("0 s command_refused: mode fixed machine.M of 'ems': expected isochronous, droop, "
                                    "fixed_power, ignored"));
}

TEST_F(Steering, CommandsAreDoneOnceByWhomMayGiveThem) {
    controls("breaker.CB: {from: ems, commands: [open]}\nload.*: {from: ems}");
    auto const order = [&](Command command, std::string_view process, std::string_view element) {
        sut->command(simulation, {simulation.now(), simulation.now(), process, "", element, 0},
                     static_cast<std::size_t>(command));
    };
    order(Command::open, "ems", "breaker.CB");
    order(Command::close, "ems", "breaker.CB");
    order(Command::open, "stranger", "breaker.CB");
    order(Command::reset, "ems", "breaker.CB");
    order(Command::disconnect, "ems", "battery.BAT1");
    sut->command(simulation, {{}, {}, "ems", "", "load.L1", 0}, 99);
    order(Command::disconnect, "ems", "load.L1"); // allowed, and this engine cannot
    run_until(1);
    EXPECT_THAT(told, ElementsAre("0 s open CB"));
    EXPECT_THAT(events,
                ElementsAre("0 s command_refused: close breaker.CB of 'ems': expected open, ignored",
                            "0 s command_refused: open breaker.CB of 'stranger': only 'ems' may, ignored",
                            "0 s command_refused: disconnect battery.BAT1 of 'ems': simulation.controls does not name "
                            "'battery.BAT1', ignored",
                            "0 s command_refused: ? load.L1 of 'ems': expected connect, disconnect, ignored",
                            "0 s command_refused: load.L1: the engine cannot, ignored"));
}

} // namespace
} // namespace gridspace::sim
