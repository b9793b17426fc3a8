// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What the table of actions says, and what the engines do: they must be the same.
#include "sim/actions/action_table.hpp"

#include "common/config/yaml.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <limits>
#include <map>

namespace gridspace::sim {
namespace {

constexpr std::string_view kNetwork = R"(gridspace_network: 1
name: t
base: {frequency_hz: 60, power_kva: 100}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}, C: {voltage_v: 400}, D: {voltage_v: 400}}
sources: {Stiff: {bus: A, r_ohm: 0.001, l_mh: 0.01}}
lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.1}, Tie: {from: B, to: D, r_ohm: 0.05, l_mh: 0.1}}
transformers: {T: {from: B, to: C, rating_kva: 200, x_percent: 5}}
breaker_types: {quick: {mechanism_ms: 0}}
breakers: {CB: {line: Tie, end: from, type: quick}}
fuse_types: {k: {rated_a: 500, melting_a: [1000, 5000], melting_s: [100, 0.1]}}
fuses: {Links: {line: L, end: from, type: k}}
machine_types: {unit: {model: classical, constants_pu: {xd1: 0.3, x0: 0.15}, inertia_h_s: 3.5,
                governor: {droop_percent: 5, tg_s: 0.1, tt_s: 0.3}}}
machines: {M: {bus: C, type: unit, rating_kva: 50, p_kw: 5, voltage_setpoint_pu: 1}}
generators: {Given: {bus: D, role: pq, rating_kva: 20, p_kw: 2, q_kvar: 1},
             Holds: {bus: B, role: pv, rating_kva: 50, p_kw: 3, voltage_setpoint_pu: 1}}
loads: {Load: {bus: C, p_kw: 10, q_kvar: 2, model: constant_impedance}}
shunts: {Shunt: {bus: C, p_kw: 1}}
pv: {Pv: {bus: C, p_kw: 8, rating_kva: 10}}
wind_turbines: {Wind: {bus: C, rated_kw: 3, wind_m_s: 11}}
evs: {Ev: {bus: C, capacity_kwh: 24, battery_v: 360, max_current_a: 15, soc_start_percent: 20}}
batteries: {Battery: {bus: C, capacity_kwh: 20, rating_kva: 20, p_kw: 1}}
shunt_capacitors: {Bank: {bus: C, q_kvar: 5, rated_kv: 0.4}}
induction_machines: {Motor: {bus: C, rating_kva: 3, load_kw: 1, inertia_h_s: 0.5, constants_pu: {rs: 0.02, xs: 0.09, xm: 2.6, rr: 0.03, xr: 0.09}}}
electrolysers: {Electrolyser: {bus: C, rated_kw: 10, p_kw: 5, ramp_up_s: 0.05, ramp_down_s: 0.05}}
supercapacitors: {Supercapacitor: {bus: C, capacitance_f: 10, rated_voltage_v: 200, v_min_v: 100, v_start_v: 150, rating_kva: 10, p_kw: 2}}
)";

Network network(std::string_view text = kNetwork) {
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto out = read_network(*root, diagnostics);
    EXPECT_TRUE(out.has_value()) << diagnostics.render();
    return std::move(*out);
}

std::unique_ptr<Engine> engine(bool waveform, std::string_view text = kNetwork) {
    Rational const step{1, 4800};
    auto made = waveform ? emt::make_emt_engine(network(text), {TimeBase{step}, {1}, 0})
                         : phasor::make_phasor_engine(network(text), {.time_base = TimeBase{step}});
    EXPECT_TRUE(made.has_value()) << made.error().message;
    auto const started = (*made)->initialise();
    EXPECT_TRUE(started.has_value()) << started.error().message;
    return std::move(*made);
}

struct Table : testing::TestWithParam<bool> {
    bool waveform{GetParam()};
    Network n{network()};
    std::unique_ptr<Engine> sut{engine(waveform)};
};
INSTANTIATE_TEST_SUITE_P(, Table, testing::Bool(),
                         [](auto const& param) { return param.param ? "Waveforms" : "Phasors"; });

