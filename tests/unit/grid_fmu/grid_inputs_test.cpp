// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fmu/grid_inputs.hpp"

#include "read_network_text.hpp"
#include "sim/solvers/make_engine.hpp"

#include <algorithm>
#include <cmath>
#include <set>

namespace gridspace::sim {
namespace {

constexpr std::string_view kOfEachKind = R"(gridspace_network: 1
name: t
base: {frequency_hz: 60, power_kva: 100}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}, C: {voltage_v: 400}, D: {voltage_v: 400}}
sources: {Stiff: {bus: A, r_ohm: 0.001, l_mh: 0.01}}
lines: {L: {from: A, to: B, r_ohm: 0.05, l_mh: 0.1}, Tie: {from: B, to: D, r_ohm: 0.05, l_mh: 0.1},
        Loop: {from: A, to: D, r_ohm: 0.05, l_mh: 0.1}}
transformers: {T: {from: B, to: C, rating_kva: 200, x_percent: 5}}
breaker_types: {quick: {mechanism_ms: 0}}
breakers: {CB: {line: Tie, end: from, type: quick}, Open: {line: Loop, end: from, type: quick, state: open}}
machine_types: {unit: {model: classical, constants_pu: {xd1: 0.3, x0: 0.15}, inertia_h_s: 3.5,
                governor: {droop_percent: 5, tg_s: 0.1, tt_s: 0.3}}}
machines: {M: {bus: C, type: unit, rating_kva: 50, p_kw: 5, voltage_setpoint_pu: 1}}
loads: {Load: {bus: C, p_kw: 10, q_kvar: 2, model: constant_impedance}}
pv: {Pv: {bus: C, p_kw: 8, rating_kva: 10}}
wind_turbines: {Wind: {bus: C, rated_kw: 3, wind_m_s: 11}}
evs: {Ev: {bus: C, capacity_kwh: 24, battery_v: 360, max_current_a: 15, soc_start_percent: 20}}
batteries: {Battery: {bus: C, capacity_kwh: 20, rating_kva: 20, p_kw: 1}}
shunt_capacitors: {Bank: {bus: C, q_kvar: 5, rated_kv: 0.4, state: open}}
)";

std::vector<GridInput> inputs_of_each_kind(bool waveform) {
    return grid_inputs(network_of(kOfEachKind), waveform);
}

GridInput const* named(std::vector<GridInput> const& inputs, std::string_view name) {
    auto const found = std::find_if(inputs.begin(), inputs.end(), [&](GridInput const& i) { return i.name == name; });
    return found == inputs.end() ? nullptr : &*found;
}

TEST(GridInputs, AreSetPointsWithUnitRangeAndWhatTheyAreInTheFile) {
    auto const sut = inputs_of_each_kind(false);

    GridInput const* battery = named(sut, "set_point.battery.Battery.p_kw");
    ASSERT_NE(battery, nullptr);
    EXPECT_EQ(battery->unit, "kW");
    EXPECT_EQ(battery->start, 1);
    EXPECT_EQ(std::get<SetParameter>(battery->action(-3)).path, "batteries.Battery.p_kw");
    EXPECT_EQ(std::get<SetParameter>(battery->action(-3)).value, -3);
    GridInput const* wind = named(sut, "set_point.wind_turbine.Wind.wind_m_s");
    ASSERT_NE(wind, nullptr);
    EXPECT_EQ(wind->unit, "m/s");
    EXPECT_EQ(wind->start, 11);
    EXPECT_EQ(wind->range.min, 0);
    GridInput const* reactive = named(sut, "set_point.pv.Pv.q_kvar");
    ASSERT_NE(reactive, nullptr);
    EXPECT_FALSE(std::signbit(reactive->start)) << "no -0 in the description";
}

