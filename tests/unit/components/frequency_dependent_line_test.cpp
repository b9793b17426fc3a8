// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Lines by their conductors, and frequency-dependent ones. Their transients against an inverse Laplace transform:
// tests/integration/simulate/frequency_dependent_test.py.
#include "sim/components/line/tower.hpp"
#include "sim/emt/solver.hpp"
#include "sim/line_constants/mode_fit.hpp"
#include "sim/line_constants/vector_fit.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::sim {
namespace {

using testing::HasSubstr;

constexpr double kNominalOmega = 2 * std::numbers::pi * 60;

/// A horizontal tower of 400 kV with two earth wires.
Tower tower_of_400_kv() {
    using Belongs = Tower::Belongs;
    Tower t;
    t.wires = {{Belongs::a, -10, 20, 0.015, 0.06},
               {Belongs::b, 0, 20, 0.015, 0.06},
               {Belongs::c, 10, 20, 0.015, 0.06},
               {Belongs::earth, -6, 28, 0.005, 0.5},
               {Belongs::earth, 6, 28, 0.005, 0.5}};
    return t;
}

std::array<ModePerMetre, 2> modes_of(Tower const& t) {
    auto const c = t.per_metre(1);
    return {ModePerMetre{[t](double omega) { return t.per_metre(omega).z1_ohm; }, c.c1_f},
            ModePerMetre{[t](double omega) { return t.per_metre(omega).z0_ohm; }, c.c0_f}};
}

/// Constant parameters per metre.
ModePerMetre constant_mode(double r_ohm, double l_h, double c_f) {
    return {[=](double omega) { return Complex{r_ohm, omega * l_h}; }, c_f};
}

TEST(Tower, HasTheImpedancesAndCapacitancesThatArePublishedForTheIeee4NodeFeeder) {
    // Sequence values of the published matrices (ohm and nF per mile, modified Carson's equations); the radius of a
    // solid wire is its geometric mean radius times exp(1/4).
    constexpr double kMile = 1609.344, kFoot = 0.3048;
    Tower sut;
    auto const wire = [&](Tower::Belongs phase, double x_ft, double h_ft, double ohm_per_mile, double gmr_ft) {
        sut.wires.push_back(
            {phase, x_ft * kFoot, h_ft * kFoot, gmr_ft * kFoot * std::exp(0.25), ohm_per_mile / 1.609344});
    };
    wire(Tower::Belongs::a, 0, 28, 0.306, 0.0244);
    wire(Tower::Belongs::b, 2.5, 28, 0.306, 0.0244);
    wire(Tower::Belongs::c, 7, 28, 0.306, 0.0244);
    wire(Tower::Belongs::earth, 4, 24, 0.592, 0.00814);
    auto const got = sut.per_metre(kNominalOmega);
    Complex const own{(0.4576 + 0.4666 + 0.4615) / 3, (1.0780 + 1.0482 + 1.0651) / 3};
    Complex const mutual{(0.1559 + 0.1535 + 0.1580) / 3, (0.5017 + 0.3849 + 0.4236) / 3};
    EXPECT_LT(std::abs(got.z1_ohm * kMile - (own - mutual)), 0.002);
    EXPECT_LT(std::abs(got.z0_ohm * kMile - (own + 2.0 * mutual)), 0.04); // 2 %: Deri's depth for Carson's first terms
}

TEST(Tower, OfOneWireHasThePublishedSkinEffect) {
    // R/R0 and L/L0 of a round wire over q = r sqrt(omega mu / rho) [tables of Rosa and Grover, Bulletin of the Bureau
    // of Standards 8(1), 1912]. Of three wires far from each other and the earth's resistance: differences.
    struct Row {
        double q, r, l;
    };
    for (Row const row : {Row{1, 1.00519, 0.99741}, Row{2, 1.07816, 0.96113}, Row{3, 1.31809, 0.84517},
                          Row{4, 1.67787, 0.68632}, Row{5, 2.04272, 0.55597}, Row{10, 3.79857, 0.28162}}) {
        double const r0 = 0.06e-3; // ohm/m = rho / (pi r^2): q^2 = omega mu0 / (pi r0)
        double const omega = row.q * row.q * r0 / 4e-7;
        Tower sut;
        sut.wires = {{Tower::Belongs::a, 0, 1e3, 0.01, 0.06},
                     {Tower::Belongs::b, 1e3, 1e3, 0.01, 0.06},
                     {Tower::Belongs::c, 2e3, 1e3, 0.01, 0.06}};
        sut.earth_ohm_m = 1e-9; // a perfect mirror
        Complex const z = sut.per_metre(omega).z1_ohm;
        // Own images at 2 km; neighbours at 1, 1 and 2 km with theirs.
        double const own = std::log(2e3 / 0.01),
                     mutual = (2 * std::log(std::hypot(1, 2)) + std::log(std::hypot(2, 2) / 2)) / 3;
        EXPECT_NEAR(z.real() / r0, row.r, 2e-5 * row.r) << row.q;
        EXPECT_NEAR((z.imag() / omega - 2e-7 * (own - mutual)) / 0.5e-7, row.l, 1e-4) << row.q;
    }
}

TEST(Tower, TakesSeveralConductorsOfAPhaseForABundle) {
    Tower sut = tower_of_400_kv();
    auto const single = sut.per_metre(kNominalOmega);
    auto const wires = sut.wires;
    for (std::size_t k = 0; k < 3; ++k) {
        sut.wires.push_back(wires[k]);
        sut.wires.back().x_m += 0.4;
    }
    auto const bundle = sut.per_metre(kNominalOmega);
    EXPECT_NEAR(bundle.z1_ohm.real(), single.z1_ohm.real() / 2, 0.01 * single.z1_ohm.real());
    // The bundle's radius is sqrt(r d): GMR sqrt(0.7788 r d).
    double const gain = 2e-7 * std::log(std::sqrt(0.7788 * 0.015 * 0.4) / (0.7788 * 0.015));
    EXPECT_NEAR((single.z1_ohm - bundle.z1_ohm).imag() / kNominalOmega, gain, 0.01 * gain);
    EXPECT_GT(bundle.c1_f, 1.2 * single.c1_f);
}

TEST(Tower, IsATransmissionLineWhoseWavesTravelAtTheSpeedOfLight) {
    auto const sut = tower_of_400_kv().per_metre(2 * std::numbers::pi * 1e12);
    EXPECT_NEAR(std::sqrt(sut.z1_ohm.imag() / (2 * std::numbers::pi * 1e12) * sut.c1_f) * 299792458, 1, 1e-4);
    EXPECT_NEAR(std::sqrt(sut.z0_ohm.imag() / (2 * std::numbers::pi * 1e12) * sut.c0_f) * 299792458, 1, 1e-3);
}

TEST(VectorFit, FindsTheRationalFunctionThatItsSamplesAreOf) {
    emt::PoleSum const expected{3, {2, 50, 900, 2e4}, {1, -20, 4000, 1e4}};
    FrequencyResponse samples;
    for (int k = 0; k <= 60; ++k) {
        samples.omega.push_back(std::pow(10, k / 10.0 - 1));
        samples.value.push_back(expected.at({0, samples.omega.back()}));
        samples.weight.push_back(1);
    }
    auto const sut = vector_fit(samples, samples.omega.size(), 4, 20);
    EXPECT_LT(fit_error(samples, samples.omega.size(), sut), 1e-9);
    for (std::size_t k = 0; k < 4; ++k) {
        EXPECT_NEAR(sut.poles[k], expected.poles[k], 1e-6 * expected.poles[k]);
        EXPECT_NEAR(sut.residues[k], expected.residues[k], 1e-6 * std::abs(expected.residues[k]));
    }
}

TEST(ModeFit, IsNearTheExactFunctionsStablePassiveAndExactAtTheNominalFrequency) {
    for (double const km : {5.0, 20.0, 100.0, 400.0, 1000.0}) {
        for (double const earth : {10.0, 100.0, 3000.0}) {
            Tower tower = tower_of_400_kv();
            tower.earth_ohm_m = earth;
            for (ModePerMetre const& mode : modes_of(tower)) {
                auto const sut = fit_mode(mode, 1e3 * km, kNominalOmega);
                ASSERT_TRUE(sut.has_value()) << km << ' ' << earth << ' ' << describe(sut.error());
                double worst_z = 0, worst_a = 0, gain = 0, least_r = 1e9;
                for (double hz = 1e-3; hz < 1e8; hz *= 1.1) {
                    Complex const s{0, 2 * std::numbers::pi * hz};
                    Complex const z = sut->impedance.at(s), a = sut->propagation.at(s) * std::exp(-s * sut->tau_s);
                    gain = std::max(gain, std::abs(a));
                    least_r = std::min(least_r, z.real());
                    if (hz < 1e4) {
                        worst_z = std::max(worst_z, std::abs(z / mode.surge_ohm(s.imag()) - 1.0));
                        worst_a = std::max(worst_a, std::abs(a - std::exp(-mode.per_m(s.imag()) * 1e3 * km)));
                    }
                }
                EXPECT_LT(worst_z, 2e-3) << km << ' ' << earth;
                EXPECT_LT(worst_a, 5e-3) << km << ' ' << earth;
                EXPECT_LT(gain, 1 + 1e-6) << km << ' ' << earth;
                EXPECT_GT(least_r, 0) << km << ' ' << earth;
                EXPECT_GE(sut->tau_s, 1e3 * km / 299792458 * 0.99);
                Complex const s{0, kNominalOmega};
                EXPECT_LT(std::abs(sut->impedance.at(s) / mode.surge_ohm(kNominalOmega) - 1.0), 1e-7) << km;
                Complex const a = std::exp(-mode.per_m(kNominalOmega) * 1e3 * km);
                EXPECT_LT(std::abs(sut->propagation.at(s) * std::exp(-s * sut->tau_s) - a), 1e-7 * std::abs(1.0 - a))
                    << km;
            }
        }
    }
}

/// Source - line - open end, energised; voltage there over 20 ms. A source without a zero sequence sees one mode.
std::vector<double> open_end(emt::Circuit c, int line_end, double step_s) {
    emt::Solver solver{std::move(c), step_s};
    EXPECT_TRUE(solver.start({}).has_value());
    solver.close_switch(0);
    std::vector<double> out;
    for (int n = 1; n * step_s < 0.02; ++n) {
        EXPECT_TRUE(solver.advance(n * step_s, step_s).has_value());
        out.push_back(solver.node_voltage(line_end));
    }
    return out;
}

TEST(MartiLine, OfConstantParametersIsTheTravellingWaveLine) {
    constexpr double kLength = 100e3, kStep = 5e-6;
    auto const circuit = [](bool marti, double r_ohm) {
        emt::Circuit c;
        int const outer = c.add_triple("source"), near = c.add_triple("near"), far = c.add_triple("far");
        c.sources.push_back({outer, 100, 0, 60, {}, "S"});
        c.switches.push_back({outer, near, {false, false, false}, {}, "CB"});
        double const l = 1e-6, c_f = 12e-12;
        if (marti) {
            auto const mode = *fit_mode(constant_mode(r_ohm, l, c_f), kLength, kNominalOmega);
            c.marti.push_back({near, far, mode, mode, "L"});
        } else {
            double const z = std::sqrt(l / c_f), tau = std::sqrt(l * c_f) * kLength, r = r_ohm * kLength;
            c.bergeron.push_back({near, far, z, z, tau, tau, r, r, "L"});
        }
        return std::pair{c, far};
    };
    for (double const r_ohm : {1e-5, 1e-4}) { // 1 and 10 ohm of a surge impedance of 289 ohm
        auto const [ours, end] = circuit(true, r_ohm);
        auto const [theirs, same_end] = circuit(false, r_ohm);
        auto const got = open_end(ours, end, kStep), expected = open_end(theirs, same_end, kStep);
        double square = 0;
        for (std::size_t n = 0; n < got.size(); ++n) {
            square += std::pow((got[n] - expected[n]) / 100, 2);
        }
        EXPECT_LT(std::sqrt(square / static_cast<double>(got.size())), 0.02) << r_ohm;
    }
}

constexpr std::string_view kTowerLine =
    "buses: {A: {voltage_v: 400000}, B: {voltage_v: 400000}}\n"
    "sources: {S: {bus: A, r_ohm: 1, l_mh: 20}, T: {bus: B, angle_deg: -10, r_ohm: 1, l_mh: 30, r0_ohm: 2, l0_mh: "
    "20}}\n"
    "line_types: {t: {conductors: [{phase: a, x_m: -10, height_m: 20, radius_m: 0.015, dc_ohm_per_km: 0.06}, "
    "{phase: b, x_m: 0, height_m: 20, radius_m: 0.015, dc_ohm_per_km: 0.06}, "
    "{phase: c, x_m: 10, height_m: 20, radius_m: 0.015, dc_ohm_per_km: 0.06}, "
    "{phase: earth, x_m: 0, height_m: 28, radius_m: 0.005, dc_ohm_per_km: 0.5}]}}\n";

std::string tower_line(std::string const& lines, std::string const& more = "") {
    return std::string{kTowerLine} + "lines: {" + lines + "}\n" + more;
}

Network network_with(std::string const& text) {
    Network n;
    auto const diagnostics =
        read_text("gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 100000}\n" + text, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

std::unique_ptr<Engine> started(std::string const& solver, std::string const& text) {
    auto engine = make(solver, network_with(text), TimeBase{Rational{1, 48000}});
    must(engine->initialise());
    return engine;
}

TEST(FrequencyDependentLine, StartsInItsSteadyStateWhichIsThatOfThePowerFlow) {
    std::string const text = tower_line(
        "L: {from: A, to: B, type: t, length_km: 200, model: frequency_dependent, fault_places_percent: [30]}");
    auto const sut = started("emt", text);
    double const v = read(*sut, "bus.B.v_pu"), i = read(*sut, "line.L.from.i_a");
    for (int n = 1; n <= 4800; ++n) {
        ASSERT_TRUE(sut->advance(SimTime{n}).has_value());
        ASSERT_NEAR(read(*sut, "bus.B.v_pu"), v, 1e-9) << n;
        ASSERT_NEAR(read(*sut, "line.L.from.i_a"), i, 1e-9 * i) << n;
    }
    auto const phasors = started("phasor", text);
    EXPECT_NEAR(read(*phasors, "bus.B.v_pu"), v, 2e-5);
    EXPECT_NEAR(read(*phasors, "line.L.from.i_a"), i, 1e-4 * i);
    EXPECT_NEAR(read(*phasors, "line.L.from.p_kw"), read(*sut, "line.L.from.p_kw"), 1e-4 * 1e6);
}

TEST(FrequencyDependentLine, HasAFaultAtOneOfItsPlacesAsAtABusThere) {
    ApplyFault const inside{"L", "", 40, FaultType::phase_ground, 2, "f"},
        at_bus{"", "M", 0, FaultType::phase_ground, 2, "f"};
    auto const sut = started("emt", tower_line("L: {from: A, to: B, type: t, length_km: 100, model: "
                                               "frequency_dependent, fault_places_percent: [40, 70]}"));
    std::string two = tower_line("L: {from: A, to: M, type: t, length_km: 40, model: frequency_dependent}, "
                                 "R: {from: M, to: B, type: t, length_km: 60, model: frequency_dependent, "
                                 "fault_places_percent: [50]}");
    two.replace(two.find("buses: {"), 8, "buses: {M: {voltage_v: 400000}, ");
    auto const oracle = started("emt", two);
    double worst = 0, peak = 0;
    for (int n = 1; n <= 2400; ++n) {
        ASSERT_TRUE(sut->advance(SimTime{n}).has_value());
        ASSERT_TRUE(oracle->advance(SimTime{n}).has_value());
        if (n == 400) {
            ASSERT_TRUE(sut->apply(inside).has_value());
            ASSERT_TRUE(oracle->apply(at_bus).has_value());
        }
        if (n == 1200) {
            ASSERT_TRUE(sut->apply(ClearFault{"f"}).has_value()); // at a current zero inside a step: it is taken back
            ASSERT_TRUE(oracle->apply(ClearFault{"f"}).has_value());
        }
        worst = std::max({worst, std::abs(read(*sut, "line.L.from.i.a") - read(*oracle, "line.L.from.i.a")),
                          std::abs(read(*sut, "line.L.to.i.a") - read(*oracle, "line.R.to.i.a"))});
        peak = std::max(peak, std::abs(read(*oracle, "line.L.from.i.a")));
    }
    EXPECT_LT(worst, 1e-6 * peak);
    EXPECT_GT(peak, 2000);
    auto const refused = sut->apply(ApplyFault{"L", "", 55, FaultType::phase_ground, 2, "g"});
    ASSERT_FALSE(refused.has_value());
    EXPECT_THAT(refused.error().message, HasSubstr("a fault at 55 % of line 'L' cannot be"));
    EXPECT_THAT(refused.error().remedy, HasSubstr("fault_places_percent"));
}

TEST(FrequencyDependentLine, KeepsItsChargeWhenItIsSwitchedOff) {
    std::string text = tower_line("L: {from: A, to: B, type: t, length_km: 100, model: frequency_dependent}",
                                  "breaker_types: {t: {}}\nbreakers: {K: {line: L, end: from, type: t}}\n");
    std::size_t const other = text.find(", T: {bus: B");
    text.erase(other, text.find("}\n", other) - other);
    auto const sut = started("emt", text);
    must(sut->apply(SwitchBreaker{"K", false}));
    auto const charge = [&](std::int64_t t) { // mean over a millisecond: what is left swings at the quarter wave
        double sum = 0;
        for (int n = 0; n < 66; ++n) {
            must(sut->advance(SimTime{t + n}));
            sum += read(*sut, "bus.B.v.a") / 66;
        }
        return sum;
    };
    double const before = charge(9600), after = charge(57600);
    EXPECT_GT(std::abs(before), 0.8 * 400e3 * std::sqrt(2.0 / 3));
    EXPECT_NEAR(after / before, std::exp(-1.0 / 100), 0.003); // its leakage has a time constant of 100 s
}

/// The columns of a table of this tower, four a decade; or as if its constants were those at 60 Hz.
std::string table_of(Tower const& tower, bool constant) {
    std::string columns[5];
    for (double hz = 0.1; hz < 1.5e6; hz *= std::pow(10, 0.25)) {
        double const omega = 2 * std::numbers::pi * (constant ? 60 : hz);
        auto const m = tower.per_metre(omega);
        double const values[] = {hz, m.z1_ohm.real() * 1e3, m.z1_ohm.imag() / omega * 1e6, m.z0_ohm.real() * 1e3,
                                 m.z0_ohm.imag() / omega * 1e6};
        for (int k = 0; k < 5; ++k) {
            columns[k] += fmt::format("{}{}", columns[k].empty() ? "" : ", ", values[k]);
        }
    }
    auto const c = tower.per_metre(1);
    return fmt::format("c_nf_per_km: {}, c0_nf_per_km: {}, by_frequency: {{hz: [{}], r_ohm_per_km: [{}], "
                       "l_mh_per_km: [{}], r0_ohm_per_km: [{}], l0_mh_per_km: [{}]}}",
                       c.c1_f * 1e12, c.c0_f * 1e12, columns[0], columns[1], columns[2], columns[3], columns[4]);
}

TEST(FrequencyDependentLine, OfATableIsTheOneOfTheConductorsThatTheTableIsOf) {
    Tower const tower = tower_of_400_kv();
    std::string conductors;
    for (Tower::Wire const& w : tower.wires) {
        constexpr std::string_view kNames[] = {"a", "b", "c", "earth"};
        conductors += fmt::format("{}{{phase: {}, x_m: {}, height_m: {}, radius_m: {}, dc_ohm_per_km: {}}}",
                                  conductors.empty() ? "" : ", ", kNames[static_cast<int>(w.phase)], w.x_m, w.height_m,
                                  w.radius_m, w.dc_ohm_per_km);
    }
    auto const run = [](std::string const& type) {
        auto const sut = started(
            "emt",
            "buses: {A: {voltage_v: 400000}, B: {voltage_v: 400000}}\nsources: {S: {bus: A, r_ohm: 1, l_mh: 20}}\n"
            "line_types: {t: {" +
                type +
                "}}\n"
                "lines: {L: {from: A, to: B, type: t, length_km: 100, model: frequency_dependent}}\n");
        must(sut->apply(ApplyFault{"", "B", 0, FaultType::phase_ground, 5, "f"}));
        std::vector<double> out;
        for (int n = 1; n <= 1500; ++n) {
            must(sut->advance(SimTime{n}));
            out.push_back(read(*sut, "bus.B.v.b"));
        }
        return out;
    };
    auto const expected = run("conductors: [" + conductors + "]");
    auto const apart = [&](std::vector<double> const& got) {
        double square = 0;
        for (std::size_t n = 0; n < got.size(); ++n) {
            square += std::pow(got[n] - expected[n], 2);
        }
        return std::sqrt(square / static_cast<double>(got.size())) / (400e3 * std::sqrt(2.0 / 3));
    };
    EXPECT_LT(apart(run(table_of(tower, false))), 2e-3);
    EXPECT_GT(apart(run(table_of(tower, true))), 0.02); // negative control
}

TEST(FrequencyDependentLine, NeedsAStepShorterThanItsTravelTime) {
    TimeBase const base{Rational{1, 48000}};
    auto const made = emt::make_emt_engine(
        network_with(tower_line("L: {from: A, to: B, type: t, length_km: 100, model: frequency_dependent, "
                                "fault_places_percent: [5]}")),
        {base, SimSpan{1}, 0});
    ASSERT_FALSE(made.has_value());
    EXPECT_THAT(made.error().message,
                HasSubstr("line 'L': a wave travels along it in 16.7 us, less than a step of 20.8 us"));
}

TEST(FrequencyDependentLine, SaysWhatIsWrongWithItsData) {
    auto const mistakes = [](std::string const& type, std::string const& line) {
        std::string const text = "gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 1000}\n"
                                 "buses: {A: {voltage_v: 20000}, B: {voltage_v: 20000}}\nsources: {S: {bus: A}}\n"
                                 "line_types: {t: {" +
                                 type + "}}\nlines: {L: {from: A, to: B, " + line + "}}\n";
        Network n;
        auto const diagnostics = read_text(text, n);
        return diagnostics.render();
    };
    std::string const wire = "radius_m: 0.01, dc_ohm_per_km: 0.1}";
    std::string const three = "{phase: a, x_m: 0, height_m: 10, " + wire + ", {phase: b, x_m: 2, height_m: 10, " +
                              wire + ", {phase: c, x_m: 4, height_m: 10, " + wire;
    std::string const line = "type: t, length_km: 30, model: frequency_dependent";
    EXPECT_EQ(mistakes("conductors: [" + three + "]", line), "");
    EXPECT_THAT(mistakes("r_ohm_per_km: 0.1, x_ohm_per_km: 0.3", line),
                HasSubstr("line 'L' is frequency dependent, but nothing says how"));
    EXPECT_THAT(mistakes("conductors: [" + three + "], c_nf_per_km: 9", line),
                HasSubstr("both conductors and c_nf_per_km"));
    std::string const table =
        "by_frequency: {hz: [1, 1000, 100000], r_ohm_per_km: [0.1, 0.3, 3], l_mh_per_km: [1, 0.95, 0.9], "
        "r0_ohm_per_km: [0.2, 1, 40], l0_mh_per_km: [4, 3, 2]}";
    EXPECT_EQ(mistakes(table + ", c_nf_per_km: 10", line), "");
    EXPECT_THAT(mistakes(table, line), HasSubstr("line type 't' is no line: it has no capacitance"));
    EXPECT_THAT(mistakes(table + ", c_nf_per_km: 10, l_mh_per_km: 1", line),
                HasSubstr("both by_frequency and l_mh_per_km"));
    auto const short_table = [](std::string const& hz, std::string const& r) {
        return "by_frequency: {hz: " + hz + ", r_ohm_per_km: " + r +
               ", l_mh_per_km: [1, 1], r0_ohm_per_km: [1, 1], l0_mh_per_km: [1, 1]}, c_nf_per_km: 10";
    };
    EXPECT_THAT(mistakes(short_table("[1, 9]", "[1]"), line), HasSubstr("it has 2 frequencies and 1 values"));
    EXPECT_THAT(mistakes(short_table("[9, 9]", "[1, 1]"), line), HasSubstr("its frequencies do not rise"));
    EXPECT_THAT(mistakes(short_table("[9, 900]", "[1, 0.1]"), line), HasSubstr("its r and l do not belong together"));
    EXPECT_THAT(mistakes("conductors: [{phase: a, x_m: 0, height_m: 10, " + wire + "]", line),
                HasSubstr("phase b has no conductor"));
    EXPECT_THAT(mistakes("conductors: [" + three + ", {phase: earth, x_m: 4, height_m: 10.01, " + wire + "]", line),
                HasSubstr("its conductors 3 and 4 are in one place"));
    EXPECT_THAT(mistakes("conductors: [" + three + "]", line + ", fault_places_percent: [60, 40]"),
                HasSubstr("do not rise"));
    EXPECT_THAT(mistakes("conductors: [" + three + "]", "type: t, length_km: 30, fault_places_percent: [60]"),
                HasSubstr("a fault can be anywhere in it"));
    EXPECT_THAT(mistakes("r_ohm_per_km: 0.1, x_ohm_per_km: 0.3, earth_ohm_m: 10", "type: t, length_km: 3"),
                HasSubstr("no conductors over its earth"));
}

} // namespace
} // namespace gridspace::sim