TEST_P(Table, EveryQuantityIsFollowedByTheSolversThatItNamesAndByNoOther) {
    for (ActionKind const& kind : action_kinds()) {
        for (std::string const& element : kind.names(n)) {
            for (Quantity const& q : kind.settable) {
                double const value = start_value(n, kind, element, q);
                SetParameter const action{fmt::format("{}.{}.{}", kind.section, element, q.name), value};
                bool const follows =
                    (waveform ? q.in_waveforms : q.in_phasors) && !refusal_of(n, kind, element, q, waveform);
                EXPECT_EQ(sut->apply(action).has_value(), follows) << action.path << " = " << value;
            }
        }
    }
    EXPECT_TRUE(sut->advance({1}).has_value());
}

TEST_P(Table, AValueOutOfRangeOrNotFiniteIsRefused) {
    for (ActionKind const& kind : action_kinds()) {
        for (Quantity const& q : kind.settable) {
            for (double const bad : {std::nan(""), std::numeric_limits<double>::infinity(), -1.0}) {
                if (!within(q.range, bad)) {
                    std::string const path = fmt::format("{}.{}.{}", kind.section, kind.names(n).front(), q.name);
                    EXPECT_FALSE(sut->apply(SetParameter{path, bad}).has_value()) << path << " = " << bad;
                }
            }
        }
    }
}

TEST_P(Table, EveryCommandIsFollowedByTheSolversThatItNames) {
    for (Command const command : {Command::disconnect, Command::connect, Command::open, Command::close, Command::start,
                                  Command::stop}) { // a reset is not for the solvers
        for (ActionKind const& kind : action_kinds()) {
            std::string const element = kind.names(n).front();
            EXPECT_EQ(engine(waveform)->apply(action_of(command, element)).has_value(),
                      kind.use(command, waveform) != nullptr)
                << kCommands[static_cast<std::size_t>(command)] << ' ' << element;
        }
    }
}

/// What a signal is after a sixth of a second, on average over a period.
double after(Engine& engine, SetParameter const& action, std::string const& signal, bool waveform) {
    EXPECT_TRUE(engine.apply(action).has_value()) << action.path;
    std::int64_t const period = 80, end = waveform ? 800 : period;
    double sum = 0;
    for (std::int64_t k = 1; k <= end; ++k) {
        EXPECT_TRUE(engine.advance({k}).has_value());
        sum += k > end - period ? engine.value(engine.find_signal(signal)) : 0;
    }
    return sum / static_cast<double>(period);
}

TEST_P(Table, PowersGoWhereTheyAreSet) {
    struct Case {
        SetParameter action;
        std::string signal;
        double wanted;
    };
    for (Case const& c :
         {Case{{"batteries.Battery.p_kw", -7}, "battery.Battery.p_kw", -7},
          Case{{"batteries.Battery.q_kvar", 4}, "battery.Battery.q_kvar", 4},
          Case{{"pv.Pv.p_limit_kw", 3}, "pv.Pv.p_kw", 3}, Case{{"pv.Pv.irradiance_pu", 0.25}, "pv.Pv.p_kw", 2},
          Case{{"pv.Pv.q_kvar", -4}, "pv.Pv.q_kvar", -4}, Case{{"pv.Pv.power_factor", 0.8}, "pv.Pv.q_kvar", -6},
          Case{{"generators.Given.p_kw", 9}, "generator.Given.p_kw", 9},
          Case{{"generators.Given.q_kvar", -3}, "generator.Given.q_kvar", -3},
          Case{{"generators.Holds.p_kw", 12}, "generator.Holds.p_kw", 12},
          Case{{"supercapacitors.Supercapacitor.p_kw", -7}, "supercapacitor.Supercapacitor.p_kw", -7},
          Case{{"supercapacitors.Supercapacitor.q_kvar", 4}, "supercapacitor.Supercapacitor.q_kvar", 4}}) {
        EXPECT_NEAR(after(*engine(waveform), c.action, c.signal, waveform), c.wanted, 0.1) << c.action.path;
    }
}

TEST_P(Table, ALoadDrawsWhatItIsToldTimesTheSquareOfItsVoltage) {
    for (auto const& [action, p, q] : {std::tuple{SetParameter{"loads.Load.demand_pu", 2}, 20.0, 4.0},
                                       {SetParameter{"loads.Load.q_kvar", 6}, 10.0, 6.0},
                                       {SetParameter{"loads.Load.power_factor", 0.8}, 10.0, 7.5}}) {
        double const v = after(*engine(waveform), action, "bus.C.v_pu", waveform);
        EXPECT_NEAR(after(*engine(waveform), action, "load.Load.p_kw", waveform), p * v * v, 0.1) << action.path;
        EXPECT_NEAR(after(*engine(waveform), action, "load.Load.q_kvar", waveform), q * v * v, 0.1) << action.path;
    }
}

