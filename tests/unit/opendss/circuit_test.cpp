// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

#include <cmath>

namespace gridspace::opendss {
namespace {

std::string const kStiff = "New Circuit.c basekv=4.16 r1=0 x1=1e-6 r0=0 x0=1e-6\n";

/// Values of tests/golden/opendss/small_circuits.py: loop equations, solved with scipy. Volts, degrees.
using Reference = std::pair<double, double>;
constexpr Reference kLateralB{2320.089364, -121.641883}, kLateralC{2404.384566, 119.844436},
    kDeltaWyeA{275.349355, -30.339078}, kDeltaWyeB{277.128129, -150.0}, kOpenDelta12{4028.328455, -1.331316},
    kOpenDelta23{4090.078286, -122.420970}, kCentreTapped1{119.251654, -0.480326},
    kCentreTapped2{119.366042, 179.550723};

void expect_phasor(Complex got, Reference reference) {
    EXPECT_NEAR(std::abs(got), reference.first, reference.first * 1e-4);
    EXPECT_NEAR(std::remainder(degrees(got) - reference.second, 360), 0, 0.01);
}

TEST(DssCircuit, SolvesATwoPhaseLateralWithConstantPowerAndConstantCurrentBetweenPhases) {
    Solved const s = solved("New Circuit.c basekv=4.16 Z1=[0.1 0.5] Z0=[0.3 1.5]\n"
                            "New Linecode.m nphases=2 units=mi rmatrix=(1.3238 | 0.2066 1.3294) "
                            "xmatrix=(1.3569 | 0.4591 1.3471) cmatrix=[0 | 0 0]\n"
                            "New Line.l bus1=sourcebus.2.3 bus2=end.2.3 linecode=m length=2640 units=ft\n"
                            "New Load.b phases=1 bus1=end.2 kv=2.4 kw=100 kvar=50 vminpu=0.5 vmaxpu=2\n"
                            "New Load.bc phases=1 conn=delta bus1=end.2.3 kv=4.16 kw=80 kvar=40 model=5 vminpu=0.5\n");
    expect_phasor(s.v("end", 2), kLateralB);
    expect_phasor(s.v("end", 3), kLateralC);
}

TEST(DssCircuit, SolvesOneSinglePhaseLoadBehindADeltaWyeTransformer) {
    Solved const s =
        solved(kStiff + "New Transformer.t buses=[sourcebus low] conns=[delta wye] kVs=[4.16 0.48] kVA=500 "
                        "XHL=2 %Rs=[0.55 0.55] ppm=0\n"
                        "New Load.a phases=1 bus1=low.1 kv=0.277 kw=60 kvar=20 vminpu=0.5 vmaxpu=2\n");
    expect_phasor(s.v("low", 1), kDeltaWyeA);
    expect_phasor(s.v("low", 2), kDeltaWyeB);
}

TEST(DssCircuit, SolvesAnOpenDeltaOfTwoTransformers) {
    std::string text = "New Circuit.c basekv=12.470765814 r1=0 x1=1e-6 r0=0 x0=1e-6\n";
    for (char const* row : {"a buses=[sourcebus.1.0 low.1.2]", "b buses=[sourcebus.2.0 low.2.3]"}) {
        text += std::string{"New Transformer."} + row +
                " phases=1 conns=[wye delta] kVs=[7.2 4.16] kVA=2000 XHL=6 %Rs=[0.5 0.5] ppm=0\n";
    }
    text += "New Load.ab phases=1 conn=delta bus1=low.1.2 kv=4.16 kw=850 kvar=526 model=2\n"
            "New Load.bc phases=1 conn=delta bus1=low.2.3 kv=4.16 kw=1200 kvar=581 model=2\n"
            "New Load.ca phases=1 conn=delta bus1=low.3.1 kv=4.16 kw=400 kvar=100 model=2\n";
    Solved const s = solved(text);
    expect_phasor(s.v("low", 1) - s.v("low", 2), kOpenDelta12);
    expect_phasor(s.v("low", 2) - s.v("low", 3), kOpenDelta23);
}

TEST(DssCircuit, SolvesACentreTappedServiceTransformer) {
    Solved const s = solved("New Circuit.c basekv=12.470765814 r1=0 x1=1e-6 r0=0 x0=1e-6\n"
                            "New XfmrCode.ct phases=1 windings=3 kvs=[7.2 0.12 0.12] kVAs=[25 25 25] %Rs=[0.6 1.2 1.2] "
                            "Xhl=2.04 Xht=2.04 Xlt=1.36\n"
                            "New Transformer.t xfmrcode=ct buses=[sourcebus.1 low.1.0 low.0.2]\n"
                            "New Load.l1 phases=1 bus1=low.1 kv=0.12 kw=5 pf=1 model=2\n"
                            "New Load.l2 phases=1 bus1=low.2 kv=0.12 kw=3 pf=1 model=2\n"
                            "New Load.l12 phases=1 bus1=low.1.2 kv=0.24 kw=4 pf=1 model=2\n");
    expect_phasor(s.v("low", 1), kCentreTapped1);
    expect_phasor(s.v("low", 2), kCentreTapped2);
}

TEST(DssCircuit, LinesByMatrixByComponentsAndInOtherUnitsAreTheSame) {
    std::string const load = "New Load.l phases=1 bus1=end.1 kv=2.4 kw=300 kvar=100 model=2\n";
    std::string const ends = "bus1=sourcebus bus2=end ";
    std::string const same[] = {"New Line.l " + ends + "r1=0.3 x1=0.6 r0=0.9 x0=1.8 c1=10 c0=4 length=2 units=km\n",
                                "New Linecode.k units=km r1=0.3 x1=0.6 r0=0.9 x0=1.8 c1=10 c0=4\nNew Line.l " + ends +
                                    "linecode=k length=2000 units=m\n",
                                "New Line.l " + ends +
                                    "rmatrix=[0.5 | 0.2 0.5 | 0.2 0.2 0.5] xmatrix=[1 0.4 0.4 | 0.4 1 0.4 | 0.4 0.4 1] "
                                    "cmatrix=(8 | -2 8 | -2 -2 8) length=2\n",
                                "New Line.l " + ends +
                                    "r1=0.1 x1=0.6 r0=0.1 x0=1.8 c1=10 c0=4 "
                                    "rmatrix=[0.5 | 0.2 0.5 | 0.2 0.2 0.5] length=2\n",
                                "New Line.l " + ends +
                                    "r1=0.3 r0=0.9 cmatrix=(8 | -2 8 | -2 -2 8) "
                                    "xmatrix=[1 0.4 0.4 | 0.4 1 0.4 | 0.4 0.4 1] length=2\n",
                                "New Linecode.k basefreq=50 r1=0.3 x1=0.5 r0=0.9 x0=1.5 c1=10 c0=4\nNew Line.l " +
                                    ends + "linecode=k length=2\n"};
    Complex const expected = solved(kStiff + same[0] + load).v("end", 1);
    EXPECT_LT(std::abs(expected), 2390);
    for (std::string const& line : same) {
        EXPECT_LT(std::abs(solved(kStiff + line + load).v("end", 1) - expected), 1e-6) << line;
    }
    std::string other = same[0];
    other.replace(other.find("units=km"), 8, "units=mi"); // the same numbers, of another unit, on the same line
    EXPECT_LT(std::abs(solved(kStiff + other + load).v("end", 1) - expected), 1e-6);
    Complex const shorter =
        solved(kStiff + "New Line.l " + ends + "r1=0.3 x1=0.6 r0=0.9 x0=1.8 length=1\n" + load).v("end", 1);
    EXPECT_GT(std::abs(shorter - expected), 10); // the negative control
}

TEST(DssCircuit, ASourceHasTheShortCircuitPowersItIsGiven) {
    // A fault of nothing but reactors: 1 milliohm to earth on one phase, and on all three.
    std::string const circuit = "New Circuit.c basekv=115 MVAsc3=2000 MVAsc1=2100 x1r1=4 x0r0=3\n";
    Solved const one = solved(circuit + "New Reactor.f phases=1 bus1=sourcebus.1 r=1e-6 x=0\n");
    EXPECT_NEAR(std::abs(one.v("sourcebus", 1)) / 1e-6, 2100e6 / std::sqrt(3.0) / 115e3, 1);
    Solved const three = solved(circuit + "New Reactor.f phases=3 bus1=sourcebus r=1e-6 x=0\n");
    EXPECT_NEAR(std::abs(three.v("sourcebus", 1)) / 1e-6, 2000e6 / std::sqrt(3.0) / 115e3, 1);
}

TEST(DssCircuit, CapacitorsGiveTheirNominalPowerInStarAndInDelta) {
    for (char const* how : {"conn=wye kv=4.16", "conn=delta kv=4.16", "conn=wye kv=4.16 numsteps=3 states=[1 1 1]"}) {
        Solved const s = solved(kStiff + "New Capacitor.c bus1=sourcebus kvar=600 " + how + "\n");
        EXPECT_NEAR(s.flow.source_va.imag(), -600e3, 200) << how;
    }
    Solved const off = solved(kStiff + "New Capacitor.c bus1=sourcebus kvar=600 kv=4.16 states=[0]\n");
    EXPECT_NEAR(off.flow.source_va.imag(), 0, 1);
    Solved const one = solved(kStiff + "New Capacitor.c phases=1 bus1=sourcebus.2 kvar=100 kv=2.4017771\n");
    EXPECT_NEAR(one.flow.source_va.imag(), -100e3, 10);
}

TEST(DssCircuit, PowersAddUp) {
    Solved const s = solved("New Circuit.c basekv=4.16 Z1=[0.1 0.5] Z0=[0.3 1.5]\n"
                            "New Line.l bus1=sourcebus bus2=end r1=0.3 x1=0.6 r0=0.9 x0=1.8 c1=10 c0=4 length=2\n"
                            "New Load.a phases=1 bus1=end.1 kv=2.4 kw=100 kvar=50\n"
                            "New Load.d bus1=end conn=delta kv=4.16 kw=200 pf=0.9 model=5\n"
                            "New Generator.g bus1=end kv=4.16 kw=120 kvar=10\n"
                            "New PVSystem.p phases=1 bus1=end.3 kv=2.4 pmpp=30 irradiance=0.8 kva=40\n");
    Complex const rest = s.flow.source_va + s.flow.generated_va - s.flow.consumed_va - s.flow.losses_va;
    EXPECT_LT(std::abs(rest), 1); // of 300 kVA
    EXPECT_NEAR(s.flow.generated_va.real(), 144e3, 1);
}

TEST(DssCircuit, ALoadInStarOnItsOwnNeutralLetsItFloat) {
    std::string const loads = "New Load.l phases=3 bus1=sourcebus.1.2.3.4 kv=4.16 kw=300 pf=1 model=2\n"
                              "New Load.m phases=1 bus1=sourcebus.1.4 kv=2.4 kw=300 pf=1 model=2\n";
    Solved const s = solved(kStiff + loads);
    // Two conductances of star point: (100 + 300) kW on a, 100 kW each on b and c.
    double const e = 4160 / std::sqrt(3.0), heavy = 100e3 / (e * e) + 300e3 / (2400.0 * 2400.0),
                 light = 100e3 / (e * e);
    EXPECT_NEAR(std::abs(s.v("sourcebus", 4)), e * (heavy - light) / (heavy + 2 * light), 0.5);
    Solved const earthed = solved(kStiff + loads + "~ rneut=0\n");
    EXPECT_LT(std::abs(earthed.v("sourcebus", 4)), 1);
}

TEST(DssCircuit, OpenTakesAConductorOut) {
    std::string const line = "New Line.l bus1=sourcebus bus2=end r1=0.3 x1=0.6 r0=0.9 x0=1.8 c1=0 c0=0\n"
                             "New Load.l bus1=end kv=4.16 kw=300 pf=1 model=2\n";
    Solved const whole = solved(kStiff + line), one = solved(kStiff + line + "open line.l 1 2\n"),
                 all = solved(kStiff + line + "open line.l 2\nclose line.l 2\nopen line.l 1\n");
    EXPECT_GT(std::abs(whole.v("end", 2)), 2300);
    EXPECT_LT(std::abs(one.v("end", 2)), 150); // coupled from the other phases
    EXPECT_GT(std::abs(one.v("end", 1)), 2300);
    EXPECT_LT(std::abs(all.v("end", 1)), 1);
}

TEST(DssCircuit, ARegulatorStepsItsTapIntoItsBandAndCompensatesTheLine) {
    std::string const feeder =
        "New Transformer.reg phases=1 buses=[sourcebus.1 reg.1] kVs=[2.4 2.4] kVA=2000 XHL=0.01 %loadloss=0.001\n"
        "New Line.l phases=1 bus1=reg.1 bus2=end.1 r1=0.5 x1=1 c1=0\n"
        "New Load.l phases=1 bus1=end.1 kv=2.4 kw=400 kvar=200 vminpu=0.5 vmaxpu=2\n";
    std::string const control = "New RegControl.r transformer=reg winding=2 vreg=122 band=2 ptratio=20 ";
    Solved const local = solved(kStiff + feeder + control + "\n");
    EXPECT_NEAR(std::abs(local.v("reg", 1)) / 20, 122, 1);
    // R and X of the line in volts of the relay: 0.5 and 1 ohm times 100 A / 20. Then the end is held.
    Solved const compensated = solved(kStiff + feeder + control + "ctprim=100 R=2.5 X=5\n");
    EXPECT_NEAR(std::abs(compensated.v("end", 1)) / 20, 122, 1.01);
    EXPECT_NEAR(std::abs(compensated.v("end", 1)) / 20, compensated.flow.regulators[0].measured_v, 0.1);
    EXPECT_GT(tap_position(compensated.circuit.regulators[0], compensated.circuit),
              tap_position(local.circuit.regulators[0], local.circuit));
    Solved const fixed = solved(kStiff + feeder + control + "maxtapchange=0 tapnum=3\n");
    EXPECT_EQ(tap_position(fixed.circuit.regulators[0], fixed.circuit), 3);
    Solved const off = solved(kStiff + feeder + control + "\nSet ControlMode=off\n");
    EXPECT_EQ(tap_position(off.circuit.regulators[0], off.circuit), 0);
}

TEST(DssCircuit, ACapacitorControlSwitchesByWhatItMeasures) {
    std::string const feeder = "New Line.l bus1=sourcebus bus2=end r1=0.3 x1=0.6 r0=0.9 x0=1.8 c1=0 c0=0\n"
                               "New Load.l bus1=end kv=4.16 kw=300 kvar=100 model=2\n"
                               "New Capacitor.c bus1=end kvar=600 kv=4.16\n"
                               "New CapControl.k element=line.l capacitor=c type=kvar onsetting=200 offsetting=";
    EXPECT_FALSE(solved(kStiff + feeder + "-225\n").circuit.elements.back().in_service); // -500 kvar: it opens
    EXPECT_TRUE(solved(kStiff + feeder + "-900\n").circuit.elements.back().in_service);
}

TEST(DssCircuit, RefusesWhatHasNoSolutionAndSaysWhy) {
    EXPECT_THAT(mistakes(kStiff + "New Line.l bus1=sourcebus bus2=end r1=0 x1=0 r0=0 x0=0\n"),
                testing::HasSubstr("line.l has an impedance without an inverse"));
    EXPECT_THAT(mistakes(kStiff + "New Line.l bus1=sourcebus bus2=end cncables=[a a a]\n"),
                testing::HasSubstr("main.dss:2:46: error: line.l: cncables are given"));
    EXPECT_THAT(mistakes(kStiff + "New Line.l bus1=sourcebus.1.x bus2=end\n"),
                testing::HasSubstr("'x' of bus 'sourcebus' is not a node"));
    EXPECT_THAT(mistakes(kStiff + "New Load.l bus1=a kv=0\n"), testing::HasSubstr("load.l: kv is 0"));
    EXPECT_THAT(mistakes(kStiff + "New Load.l phases=3.5 bus1=a\n"), testing::HasSubstr("phases is 3.5"));
    EXPECT_THAT(mistakes("! nothing\n"), testing::HasSubstr("the script makes no circuit"));
    EXPECT_THAT(mistakes(kStiff + "New Load.l bus1=island kv=4.16\n"),
                testing::HasSubstr("1 of 2 buses are connected to no source"));
    config::Diagnostics diagnostics;
    Script const script = script_of(kStiff + "New Line.l bus1=sourcebus bus2=end r1=0.3 x1=0.6 r0=0.9 x0=1.8\n"
                                             "New Load.l bus1=end kv=4.16 kw=50000 vminpu=0.01 vlowpu=0\n",
                                    diagnostics);
    auto circuit = build_circuit(script, diagnostics);
    ASSERT_TRUE(circuit.has_value()) << diagnostics.render();
    auto const flow = solve_circuit(*circuit);
    ASSERT_FALSE(flow.has_value());
    EXPECT_THAT(flow.error().message, testing::HasSubstr("does not converge"));
}

} // namespace
} // namespace gridspace::opendss
