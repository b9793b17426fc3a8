// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/named_signals.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

NamedSignals of(std::string const& yaml, std::string_view more = {}) {
    config::Diagnostics diagnostics;
    auto const scenario = config::parse_yaml(yaml, config::make_source("test.yaml", yaml), diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return NamedSignals{*scenario, more};
}

TEST(NamedSignals, AreThoseOfExpressionsListsAndPatternsAndNoOthers) {
    NamedSignals const named = of(R"yaml(
expect:
  low: {min_of: "2*bus.B1.v_pu - mean(bus.C?.v_pu)", value: "> 0.9"}
report:
  figures:
    f: {signals: ["*.p_kw", line.L-1.i_a], marks: {open: {when: breaker.CB3.position == open}}}
)yaml");
    for (char const* signal : {"bus.B1.v_pu", "bus.C7.v_pu", "load.any.p_kw", "line.L-1.i_a", "breaker.CB3.position"}) {
        EXPECT_TRUE(named.contains(signal)) << signal;
    }
    for (char const* signal : {"bus.B2.v_pu", "bus.C10.v_pu", "bus.B1.v.a", "line.L-2.i_a", "load.any.q_kvar"}) {
        EXPECT_FALSE(named.contains(signal)) << signal;
    }
}

TEST(NamedSignals, AreAllWhereThePatternsAreTooManyToTry) {
    std::string text;
    for (int i = 0; i < 1001; ++i) {
        text += "pattern" + std::to_string(i) + ".* ";
    }
    EXPECT_TRUE(of("name: x\n", text).contains("bus.B1.v_pu"));
}

TEST(NamedSignals, DoNotCountWhatIsOnlyRecorded) {
    EXPECT_FALSE(of("record: {signals: [bus.*]}\nname: x\n").contains("bus.B1.v_pu"));
    EXPECT_TRUE(
        of("record: {signals: [bus.*]}\nname: x\n", "figures: {v: {signals: [bus.*.v_pu]}}").contains("bus.B1.v_pu"));
}

} // namespace
} // namespace gridspace::launcher