TEST_P(Table, ASourceThatIsRaisedRaisesItsBus) {
    double const before = sut->value(sut->find_signal("bus.A.v_pu"));
    EXPECT_NEAR(after(*sut, {"sources.Stiff.voltage_pu", 1.05}, "bus.A.v_pu", waveform), before + 0.05, 0.01);
}

TEST(Frequency, ASourceThatTurnsFasterWithPhasorsTakesItsGridAlong) {
    std::string const text =
        "gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100}\n"
        "buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\n"
        "sources: {Behind: {bus: A, l_mh: 0.01}}\nlines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.1}}\n"
        "loads: {D: {bus: B, p_kw: 10, model: constant_impedance}}\n";
    auto const sut = engine(false, text);
    auto const angle = [&] { return sut->value(sut->find_signal("bus.B.angle_deg")); };
    double const before = angle();
    ASSERT_TRUE(sut->apply(SetParameter{"sources.Behind.frequency_hz", 60.25}).has_value());
    auto const turned = sut->advance({4800});
    ASSERT_TRUE(turned.has_value()) << turned.error().message;
    EXPECT_NEAR(angle() - before, 90, 1e-3);                                      // a quarter of a turn in a second
    EXPECT_NEAR(sut->value(sut->find_signal("bus.B.frequency_hz")), 60.25, 0.01); // it follows with a lag
    ASSERT_TRUE(sut->apply(SetParameter{"sources.Behind.frequency_hz", 60}).has_value());
    ASSERT_TRUE(sut->advance({9600}).has_value());
    EXPECT_NEAR(angle() - before, 90, 1e-3); // it has stopped there

    auto const stiff = engine(false, std::string{text}.replace(text.find(", l_mh: 0.01"), 12, ""));
    EXPECT_FALSE(stiff->apply(SetParameter{"sources.Behind.frequency_hz", 60.25}).has_value());
}

/// Averages over the period that ends at step `end`.
std::map<std::string, double> run_to(Engine& engine, std::int64_t from, std::int64_t end,
                                     std::vector<std::string> const& names) {
    std::map<std::string, double> out;
    for (std::int64_t k = from + 1; k <= end; ++k) {
        EXPECT_TRUE(engine.advance({k}).has_value());
        for (std::string const& name : names) {
            out[name] += k > end - 80 ? engine.value(engine.find_signal(name)) / 80 : 0;
        }
    }
    return out;
}

TEST(Service, InWaveformsWhatComesBackIsAsItWasToo) {
    std::vector<std::string> const names{"battery.Battery.p_kw",
                                         "pv.Pv.p_kw",
                                         "ev.Ev.p_kw",
                                         "load.Load.p_kw",
                                         "generator.Given.p_kw",
                                         "electrolyser.Electrolyser.p_kw",
                                         "supercapacitor.Supercapacitor.p_kw"};
    auto const sut = engine(true);
    ASSERT_TRUE(sut->apply(SetParameter{"evs.Ev.current_a", 10}).has_value());
    auto const before = run_to(*sut, 0, 24000, names);
    for (char const* element : {"Battery", "Pv", "Ev", "Load", "Given", "Electrolyser", "Supercapacitor"}) {
        ASSERT_TRUE(sut->apply(Disconnect{element}).has_value());
    }
    for (auto const& [name, value] : run_to(*sut, 24000, 24800, names)) {
        EXPECT_NEAR(value, 0, 0.01) << name;
    }
    for (char const* element : {"Battery", "Pv", "Ev", "Load", "Given", "Electrolyser", "Supercapacitor"}) {
        ASSERT_TRUE(sut->apply(Connect{element}).has_value());
    }
    for (auto const& [name, value] : run_to(*sut, 24800, 48800, names)) {
        EXPECT_NEAR(value, before.at(name), 0.1) << name;
    }
}