TEST(GridInputs, LeaveOutWhatAnElementRefuses) {
    EXPECT_EQ(named(inputs_of_each_kind(false), "set_point.battery.Battery.droop_percent"), nullptr)
        << "a battery that follows the grid has no droop";
    EXPECT_NE(named(inputs_of_each_kind(false), "set_point.machine.M.droop_percent"), nullptr);
}

TEST(GridInputs, AreCommandsByTheStateThatTheyBringAbout) {
    auto const sut = inputs_of_each_kind(true);

    GridInput const* closed = named(sut, "command.breaker.CB.closed");
    ASSERT_NE(closed, nullptr);
    EXPECT_TRUE(closed->is_command && closed->on_at_start);
    EXPECT_TRUE(std::get<SwitchBreaker>(closed->action(1)).close);
    EXPECT_FALSE(std::get<SwitchBreaker>(closed->action(0)).close);
    EXPECT_FALSE(named(sut, "command.breaker.Open.closed")->on_at_start);
    EXPECT_FALSE(named(sut, "command.shunt_capacitor.Bank.closed")->on_at_start);
    EXPECT_NE(closed->doc.find("false: opens its poles"), std::string::npos) << closed->doc;
    EXPECT_NE(named(sut, "command.machine.M.connected")->doc.find("true: there is no way back"), std::string::npos);
    EXPECT_EQ(std::get<Disconnect>(named(sut, "command.line.L.connected")->action(0)).element, "L");
    EXPECT_EQ(std::get<StandBy>(named(sut, "command.pv.Pv.running")->action(0)).on, true);
    EXPECT_EQ(named(sut, "command.line.L.closed"), nullptr);
}

TEST(GridInputs, AreTheModesThatAnElementIsAbleTo) {
    auto const sut = inputs_of_each_kind(true);

    GridInput const* mode = named(sut, "command.machine.M.mode");
    ASSERT_NE(mode, nullptr);
    EXPECT_EQ(mode->modes, (std::vector<std::string>{"droop", "fixed_power"})) << "its governor has no integral";
    EXPECT_EQ(std::get<SetMode>(mode->action(2)).mode, "fixed_power");
    EXPECT_EQ(named(sut, "command.battery.Battery.mode"), nullptr) << "it follows the grid";
}

TEST(GridInputs, HaveNamesOfTheirOwnThatNoSignalHas) {
    for (bool const waveform : {false, true}) {
        Network const network = network_of(kOfEachKind);
        EngineSettings settings;
        settings.solver = waveform ? SolverKind::emt : SolverKind::phasor;
        settings.step_s = Rational{1, 4800};
        auto const engine = make_engine(settings, network, TimeBase{settings.step_s});
        ASSERT_TRUE(engine) << engine.error().message;
        std::set<std::string> names;
        for (GridInput const& input : grid_inputs(network, waveform)) {
            EXPECT_TRUE(names.insert(input.name).second) << input.name;
        }
        for (SignalDef const& signal : (*engine)->signals()) {
            EXPECT_TRUE(names.insert(signal.name).second) << signal.name;
        }
    }
}

/// What the description offers, the solvers do: each input alone, at once, in a grid of its own.
TEST(GridInputs, AreDoneByTheSolverThatTheyAreFor) {
    for (bool const waveform : {false, true}) {
        Network const network = network_of(kOfEachKind);
        EngineSettings settings;
        settings.solver = waveform ? SolverKind::emt : SolverKind::phasor;
        settings.step_s = Rational{1, 4800};
        for (GridInput const& input : grid_inputs(network, waveform)) {
            auto engine = make_engine(settings, network, TimeBase{settings.step_s});
            ASSERT_TRUE(engine && (*engine)->initialise());
            bool const on = !input.on_at_start; // the other way than it is
            auto const done = (*engine)->apply(input.action(input.is_command ? on : input.start));
            EXPECT_TRUE(done) << input.name << (done ? "" : done.error().message);
            EXPECT_TRUE((*engine)->advance(SimTime{1})) << input.name;
        }
    }
}

} // namespace
} // namespace gridspace::sim
