// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What properties of elements mean, one by one; numbers by hand from what OpenDSS does.
#include "support.hpp"

#include <cmath>

namespace gridspace::opendss {
namespace {

std::string const kFirm = "New Circuit.c basekv=4.16 r1=0 x1=1e-6 r0=0 x0=1e-6\n";
std::string const kLineToEnd = "New Line.l bus1=sourcebus bus2=end r1=0.3 x1=0.6 r0=0.9 x0=1.8 c1=0 c0=0\n";

/// What a circuit is without, as a user reads it.
std::string listed(std::string const& text, std::optional<double> hour = {}) {
    config::Diagnostics diagnostics;
    Script const script = script_of(text, diagnostics);
    auto const circuit = build_circuit(script, diagnostics, hour);
    EXPECT_TRUE(circuit.has_value()) << diagnostics.render();
    std::string out;
    for (LeftOut const& left : circuit ? circuit->left_out : std::vector<LeftOut>{}) {
        out += left.what + (left.changes_result ? " (changes the result)\n" : "\n");
    }
    return out;
}

/// The power of the first load or generator at nominal voltage, kW and kvar.
Complex rated(std::string const& text, std::optional<double> hour = {}) {
    config::Diagnostics diagnostics;
    Script const script = script_of(kFirm + text, diagnostics);
    auto const circuit = build_circuit(script, diagnostics, hour);
    EXPECT_TRUE(circuit.has_value()) << diagnostics.render();
    if (!circuit || circuit->consumers.empty()) {
        return {};
    }
    Consumer const& first = circuit->consumers.front();
    return (first.generates ? -1.0 : 1.0) * first.law.power_va * static_cast<double>(first.phases.size()) / 1e3;
}

void expect_power(Complex got, double p, double q) {
    EXPECT_NEAR(got.real(), p, 0.01);
    EXPECT_NEAR(got.imag(), q, 0.01);
}

TEST(DssReactor, OfKvarKeepsItsReactanceWhenAResistanceIsGiven) {
    double const x = 4.16 * 4.16 / 0.3;
    for (char const* order : {"kvar=300 R=1", "R=1 kvar=300"}) {
        Solved const s = solved(kFirm + "New Reactor.r bus1=sourcebus kv=4.16 " + order + "\n");
        EXPECT_NEAR(s.flow.losses_va.real(), 4160.0 * 4160 / (1 + x * x), 5) << order;
        EXPECT_NEAR(s.flow.losses_va.imag(), 4160.0 * 4160 * x / (1 + x * x), 100) << order;
    }
    Solved const of_ohms = solved(kFirm + "New Reactor.r bus1=sourcebus kv=4.16 kvar=300 R=1 X=20\n");
    EXPECT_NEAR(of_ohms.flow.losses_va.imag(), 4160.0 * 4160 * 20 / 401, 300);
}

TEST(DssReactor, HasAHundredKvarWhenNothingIsGiven) {
    Solved const s = solved(kFirm + "New Reactor.r bus1=sourcebus kv=4.16\n");
    EXPECT_NEAR(s.flow.losses_va.imag(), 100e3, 50);
}

TEST(DssCapControl, ClosesABankThatBeginsOpen) {
    std::string const control = "New CapControl.k element=line.l capacitor=c type=kvar onsetting=50 offsetting=-900\n";
    std::string const load = "New Load.l bus1=end kv=4.16 kw=300 kvar=100 model=2\n";
    std::string const bank = "New Capacitor.c bus1=end kvar=600 kv=4.16 states=[0]\n";
    Solved const open = solved(kFirm + kLineToEnd + load + bank);
    EXPECT_NEAR(open.flow.source_va.imag(), 100e3, 5e3);
    Solved const closed = solved(kFirm + kLineToEnd + load + bank + control);
    EXPECT_NEAR(closed.flow.source_va.imag(), -500e3, 20e3);
    // The first step of a bank of three.
    std::string const steps = "New Capacitor.c bus1=end kvar=600 kv=4.16 numsteps=3 states=[0 0 0]\n";
    EXPECT_NEAR(solved(kFirm + kLineToEnd + load + steps).flow.source_va.imag(), 100e3, 5e3);
    EXPECT_NEAR(solved(kFirm + kLineToEnd + load + steps + control).flow.source_va.imag(), -100e3, 20e3);
}

TEST(DssVsource, OfOnePhaseHasTheSinglePhaseShortCircuitThatItIsGiven) {
    std::string const fault = "New Reactor.f phases=1 bus1=sourcebus.1 r=1e-6 x=0\n";
    Solved const power = solved("New Circuit.c phases=1 basekv=7.2 MVAsc3=200 MVAsc1=90\n" + fault);
    EXPECT_NEAR(std::abs(power.v("sourcebus", 1)) / 1e-6, 90e6 / 7200, 1);
    Solved const current = solved("New Circuit.c phases=1 basekv=7.2 Isc3=16000 Isc1=12000\n" + fault);
    EXPECT_NEAR(std::abs(current.v("sourcebus", 1)) / 1e-6, 12000, 1);
    Solved const impedance = solved("New Circuit.c phases=1 basekv=7.2 Z1=[0 0.5] Z0=[0 2]\n" + fault);
    EXPECT_NEAR(std::abs(impedance.v("sourcebus", 1)) / 1e-6, 7200 / 0.5, 1); // Z0 does not count
}

TEST(DssPvSystem, GivesUpWattsForVarsUnlessWattsOrItsPowerFactorComeFirst) {
    std::string const panel = "New PVSystem.p bus1=sourcebus kv=4.16 pmpp=500 kva=500 pf=0.9 ";
    expect_power(rated(panel + "\n"), 437.44, 242.16);
    expect_power(rated(panel + "wattpriority=yes\n"), 500, 0);
    expect_power(rated(panel + "pfpriority=yes\n"), 450, 217.94);
    std::string const vars = "New PVSystem.p bus1=sourcebus kv=4.16 pmpp=500 kva=500 kvar=-300 ";
    expect_power(rated(vars + "\n"), 400, -300);
    expect_power(rated(vars + "wattpriority=yes\n"), 500, 0);
    expect_power(rated(vars + "pfpriority=yes\n"), 500 * 5 / std::sqrt(34), -500 * 3 / std::sqrt(34));
    expect_power(rated(vars + "kvarmaxabs=200\n"), std::sqrt(500 * 500.0 - 200 * 200), -200);
    expect_power(rated("New PVSystem.p bus1=sourcebus kv=4.16 pmpp=600 kva=500\n"), 500, 0);
}

TEST(DssPvSystem, IsCappedByItsPercentageOfPmpp) {
    std::string const panel = "New PVSystem.p bus1=sourcebus kv=4.16 pmpp=100 kva=100 pctPmpp=50 irradiance=";
    expect_power(rated(panel + "0.8\n"), 50, 0);
    expect_power(rated(panel + "0.4\n"), 40, 0);
}

TEST(DssLoad, ByEnergyHasItsMeanPowerTimesItsFactor) {
    std::string const bill = "New Load.l bus1=sourcebus kv=4.16 pf=0.8 kWh=7200 kWhdays=30 Cfactor=4";
    expect_power(rated(bill + "\n"), 40, 30);
    expect_power(rated(bill + "\n~ pf=1\n"), 40, 0);
    expect_power(rated(bill + "\n~ kWhdays=60\n"), 20, 15);
    expect_power(rated(bill + "\n~ kW=12\n"), 12, 9);                                   // the last counts
    expect_power(rated("New Load.l bus1=sourcebus kv=4.16 pf=0.8 kWh=7200\n"), 40, 30); // 30 days and 4 by default
    expect_power(rated("New Load.l bus1=sourcebus kv=4.16 pf=0.8 xfkVA=100 allocationfactor=0.6\n"), 48, 36);
}

TEST(DssLoadShape, OfActualValuesGivesKwAndKvar) {
    std::string const load = "New Load.l bus1=sourcebus kv=4.16 kw=50 daily=s ";
    std::string const shape = "Set LoadMult=2\nNew LoadShape.s npts=3 interval=1 useactual=yes mult=(10 20 30) ";
    expect_power(rated(shape + "\n" + load + "pf=0.8\n", 2), 20, 15);
    expect_power(rated(shape + "\n" + load + "kvar=12\n", 2), 20, 0); // nobody says its kvar
    expect_power(rated(shape + "qmult=(1 2 3)\n" + load + "pf=0.8\n", 2), 20, 2);
    expect_power(rated(shape + "\nNew Generator.g bus1=sourcebus kv=4.16 kw=50 pf=0.8 daily=s\n", 3), 30, 0);
    EXPECT_THAT(listed(kFirm + shape + "\n" + load + "\n"), testing::HasSubstr("UseActual of loadshape.s"));
}

TEST(DssLoadShape, OfHoursOfItsOwnIsAStraightLineBetweenThemAndBeginsAnew) {
    std::string const text = "New LoadShape.s npts=3 interval=0 hour=(0 10 20) mult=(1 2 4) qmult=(1 1 3)\n"
                             "New Load.l bus1=sourcebus kv=4.16 kw=10 kvar=10 daily=s\n";
    expect_power(rated(text, 5), 15, 10);
    expect_power(rated(text, 10), 20, 10);
    expect_power(rated(text, 15), 30, 20);
    expect_power(rated(text, 25), 15, 10);
}

TEST(DssLoadShape, OfAFileOrWithEdgesIsListedOnce) {
    std::string const loads = "New Load.l bus1=sourcebus kv=4.16 kw=10 daily=s\nNew Load.m like=l bus1=sourcebus\n";
    for (char const* file : {"csvfile=a.csv", "sngfile=a.sng", "dblfile=a.dbl", "pqcsvfile=a.csv", "mult=(file=a)"}) {
        EXPECT_EQ(listed(kFirm + "New LoadShape.s npts=3 interval=1 " + file + "\n" + loads, 1),
                  "the file of loadshape.s: taken as 1 (changes the result)\n")
            << file;
    }
    EXPECT_EQ(listed(kFirm + "New LoadShape.s npts=2 interval=1 mult=(1 2) interpolation=edge\n" + loads, 1),
              "the edges of loadshape.s: interpolated (changes the result)\n");
}

TEST(DssCapControl, LooksAtTheVoltageBetweenPhasesOfADeltaBank) {
    std::string const control = "New CapControl.k element=line.l terminal=2 capacitor=c type=voltage ptratio=20 "
                                "onsetting=100 offsetting=150 ptphase=";
    for (char const* phase : {"1", "3"}) { // 208 V of the relay between phases, 120 V to earth
        Solved const delta = solved(kFirm + kLineToEnd + "New Capacitor.c bus1=end kvar=60 kv=4.16 conn=delta\n" +
                                    control + phase + "\n");
        EXPECT_FALSE(delta.circuit.elements.back().in_service);
        Solved const star =
            solved(kFirm + kLineToEnd + "New Capacitor.c bus1=end kvar=60 kv=4.16\n" + control + phase + "\n");
        EXPECT_TRUE(star.circuit.elements.back().in_service);
    }
}

TEST(DssCapControl, ByPowerFactorHasItsOwnSettingsAndClosesOnlyWhereEnoughVarsFlow) {
    std::string const load = "New Load.l bus1=end kv=4.16 kw=300 kvar=290 model=2\n";
    auto const closed = [&](std::string const& bank, std::string const& control) {
        return solved(kFirm + kLineToEnd + load + "New Capacitor.c bus1=end kv=4.16 " + bank +
                      "\nNew CapControl.k element=line.l capacitor=c " + control + "\n")
            .circuit.elements.back()
            .in_service;
    };
    EXPECT_TRUE(closed("kvar=300 states=[0]", "type=pf"));
    EXPECT_FALSE(closed("kvar=300 states=[0]", "type=pf pctminkvar=110"));
    EXPECT_FALSE(closed("kvar=300 states=[0]", "type=pf onsetting=0.5")); // it is 0.71
    EXPECT_FALSE(closed("kvar=600", "type=pf"));                          // 1.3: leading beyond 1.05
    EXPECT_TRUE(closed("kvar=600", "type=pf offsetting=-0.5"));           // 1.5
    EXPECT_FALSE(closed("kvar=600", "offsetting=-0.5 type=pf")); // the settings of another type are no power factors
}

TEST(DssCapControl, WithAnotherBusForItsOverrideListsThatBus) {
    std::string const text = kFirm + kLineToEnd + "New Capacitor.c bus1=end kvar=60 kv=4.16\n" +
                             "New CapControl.k element=line.l capacitor=c type=kvar vbus=end ";
    EXPECT_EQ(listed(text + "voltoverride=yes\n"),
              "Vbus of capcontrol.k: its own terminal overrides (changes the result)\n");
    EXPECT_EQ(listed(text + "\n"), "");
}

TEST(DssLine, OfConductorsHasItsOwnEarthWhereverThatIsSaid) {
    std::string text = kFirm + "New WireData.w rac=0.306 runits=mi gmrac=0.0244 gmrunits=ft radius=0.36 radunits=in\n"
                               "New LineSpacing.s nconds=3 nphases=3 x=[0 2.5 7] h=[28 28 28] units=ft\n"
                               "New LineGeometry.g nconds=3 nphases=3 spacing=s wires=[w w w]\n"
                               "New Load.l phases=1 bus1=end.1 kv=2.4 kw=500 kvar=200 model=2\n";
    auto const v = [&](std::string const& line, std::string const& options = "") {
        return solved(text + options + "New Line.l bus1=sourcebus bus2=end length=5 units=mi " + line + "\n")
            .v("end", 1);
    };
    Complex const usual = v("geometry=g"), high = v("rho=5000 geometry=g");
    EXPECT_GT(std::abs(high - usual), 1);
    EXPECT_LT(std::abs(v("geometry=g rho=5000") - high), 1e-6);
    EXPECT_LT(std::abs(v("spacing=s wires=[w w w] rho=5000") - high), 1e-6);
    Complex const carson = v("geometry=g", "Set EarthModel=Carson\n");
    EXPECT_GT(std::abs(carson - usual), 1e-3);
    EXPECT_LT(std::abs(v("geometry=g earthmodel=Carson") - carson), 1e-6);
    EXPECT_LT(std::abs(v("geometry=g earthmodel=Deri", "Set EarthModel=Carson\n") - usual), 1e-6);
}

} // namespace
} // namespace gridspace::opendss