TEST(Taps, ATapThatIsChangedInARunIsAsOneThatWasSoFromTheStart) {
    auto const with_tap = [](double tap) {
        return fmt::format(
            "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
            "buses: {{A: {{voltage_v: 4000}}, B: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A, l_mh: 1}}}}\n"
            "loads: {{D: {{bus: B, p_kw: 50, q_kvar: 10, model: constant_impedance}}}}\n"
            "transformers: {{T: {{from: A, to: B, rating_kva: 100, x_percent: 5, r_percent: 1, tap_ratio: {},"
            " from_winding: delta, phase_shift_deg: 30, magnetising_percent: 2, charging_percent: 1}}}}\n",
            tap);
    };
    std::vector<std::string> const names{"bus.B.v_pu", "load.D.p_kw", "transformer.T.from.q_kvar"};
    for (bool const waveform : {false, true}) {
        auto const from_the_start = engine(waveform, with_tap(1.05)), changed = engine(waveform, with_tap(1));
        ASSERT_TRUE(changed->apply(SetParameter{"transformers.T.tap_ratio", 1.05}).has_value());
        auto const wanted = run_to(*from_the_start, 0, 9600, names), is = run_to(*changed, 0, 9600, names);
        for (std::string const& name : names) {
            EXPECT_NEAR(is.at(name), wanted.at(name), 2e-3 * std::abs(wanted.at(name))) << name << ' ' << waveform;
        }
        EXPECT_NEAR(wanted.at("bus.B.v_pu"), 1 / 1.05, 0.04);
    }
}

TEST_P(Table, AConverterThatIsStoppedGivesNothingAndComesBackWhenItIsStarted) {
    std::vector<std::string> const names{"battery.Battery.p_kw", "pv.Pv.p_kw", "ev.Ev.p_kw",
                                         "electrolyser.Electrolyser.p_kw", "supercapacitor.Supercapacitor.p_kw"};
    constexpr std::int64_t kSettled = 24000;
    ASSERT_TRUE(sut->apply(SetParameter{"evs.Ev.current_a", 10}).has_value());
    auto const before = run_to(*sut, 0, kSettled, names);
    for (char const* element : {"Battery", "Pv", "Ev", "Electrolyser", "Supercapacitor"}) {
        ASSERT_TRUE(sut->apply(StandBy{element, true}).has_value());
    }
    auto const stopped = run_to(*sut, kSettled, kSettled + 800, names);
    for (char const* element : {"Battery", "Pv", "Ev", "Electrolyser", "Supercapacitor"}) {
        ASSERT_TRUE(sut->apply(Disconnect{element}).has_value()); // a stopped one that comes back is still stopped
        ASSERT_TRUE(sut->apply(Connect{element}).has_value());
    }
    auto const still = run_to(*sut, kSettled + 800, kSettled + 10400, names);
    for (char const* element : {"Battery", "Pv", "Ev", "Electrolyser", "Supercapacitor"}) {
        ASSERT_TRUE(sut->apply(StandBy{element, false}).has_value());
    }
    auto const started = run_to(*sut, kSettled + 10400, 2 * kSettled + 10400, names);
    for (std::string const& name : names) {
        EXPECT_GT(std::abs(before.at(name)), 0.5) << name;
        EXPECT_NEAR(stopped.at(name), 0, 0.01) << name;
        EXPECT_NEAR(still.at(name), 0, 0.01) << name;
        EXPECT_NEAR(started.at(name), before.at(name), 0.1) << name;
    }
}

TEST(Service, WhatComesBackIsAsItWas) {
    for (char const* element : {"Load", "Pv", "Battery", "Shunt", "Tie", "Supercapacitor"}) {
        auto const sut = engine(false);
        auto const current = [&] { return sut->value(sut->find_signal("line.L.to.p_kw")); };
        double const before = current();
        EXPECT_TRUE(sut->apply(Disconnect{element}).has_value());
        auto const out = sut->advance({1});
        EXPECT_TRUE(out.has_value()) << element << ": " << out.error().message;
        EXPECT_GT(std::abs(current() - before), 0.1) << element;
        EXPECT_TRUE(sut->apply(Connect{element}).has_value());
        EXPECT_TRUE(sut->advance({2}).has_value());
        EXPECT_NEAR(current(), before, 0.1) << element;
    }
}

} // namespace
} // namespace gridspace::sim
