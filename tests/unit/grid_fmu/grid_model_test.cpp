// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/fmu/grid_model.hpp"

#include "read_network_text.hpp"
#include "sim/solvers/make_engine.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cmath>
#include <fstream>
#include <limits>

namespace gridspace::sim {
namespace {

/// A stiff source of 400 V, a cable of r = 1 ohm, and a star of resistances that draws 16 kW at 400 V: R = 10 ohm.
constexpr std::string_view kDivider = R"(gridspace_network: 1
name: divider
base: {frequency_hz: 50, power_kva: 100}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}
generators: {G: {bus: A, role: slack}}
lines: {L: {from: A, to: B, r_ohm: 1, x_ohm: 0}}
breaker_types: {quick: {mechanism_ms: 0}}
breakers: {CB: {line: L, end: from, type: quick}}
loads: {R: {bus: B, p_kw: 16, q_kvar: 0, model: constant_impedance}}
)";
constexpr std::string_view kWaveforms = R"(gridspace_network: 1
name: waveforms
base: {frequency_hz: 50, power_kva: 100}
buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}
sources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.1}}
lines: {L: {from: A, to: B, r_ohm: 0.1, l_mh: 0.5}}
breaker_types: {quick: {mechanism_ms: 2}}
breakers: {CB: {line: L, end: from, type: quick}}
loads: {R: {bus: B, p_kw: 16, q_kvar: 2, model: constant_impedance}}
batteries: {BAT: {bus: B, capacity_kwh: 10, rating_kva: 10, p_kw: 1}}
)";

constexpr GridModel::Reference kSetPoint = 1, kCommand = 2, kVoltage = 3;

FmuSettings settings_for(bool waveform) {
    FmuSettings out;
    out.engine.solver = waveform ? SolverKind::emt : SolverKind::phasor;
    out.engine.step_s = waveform ? Rational{1, 48000} : Rational{1, 1000};
    out.network = "network.yaml";
    out.token = "t";
    out.inputs = {"set_point.load.R.p_kw", "command.breaker.CB.closed"};
    out.outputs = {"bus.B.v_pu"};
    return out;
}

struct Resources {
    Resources(std::string_view network, FmuSettings const& settings) {
        std::ofstream{folder.path() / "network.yaml"} << network;
        std::ofstream{folder.path() / FmuSettings::kFile} << to_yaml(settings);
    }
    [[nodiscard]] std::unique_ptr<GridModel> load() const {
        auto model = GridModel::load(folder.path());
        EXPECT_TRUE(model) << model.error().message;
        return std::move(*model);
    }
    TemporaryFolder folder;
};

double value_of(GridModel const& model, GridModel::Reference reference) {
    auto const value = model.get(reference);
    EXPECT_TRUE(value) << value.error().message;
    return value.value_or(std::numeric_limits<double>::quiet_NaN());
}

TEST(GridModel, ShowsTheVoltageOfADividerBeforeAndAfterASetPoint) {
    auto const sut = Resources{kDivider, settings_for(false)}.load();
    ASSERT_TRUE(sut->start());
    EXPECT_NEAR(value_of(*sut, kVoltage), 10.0 / 11, 1e-7);

    ASSERT_TRUE(sut->set(kSetPoint, 32)); // R = 5 ohm
    EXPECT_NEAR(value_of(*sut, kVoltage), 10.0 / 11, 1e-7) << "it takes effect with the next step";
    ASSERT_TRUE(sut->step(0, 0.002));

    EXPECT_NEAR(value_of(*sut, kVoltage), 5.0 / 6, 1e-7);
    EXPECT_EQ(value_of(*sut, GridModel::kTime), 0.002);
}

TEST(GridModel, OpensAndClosesABreakerByABoolean) {
    auto const sut = Resources{kDivider, settings_for(false)}.load();
    ASSERT_TRUE(sut->start());

    ASSERT_TRUE(sut->set(kCommand, 0) && sut->step(0, 0.001));
    EXPECT_EQ(value_of(*sut, kVoltage), 0);
    ASSERT_TRUE(sut->set(kCommand, 1) && sut->step(0.001, 0.001));
    EXPECT_NEAR(value_of(*sut, kVoltage), 10.0 / 11, 1e-7);
}

/// The same grid without an FMU around it, driven by events.
std::vector<double> plainly(std::string_view text, EngineSettings const& settings, std::vector<TimedAction> const& done,
                            std::int64_t steps) {
    TimeBase const base{settings.step_s};
    auto engine = make_engine(settings, network_of(text), base);
    EXPECT_TRUE(engine) << engine.error().message;
    std::size_t const signal = (*engine)->find_signal("bus.B.v_pu");
    std::vector<double> out;
    Simulation run{std::move(*engine), {base, SimSpan{1}}, done};
    auto const see = [&](SimTime) { out.push_back(run.engine().value(signal)); };
    EXPECT_TRUE(run.start(see) && run.run_until(SimTime{steps}, see));
    return out;
}

