// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "controls_fixture.hpp"

#include <gmock/gmock.h>

namespace gridspace::sim {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

/// What validate says of `simulation.controls`.
std::string said(std::string_view text, bool waveform = false) {
    config::Diagnostics diagnostics;
    Network const network = grid();
    check_controls(read_controls(parse(text), diagnostics), network, waveform, diagnostics);
    return diagnostics.render();
}

TEST(ControlConfig, ARightOneIsRead) {
    config::Diagnostics diagnostics;
    auto const sut = read_controls(parse("battery.BAT1.p_kw: {from: ems, low_kw: -15, high_kw: 15, ramp_kw_per_s: 5, "
                                         "hold_s: 60, then: 0}\nbreaker.CB: {from: [ems, backup], commands: [open]}"),
                                   diagnostics);
    ASSERT_EQ(sut.size(), 2U) << diagnostics.render();
    EXPECT_EQ(sut[0].low, -15);
    EXPECT_EQ(sut[0].ramp_per_s, 5);
    EXPECT_EQ(sut[0].hold_s, 60);
    EXPECT_EQ(sut[1].from.size(), 2U);
    EXPECT_EQ(said("battery.BAT1.p_kw: {from: ems}\nbreaker.CB: {from: ems}"), "");
}

TEST(ControlConfig, APatternIsAboutThoseThatAreNotNamedAndDoNotRefuse) {
    config::Diagnostics diagnostics;
    auto const all = read_controls(parse("load.*.q_kvar: {from: a}\nload.L1.q_kvar: {from: b}"), diagnostics);
    EXPECT_THAT(elements_of(all[0], all, grid(), false), ElementsAre("L2")); // a DC load has none
    EXPECT_THAT(elements_of(all[1], all, grid(), false), ElementsAre("L1"));
}

TEST(ControlConfig, EachMistakeIsNamedWithWhatWasExpected) {
    for (auto const& [text, expected] : {
             std::pair{"battery.BAT9.p_kw: {from: a}", "there is no battery 'BAT9'"},
             {"battery.BAT1.p_mw: {from: a}", "did you mean 'p_kw'?"},
             {"batteries.BAT1.p_kw: {from: a}", "there is no kind of element 'batteries'"},
             {"battery: {from: a}", "expected kind.element.quantity"},
             {"battery.BAT1.p_kw: {}", "lacks the key 'from'"},
             {"battery.BAT1.p_kw: {from: []}", "names no process"},
             {"battery.BAT1.p_kw: 3", "expected {from: PROCESS, ...}"},
             {"battery.BAT1.p_kw: {from: a, low_kvar: 1}", "unknown key 'low_kvar'"},
             {"battery.BAT1.p_kw: {from: a, low_kw: 3, high_kw: 1}", "nothing lies between 3 and 1"},
             {"battery.BAT1.p_kw: {from: a, hold_s: 3}", "`hold_s` without `then`"},
             {"battery.BAT1.p_kw: {from: a, high_kw: 3, hold_s: 3, then: 4}", "outside of what may be asked for"},
             {"battery.BAT1.p_kw: {from: a, ramp_kw_per_s: 0}", "out of range"},
             {"load.DC.q_kvar: {from: a}", "a DC load has only p_kw"},
             {"load.L1.power_factor: {from: a, high: 2}", "2 is a value that a load cannot have"},
             {"load.X*.p_kw: {from: a}", "no load can be steered so"},
             {"load.L*.p_kw: {from: a}\nload.*1.p_kw: {from: b}", "is about load 'L1' as well"},
             {"breaker.CB: {from: a, commands: [opne]}", "did you mean 'open'?"},
             {"source.S.frequency_hz: {from: a, high_hz: 1e9}", "expected >= 25 and <= 75"},
             {"machine.*.frequency_setpoint_hz: {from: a, hold_s: 1, then: 10}", "expected >= 25 and <= 75"},
             {"generator.G.p_kw: {from: a}", "a generator of role slack gives what the network needs"},
         }) {
        EXPECT_THAT(said(text), HasSubstr(expected)) << text;
    }
    EXPECT_EQ(said("source.S.frequency_hz: {from: a, high_hz: 400}", true), "") << "waveforms follow any";
    EXPECT_THAT(said("transformer.T.tap_ratio: {from: a}", true), HasSubstr("there is no transformer 'T'"));
}

} // namespace
} // namespace gridspace::sim
