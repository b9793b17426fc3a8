// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Unbalanced faults in phasors, breakers with a mechanism, limits as events, fixed steps: against closed forms, against
// waveforms and against the adaptive integration.
#include "sim/phasor/phasor_engine.hpp"
#include "sim/phasor/sequence_networks.hpp"
#include "tests/unit/emt/emt_fixture.hpp"

#include <cmath>
#include <numbers>

namespace gridspace::sim {
namespace {

using emt::advance;
using emt::apply;
using emt::network_of;
using emt::read;
using emt::shipped_network;

std::unique_ptr<Engine> phasors(Network network, Rational quantum, double fixed_step_s = 0) {
    phasor::PhasorOptions options{.time_base = TimeBase{quantum}};
    options.fixed_step_s = fixed_step_s;
    auto engine = phasor::make_phasor_engine(std::move(network), options);
    EXPECT_TRUE(engine.has_value());
    auto const ok = (*engine)->initialise();
    EXPECT_TRUE(ok.has_value()) << (ok ? "" : describe(ok.error()));
    return std::move(*engine);
}

constexpr char kGrid[] =
    "buses: {A: {voltage_v: 20000}, B: {voltage_v: 20000}, C: {voltage_v: 400}}\n"
    "sources: {S: {bus: A, r_ohm: 0.2, l_mh: 5, r0_ohm: 0.5, l0_mh: 14}}\n"
    "lines: {L: {from: A, to: B, r_ohm: 1, l_mh: 6, c_nf: 200, r0_ohm: 2.5, l0_mh: 19, c0_nf: 120}}\n"
    "transformers: {T: {from: B, to: C, rating_kva: 1000, r_percent: 1, x_percent: 5, from_winding: delta, "
    "to_winding: wye_grounded, phase_shift_deg: 30}}\n"
    "loads: {D: {bus: C, p_kw: 300, power_factor: 0.9, model: constant_impedance}}\n";

/// r.m.s. of the positive sequence of a current or voltage over one cycle, long after a fault, in waveforms.
double positive_sequence(ApplyFault const& fault, std::string const& name) {
    auto const sut = emt::started(network_of(kGrid), TimeBase{Rational{1, 48000}}, Rational{1, 48000});
    apply(*sut, fault);
    std::complex<double> sum{};
    for (int n = 1; n <= 20 * 800; ++n) {
        advance(*sut, SimTime{n});
        if (n > 19 * 800) {
            // The space vector turns forward with the positive sequence and backward with the negative.
            double const a = read(*sut, name + ".a"), b = read(*sut, name + ".b"), c = read(*sut, name + ".c");
            std::complex<double> const space{(2 * a - b - c) / 3, (b - c) / std::sqrt(3.0)};
            sum += space * std::polar(1.0, -2 * std::numbers::pi * n / 800);
        }
    }
    return std::abs(sum) / 800 / std::numbers::sqrt2;
}

TEST(PhasorFaults, OfEveryTypeGiveThePositiveSequenceOfTheWaveforms) {
    for (FaultType const type : {FaultType::phase_ground, FaultType::phase_phase, FaultType::phase_phase_ground,
                                 FaultType::three_phase_ground}) {
        for (ApplyFault const& fault : {ApplyFault{"L", "", 40, type, 3, "f"}, ApplyFault{"", "C", 0, type, 0.01, "f"},
                                        ApplyFault{"L", "", 100, type, 0, "f"}}) {
            auto const sut = phasors(network_of(kGrid), Rational{1, 1000});
            double const before = read(*sut, "line.L.from.i_a");
            apply(*sut, fault);
            advance(*sut, SimTime{10});
            double const expected = positive_sequence(fault, "line.L.from.i");
            EXPECT_NEAR(read(*sut, "line.L.from.i_a"), expected, 2e-3 * expected)
                << static_cast<int>(type) << ' ' << fault.line << fault.bus << fault.position_percent;
            EXPECT_GT(expected, 1.5 * before); // it is a fault
            apply(*sut, ClearFault{"f"});
            advance(*sut, SimTime{20});
            EXPECT_NEAR(read(*sut, "line.L.from.i_a"), before, 1e-6 * before);
        }
    }
}

TEST(PhasorFaults, AnUnbalancedOneBesidesAnotherIsRefused) {
    auto const sut = phasors(network_of(kGrid), Rational{1, 1000});
    apply(*sut, ApplyFault{"L", "", 40, FaultType::phase_ground, 3, "one"});
    auto const second = sut->apply(ApplyFault{"", "C", 0, FaultType::three_phase_ground, 1, "two"});
    ASSERT_FALSE(second.has_value());
    EXPECT_NE(second.error().message.find("'one' and 'two'"), std::string::npos) << second.error().message;
}

TEST(PhasorFaults, ADeltaKeepsAnEarthFaultBehindItFromTheEarthImpedanceBeforeIt) {
    // The zero sequence at C is the transformer alone: 5 % + 1 % of 1 MVA, on 100 kVA, beside the load.
    Network const n = network_of(kGrid);
    SwitchState const closed{n};
    auto const z = phasor::sequence_impedances(n, closed, {}, ApplyFault{"", "C", 0, FaultType::phase_ground, 0, "f"});
    ASSERT_TRUE(z.has_value());
    Complex const transformer = Complex{0.01, 0.05} * 100.0 / 1000.0;
    Complex const load = 1.0 / Complex{3, -3 * std::tan(std::acos(0.9))};
    EXPECT_NEAR(std::abs(z->z0 - 1.0 / (1.0 / transformer + 1.0 / load)), 0, 1e-9);
    auto const without =
        phasor::sequence_impedances(n, closed, {"D"}, ApplyFault{"", "C", 0, FaultType::phase_ground, 0, "f"});
    EXPECT_NEAR(std::abs(without->z0 - transformer), 0, 1e-9);
}

TEST(PhasorBreakers, PartAfterTheirMechanismAndNeverAStepLater) {
    std::string const text =
        "buses: {A: {voltage_v: 400}, B: {voltage_v: 400}}\ngenerators: {G: {bus: A, role: slack}}\n"
        "lines: {L: {from: A, to: B, r_ohm: 0.1, l_mh: 0.1}}\nbreaker_types: {slow: {mechanism_ms: 25}}\n"
        "breakers: {CB: {line: L, end: from, type: slow}}\nloads: {D: {bus: B, p_kw: 5}}\n";
    for (double const fixed : {0.0, 0.01}) {
        auto const sut = phasors(network_of(text), Rational{1, 1000}, fixed);
        advance(*sut, SimTime{10});
        apply(*sut, SwitchBreaker{"CB", false});
        EXPECT_EQ(read(*sut, "breaker.CB.position"), 0); // on its way
        advance(*sut, SimTime{34});
        EXPECT_GT(read(*sut, "bus.B.v_pu"), 0.9);
        advance(*sut, SimTime{36});
        EXPECT_EQ(read(*sut, "breaker.CB.position"), 1);
        EXPECT_NEAR(read(*sut, "bus.B.v_pu"), 0, 1e-9);
    }
}

TEST(PhasorLimits, AFieldVoltageStaysExactlyAtItsLimitAndLeavesIt) {
    Network n = shipped_network("adn_set_a.yaml");
    double const limit = n.machine_types[0].avr->efd_max_pu;
    auto const sut = phasors(n, Rational{1, 1000});
    std::string const name = "machine." + n.machines[0].name.name;
    apply(*sut, ApplyFault{"", n.machines[0].bus.name, 0, FaultType::three_phase_ground, 0.05, "f"});
    int at_limit = 0;
    for (int t = 1; t <= 8000; ++t) {
        if (t == 150) {
            apply(*sut, ClearFault{"f"});
        }
        advance(*sut, SimTime{t});
        double const efd = read(*sut, name + ".efd_pu");
        ASSERT_LE(efd, limit + 1e-9) << t;
        at_limit += efd > limit - 1e-9 ? 1 : 0;
    }
    EXPECT_GT(at_limit, 20);
    EXPECT_LT(read(*sut, name + ".efd_pu"), limit - 0.01);
}

/// Speed of a machine, in Hz, every 10 ms through a fault and its clearing.
std::vector<double> swing(double fixed_step_s) {
    Network n = shipped_network("wscc9.yaml");
    auto const sut = phasors(n, Rational{1, 1000}, fixed_step_s);
    std::vector<double> out;
    for (int t = 0; t < 1500; t += 10) {
        if (t == 100) {
            apply(*sut, ApplyFault{"", "B7", 0, FaultType::three_phase_ground, 0, "f"});
        } else if (t == 180) {
            apply(*sut, ClearFault{"f"});
        }
        advance(*sut, SimTime{t + 10});
        out.push_back(read(*sut, "machine." + n.machines[1].name.name + ".frequency_hz"));
    }
    return out;
}

TEST(PhasorFixedStep, AgreesWithTheAdaptiveIntegrationAndConvergesToItWithTheSquareOfTheStep) {
    auto const adaptive = swing(0);
    auto const error = [&](double h) {
        auto const fixed = swing(h);
        double worst = 0;
        for (std::size_t i = 0; i < fixed.size(); ++i) {
            worst = std::max(worst, std::abs(fixed[i] - adaptive[i]));
        }
        return worst;
    };
    double const coarse = error(0.01), fine = error(0.005);
    EXPECT_LT(coarse, 0.02);
    EXPECT_GT(coarse / fine, 2.5);
    EXPECT_GT(*std::max_element(adaptive.begin(), adaptive.end()), 60.1); // a swing worth comparing
}

TEST(PhasorFixedStep, GivesTheSameBitsTwice) {
    EXPECT_EQ(swing(0.01), swing(0.01));
}

TEST(PhasorFixedStep, StopsExactlyWhereAnEvIsFull) {
    auto const run = [](double fixed) {
        auto const sut = phasors(network_of("buses: {A: {voltage_v: 400}}\ngenerators: {G: {bus: A, role: slack}}\n"
                                            "evs: {E: {bus: A, capacity_kwh: 1, battery_v: 360, max_current_a: 15, "
                                            "soc_start_percent: 50, soc_stop_percent: 60, current_lag_s: 1}}\n"),
                                 Rational{1}, fixed);
        apply(*sut, SetParameter{"evs.E.current_a", 15});
        for (int t = 1; t <= 100; ++t) {
            advance(*sut, SimTime{t});
        }
        EXPECT_EQ(read(*sut, "ev.E.soc_percent"), 60);
        EXPECT_EQ(read(*sut, "ev.E.p_kw"), 0);
    };
    run(0);
    run(1);
}

} // namespace
} // namespace gridspace::sim