TEST(GridModel, GivesTheValuesOfAPlainSimulationToTheLastBit) {
    for (bool const waveform : {false, true}) {
        SCOPED_TRACE(waveform ? "waveforms" : "phasors");
        FmuSettings const settings = settings_for(waveform);
        Rational const step_s = settings.engine.step_s;
        constexpr std::int64_t kSteps = 480, kSetAt = 48, kOpenAt = 144, kEach = 8;
        auto const wanted = plainly(kWaveforms, settings.engine,
                                    {{step_s * Rational{kSetAt}, SetParameter{"loads.R.p_kw", 4}, "set"},
                                     {step_s * Rational{kOpenAt}, SwitchBreaker{"CB", false}, "open"}},
                                    kSteps);
        auto const sut = Resources{kWaveforms, settings}.load();
        ASSERT_TRUE(sut->start());
        EXPECT_EQ(value_of(*sut, kVoltage), wanted[0]);

        for (std::int64_t at = 0; at < kSteps; at += kEach) {
            ASSERT_TRUE(sut->set(kSetPoint, at < kSetAt ? 16 : 4) && sut->set(kCommand, at < kOpenAt ? 1 : 0));
            ASSERT_TRUE(sut->step((step_s * Rational{at}).to_double(), (step_s * Rational{kEach}).to_double()));
            EXPECT_EQ(value_of(*sut, kVoltage), wanted[static_cast<std::size_t>(at + kEach)]) << at;
        }
        EXPECT_NE(wanted[kSteps], wanted[0]) << "something has happened";
    }
}

TEST(GridModel, BeginsAnewAfterAReset) {
    auto const sut = Resources{kWaveforms, settings_for(true)}.load();
    std::vector<double> runs[2];
    for (std::vector<double>& run : runs) {
        ASSERT_TRUE(sut->start());
        ASSERT_TRUE(sut->step(0, 0.001) && sut->set(kSetPoint, 3) && sut->step(0.001, 0.001));
        run = {value_of(*sut, kVoltage), value_of(*sut, GridModel::kTime), value_of(*sut, kSetPoint)};
        sut->reset();
        EXPECT_EQ(value_of(*sut, kSetPoint), 16);
        EXPECT_FALSE(sut->get(kVoltage)) << "known only after the start";
    }
    EXPECT_EQ(runs[0], runs[1]);
}

TEST(GridModel, RefusesStepsThatAreNoWholeNumberOfItsOwnAndSaysSo) {
    auto const sut = Resources{kWaveforms, settings_for(true)}.load();
    ASSERT_TRUE(sut->start());
    for (double const step_s : {1e-5, 2.5e-5, 0.0, -0.001, std::numeric_limits<double>::quiet_NaN(),
                                std::numeric_limits<double>::infinity()}) {
        auto const done = sut->step(0, step_s);
        ASSERT_FALSE(done) << step_s;
        EXPECT_NE(done.error().message.find("no whole number of steps of 1/48000 s"), std::string::npos)
            << done.error().message;
    }
    auto const elsewhere = sut->step(0.5, 0.001);
    ASSERT_FALSE(elsewhere);
    EXPECT_NE(elsewhere.error().message.find("from 0.5 s was asked for, and it is 0 s"), std::string::npos)
        << elsewhere.error().message;

    EXPECT_EQ(sut->time_s(), 0);
    double at_s = 0;
    for (int i = 0; i < 200; ++i, at_s += 0.001) { // an importer that adds its steps up
        ASSERT_TRUE(sut->step(at_s, 0.001)) << at_s;
    }
}

TEST(GridModel, RefusesValuesOutOfRangeAndVariablesThatAreNoInputs) {
    FmuSettings settings = settings_for(true);
    settings.inputs = {"set_point.load.R.power_factor"};
    auto const sut = Resources{kWaveforms, settings}.load();

    auto const wrong = sut->set(1, 1.5);
    ASSERT_FALSE(wrong);
    EXPECT_EQ(wrong.error().message, "'set_point.load.R.power_factor' cannot be 1.5");
    EXPECT_EQ(wrong.error().remedy, "expected > 0 and <= 1");
    EXPECT_FALSE(sut->set(1, std::numeric_limits<double>::quiet_NaN()));
    EXPECT_FALSE(sut->set(GridModel::kTime, 1));
    EXPECT_FALSE(sut->set(2, 1)) << "an output";
    EXPECT_FALSE(sut->get(3));
    EXPECT_FALSE(sut->is_command(1) || sut->is_number(3));
}

TEST(GridModel, TakesTheHourOfTheDayThatItWasExportedWith) {
    constexpr std::string_view kSunny = R"(gridspace_network: 1
name: sunny
base: {frequency_hz: 50, power_kva: 100}
buses: {A: {voltage_v: 400}}
generators: {G: {bus: A, role: slack}}
pv: {ROOF: {bus: A, p_kw: 10, scale: sun}}
profiles: {sun: {time: hour_of_day, hours: [0, 12, 24], values: [0, 1, 0]}}
)";
    FmuSettings settings = settings_for(false);
    settings.inputs = {};
    settings.outputs = {"pv.ROOF.p_kw"};
    settings.engine.epoch = "2026-06-01T06:00:00Z";
    auto const sut = Resources{kSunny, settings}.load();
    ASSERT_TRUE(sut->start());
    EXPECT_NEAR(value_of(*sut, 1), 5, 1e-9);
}

TEST(GridModel, SaysWhatItsResourcesLack) {
    FmuSettings settings = settings_for(false);
    settings.outputs = {"bus.X.v_pu"};
    Resources const unknown{kDivider, settings};
    auto const refused = GridModel::load(unknown.folder.path());
    ASSERT_FALSE(refused);
    EXPECT_EQ(refused.error().message, "the network has no signal 'bus.X.v_pu'");
    settings = settings_for(false);
    settings.inputs = {"set_point.load.X.p_kw"};
    Resources const other{kDivider, settings};
    EXPECT_EQ(GridModel::load(other.folder.path()).error().message, "the network has no input 'set_point.load.X.p_kw'");
    EXPECT_NE(GridModel::load("nowhere").error().message.find("nowhere/grid.yaml"), std::string::npos);
}

} // namespace
} // namespace gridspace::sim
