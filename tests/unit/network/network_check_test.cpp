// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "sim/network/network_config.hpp"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::sim {
namespace {

constexpr std::string_view kHead = "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n";

std::string mistakes(std::string_view body) {
    std::string const text = std::string{kHead} + std::string{body};
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    bool const read = root && read_network(*root, diagnostics).has_value();
    EXPECT_EQ(read, diagnostics.ok());
    return diagnostics.render();
}

TEST(NetworkCheck, AcceptsASmallNetwork) {
    EXPECT_EQ(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                       "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}}\n"
                       "generators: {G: {bus: A, role: slack}}\n"),
              "");
}

TEST(NetworkCheck, NamesAnIslandedBus) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}, C: {voltage_v: 480}}\n"
                         "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}}\n"
                         "generators: {G: {bus: A, role: slack}}\n"),
                ::testing::HasSubstr("n.yaml:4:51: error: bus 'C' is islanded"));
}

TEST(NetworkCheck, NamesImpedancesThatAreMissingInOneSequenceOrInATransformer) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                         "sources: {S: {bus: A, r_ohm: 1, r0_ohm: 0}}\n"
                         "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2, r0_ohm: 0, x0_ohm: 0}}\n"
                         "transformers: {T: {from: A, to: B, rating_kva: 10, x_percent: 0}}\n"),
                ::testing::AllOf(::testing::HasSubstr("source 'S' has a positive sequence impedance but no zero"),
                                 ::testing::HasSubstr("line 'L' has no zero sequence impedance"),
                                 ::testing::HasSubstr("transformer 'T' has no short-circuit impedance")));
}

TEST(NetworkCheck, NamesAnImpedanceThatIsTooSmallToComputeACurrentThrough) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                         "lines: {L: {from: A, to: B, r_ohm: 1e-10}}\n"
                         "generators: {G: {bus: A, role: slack}}\n"),
                ::testing::HasSubstr("n.yaml:5:9: error: line 'L' has 1e-10 ohm, too little to compute its current: at "
                                     "least 2.3e-10 ohm are needed here"));
    EXPECT_EQ(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                       "lines: {L: {from: A, to: B, r_ohm: 2.4e-10}}\n"
                       "generators: {G: {bus: A, role: slack}}\n"),
              "");
}

TEST(NetworkCheck, TwoIdealSourcesAtABusAreAnError) {
    EXPECT_THAT(
        mistakes("buses: {A: {voltage_v: 480}}\nsources: {S: {bus: A}}\ngenerators: {G: {bus: A, role: slack}}\n"),
        ::testing::HasSubstr("generator 'G' holds the voltage of bus 'A', which source 'S' already does"));
}

TEST(NetworkCheck, KeysThatTheModelOfALoadDoesNotReadAreMistakes) {
    std::string const head = "buses: {A: {voltage_v: 480}}\nsources: {S: {bus: A}}\nloads: {D: {bus: A, p_kw: 1, ";
    EXPECT_THAT(mistakes(head + "exponent_p: 2}}\n"), ::testing::HasSubstr("they belong to `model: exponential`"));
    EXPECT_THAT(mistakes(head + "model: exponential, zip_p: [1, 0, 0]}}\n"),
                ::testing::HasSubstr("they belong to `model: zip`"));
    EXPECT_THAT(mistakes(head + "model: dc_resistive, power_factor: 0.9}}\n"),
                ::testing::HasSubstr("unity power factor"));
    EXPECT_EQ(mistakes(head + "model: dc_constant_power, power_factor: 1}}\n"), "");
}

TEST(NetworkCheck, ABatteryBeyondItsRatingOrItsLimitsIsAMistake) {
    std::string const head = "buses: {A: {voltage_v: 480}}\nsources: {S: {bus: A}}\nbatteries: {X: {bus: A, "
                             "capacity_kwh: 1, rating_kva: 5, ";
    EXPECT_THAT(mistakes(head + "p_kw: 4, q_kvar: 4}}\n"), ::testing::HasSubstr("more than its rating"));
    EXPECT_THAT(mistakes(head + "soc_start_percent: 5, soc_min_percent: 10}}\n"),
                ::testing::HasSubstr("'X' starts at 5 %"));
    EXPECT_EQ(mistakes(head + "p_kw: -4}}\n"), "");
}

TEST(NetworkCheck, BehindABreakerThatIsOpenAtTheStartThereIsNoVoltageYet) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                         "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}}\n"
                         "breaker_types: {ideal: {}}\n"
                         "breakers: {CB: {line: L, end: from, type: ideal, state: open}}\n"
                         "generators: {G: {bus: A, role: slack}}\n"),
                ::testing::AllOf(::testing::HasSubstr("warning: bus 'B' has no voltage at the start"),
                                 ::testing::HasSubstr("`state: closed`")));
}

TEST(NetworkCheck, UnknownNamesGetTheNearestSpelling) {
    std::string const text = mistakes("buses: {Main: {voltage_v: 480}}\nloads: {D: {bus: Mian, p_kw: 1}}\n"
                                      "generators: {G: {bus: Main, role: slack}}\n");
    EXPECT_THAT(text, ::testing::HasSubstr("load 'D' names the bus 'Mian', which does not exist"));
    EXPECT_THAT(text, ::testing::HasSubstr("did you mean 'Main'?"));
}

TEST(NetworkCheck, RefusesImpossibleElements) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 208}}\n"
                         "lines: {L: {from: A, to: B, r_ohm: 0, x_ohm: 0}}\ngenerators: {G: {bus: A, role: slack}}\n"),
                ::testing::AllOf(::testing::HasSubstr("joins buses of 480 V and 208 V"),
                                 ::testing::HasSubstr("line 'L' has no impedance")));
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}}\n"), ::testing::HasSubstr("nothing holds the voltage"));
    EXPECT_THAT(
        mistakes(
            "buses: {A: {voltage_v: 480}}\ngenerators: {X: {bus: A, role: slack}}\nloads: {X: {bus: A, p_kw: 1}}\n"),
        ::testing::HasSubstr("the name 'X' is used twice"));
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}}\ngenerators: {G: {bus: A, role: slack}}\n"
                         "evs: {E: {capacity_kwh: 24, battery_v: 360, max_current_a: 15, soc_start_percent: 20}}\n"),
                ::testing::HasSubstr("evs.E lacks the key 'bus'"));
}

TEST(NetworkCheck, TwoBreakersCannotShareAPlace) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}, B: {voltage_v: 480}}\n"
                         "lines: {L: {from: A, to: B, r_ohm: 0.1, x_ohm: 0.2}}\nbreaker_types: {t: {}}\n"
                         "breakers: {C1: {line: L, end: to, type: t}, C2: {line: L, end: to, type: t}}\n"
                         "generators: {G: {bus: A, role: slack}}\n"),
                ::testing::HasSubstr("breaker 'C2' stands where breaker 'C1' already is"));
}

TEST(NetworkCheck, ProfilesMustBeUsable) {
    EXPECT_THAT(mistakes("buses: {A: {voltage_v: 480}}\ngenerators: {G: {bus: A, role: slack}}\n"
                         "profiles: {p: {hours: [0, 1, 1], values: [1, 2]}, q: {}}\n"),
                ::testing::AllOf(::testing::HasSubstr("profile 'p' has 3 hours and 2 values"),
                                 ::testing::HasSubstr("do not increase at 1"),
                                 ::testing::HasSubstr("profile 'q' needs points")));
}

} // namespace
} // namespace gridspace::sim
