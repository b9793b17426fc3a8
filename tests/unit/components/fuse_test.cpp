// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/fuse/fuse_element.hpp"
#include "sim/runtime/fuse_engine.hpp"
#include "sim/runtime/simulation.hpp"
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// A fuse between a source and a bus that is loaded or faulted; times by hand, from its curve and its I2t.
namespace gridspace::sim {
namespace {

constexpr double kFuseHz = 60, kFuseOmega = 2 * std::numbers::pi * kFuseHz;
constexpr std::int64_t kFuseStepsPerS = 48000;
TimeBase const kFuseBase{Rational{1, kFuseStepsPerS}};

std::string fuse_type(std::string const& more = "") {
    return "rated_a: 40, melting_a: [80, 200, 1000], melting_s: [300, 2, 0.04]" + more;
}

/// 1 + j3.77 ohm to bus B, alike in all sequences.
config::Diagnostics read_fused(std::string const& type, Network& out) {
    std::string const text = fmt::format(
        "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 1000}}\n"
        "buses: {{A: {{voltage_v: 10000}}, B: {{voltage_v: 10000}}}}\n"
        "sources: {{S: {{bus: A, r_ohm: 0.5, l_mh: 5}}}}\nlines: {{L: {{from: A, to: B, r_ohm: 0.5, l_mh: 5}}}}\n"
        "fuse_types: {{k: {{{}}}}}\nfuses: {{F: {{line: L, end: from, type: k}}}}\n"
        "loads: {{D: {{bus: B, p_kw: 0.001, model: constant_impedance}}}}\n",
        type);
    return read_text(text, out);
}

Network fused(std::string const& type) {
    Network n;
    auto const diagnostics = read_fused(type, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

/// The curve of fuse_type(), by hand.
double melting_time(double i_a) {
    auto const between = [i_a](double a0, double s0, double a1, double s1) {
        return std::exp(std::log(s0) + (std::log(s1 / s0) / std::log(a1 / a0)) * std::log(i_a / a0));
    };
    return i_a < 80 ? INFINITY : i_a <= 200 ? between(80, 300, 200, 2) : between(200, 2, 1000, 0.04);
}

class FusedGrid {
  public:
    FusedGrid(std::string const& solver, std::string const& type) : steps_{solver == "emt" ? 1 : 48} {
        Network const n = fused(type);
        engine_ = with_fuses(make(solver, n, kFuseBase), n, kFuseBase, SimSpan{steps_});
        must(engine_->initialise());
    }
    void act(Action const& action) { must(engine_->apply(action)); }
    void load(double i_a) { act(SetParameter{"loads.D.demand_pu", std::sqrt(3.0) * 10 * i_a / 0.001}); }
    void until(double s) {
        std::int64_t const end = std::llround(s * kFuseStepsPerS);
        while (now_ < end) {
            now_ = std::min(now_ + steps_, end);
            must(engine_->advance({now_}));
            for (Happening const& h : engine_->happened()) {
                told.push_back(h.element + " " + h.event + " " + h.text);
            }
        }
    }
    [[nodiscard]] double operator[](std::string const& signal) const { return read(*engine_, signal); }
    std::vector<std::string> told;

  private:
    std::int64_t steps_, now_{0};
    std::unique_ptr<Engine> engine_;
};

/// When the link melts that carries `current`.
template <class Current>
double melted_at(FuseElement& sut, Current const& current, double most_s) {
    double const h = 1.0 / static_cast<double>(kFuseStepsPerS);
    for (std::int64_t k = 1; static_cast<double>(k) * h < most_s; ++k) {
        if (sut.carry(current(static_cast<double>(k) * h), h)) {
            return (static_cast<double>(k - 1) + sut.melted_share()) * h;
        }
    }
    return INFINITY;
}

FuseType const& type_k() {
    static Network const n = fused(fuse_type(", i2t_a2s: 10000"));
    return n.fuse_types[0];
}

TEST(FuseElement, AConstantCurrentMeltsItAfterTheTimeOfTheCurve) {
    for (double const i_a : {80.0, 120.0, 200.0, 400.0}) {
        EXPECT_NEAR(type_k().melting_time_s(i_a), melting_time(i_a), 1e-9 * melting_time(i_a));
        FuseElement rms{type_k(), kFuseHz}, direct{type_k(), kFuseHz}, waves{type_k(), kFuseHz};
        double t = 0;
        while (!rms.carry_rms(i_a, 0.003)) {
            t += 0.003;
        }
        EXPECT_NEAR(t + 0.003 * rms.melted_share(), melting_time(i_a), 1e-9 * melting_time(i_a)) << i_a;
        if (i_a > 100) {
            EXPECT_NEAR(melted_at(direct, [i_a](double) { return i_a; }, 100), melting_time(i_a), 3e-5) << i_a;
            auto const sine = [i_a](double s) { return std::numbers::sqrt2 * i_a * std::sin(kFuseOmega * s); };
            // The heat of an alternating current pulses: its integral is up to 1 / 2w off the mean.
            EXPECT_NEAR(melted_at(waves, sine, 100), melting_time(i_a), 0.5 / kFuseOmega + 1e-3 * melting_time(i_a))
                << i_a;
        }
    }
}

TEST(FuseElement, ItsRatedCurrentNeverMeltsIt) {
    FuseElement rms{type_k(), kFuseHz}, waves{type_k(), kFuseHz};
    for (int hours = 0; hours < 1000; ++hours) {
        EXPECT_FALSE(rms.carry_rms(40, 3600));
    }
    EXPECT_EQ(rms.damage(), 0);
    auto const sine = [](double s) { return std::numbers::sqrt2 * 40 * std::cos(kFuseOmega * s); };
    EXPECT_EQ(melted_at(waves, sine, 20), INFINITY);
    EXPECT_EQ(waves.damage(), 0);
}

TEST(FuseElement, TwoShortFaultsAddUp) {
    FuseElement sut{type_k(), kFuseHz};
    double const t_melt = melting_time(500); // 0.2 s
    auto const bursts = [&](double s) {      // 45 % of it each, a second apart
        bool const on = std::fmod(s, 1.0) < 0.45 * t_melt;
        return on ? 500.0 : 10.0;
    };
    double const s = melted_at(sut, bursts, 10);
    EXPECT_NEAR(s, 2 + 0.1 * t_melt, 1e-4) << "the third one melts it after the last tenth";
}

class FuseIn : public testing::TestWithParam<char const*> {
  protected:
    /// Of phase a in waveforms.
    std::string of_a_{GetParam() == std::string{"emt"} ? ".a" : ""};
};
INSTANTIATE_TEST_SUITE_P(Solver, FuseIn, testing::Values("phasor", "emt"));

TEST_P(FuseIn, MeltsAfterTheInverseTimeSumOfTwoCurrents) {
    FusedGrid sut{GetParam(), fuse_type()};
    sut.load(150);
    sut.until(2);
    double const first_a = sut["line.L.from.i_a"];
    EXPECT_NEAR(sut["fuse.F.damage" + of_a_], 2 / melting_time(first_a), 0.001 * 2 / melting_time(first_a));
    EXPECT_EQ(sut["fuse.F.position"], 2);
    sut.load(300);
    sut.until(2.1);
    double const second_a = sut["line.L.from.i_a"];
    double const expected = 2 + (1 - 2 / melting_time(first_a)) * melting_time(second_a);
    sut.until(4);
    EXPECT_NEAR(sut["fuse.F.melted_s" + of_a_], expected, 0.002) << first_a << " A, " << second_a << " A";
    EXPECT_EQ(sut["fuse.F.damage" + of_a_], 1);
    EXPECT_EQ(sut["fuse.F.position"], 1);
    EXPECT_NEAR(sut["bus.B.v_pu"], 0, 1e-6);
}

TEST_P(FuseIn, CarriesItsRatedCurrent) {
    FusedGrid sut{GetParam(), fuse_type()};
    sut.load(40);
    sut.until(5);
    EXPECT_GT(sut["line.L.from.i_a"], 38);
    EXPECT_EQ(sut["fuse.F.damage" + of_a_], 0);
    EXPECT_TRUE(std::isnan(sut["fuse.F.melted_s" + of_a_]));
    EXPECT_TRUE(sut.told.empty());
}

TEST_P(FuseIn, ItsMeltingIsToldAndNewLinksCloseTheLine) {
    FusedGrid sut{GetParam(), fuse_type(", i2t_a2s: 10000, arcing_ms: 4")};
    sut.until(0.1);
    sut.act(ApplyFault{.line = {}, .bus = "B", .name = "f"});
    sut.until(0.3);
    bool const waveform = GetParam() == std::string{"emt"};
    EXPECT_EQ(sut.told.size(), waveform ? 3U : 1U);
    EXPECT_EQ(sut.told.at(0).substr(0, 13), "F fuse_melted");
    EXPECT_EQ(sut["fuse.F.position"], 1);
    sut.act(ClearFault{"f"});
    sut.act(Disconnect{"L"});
    sut.act(Connect{"L"});
    sut.until(0.4);
    EXPECT_EQ(sut["fuse.F.position"], 1) << "connecting the line puts no new links in";
    sut.act(SwitchBreaker{"F", true});
    sut.until(0.6);
    EXPECT_EQ(sut["fuse.F.position"], 2);
    EXPECT_EQ(sut["fuse.F.damage" + of_a_], 0);
    EXPECT_NEAR(sut["bus.B.v_pu"], 1, 1e-3);
}

/// Current of a phase of 10 kV that is short-circuited at `from_s` behind 1 ohm and 10 mH, without any before.
double fault_current(int phase, double from_s, double s) {
    double const r = 1, x = kFuseOmega * 0.01, peak = 1e4 * std::sqrt(2.0 / 3) / std::hypot(r, x);
    double const turn = -2 * std::numbers::pi / 3 * phase - std::atan2(x, r);
    return peak * (std::cos(kFuseOmega * s + turn) -
                   std::cos(kFuseOmega * from_s + turn) * std::exp(-(s - from_s) * r / 0.01));
}

TEST(FuseInWaveforms, AnAsymmetricalFaultMeltsEachPoleAtItsIntegralAndOpensItAtItsNextZero) {
    FusedGrid sut{"emt", fuse_type(", i2t_a2s: 10000, arcing_ms: 1")};
    double const from_s = 0.05;
    sut.until(from_s);
    sut.act(ApplyFault{.line = {}, .bus = "B", .name = "f"});
    std::array<double, 3> open_s{};
    for (double t = from_s; t < 0.1; t += 1.0 / kFuseStepsPerS) {
        sut.until(t);
        for (std::size_t k = 0; k < 3; ++k) {
            bool const open = sut[fmt::format("fuse.F.pole.{}", "abc"[k])] == 1;
            open_s[k] = open && open_s[k] == 0 ? t : open_s[k];
        }
    }
    for (int k = 0; k < 3; ++k) {
        double const dt = 1e-7;
        double a2s = 0, t = from_s;
        for (; a2s < 10000; t += dt) {
            a2s += std::pow(fault_current(k, from_s, t + dt / 2), 2) * dt;
        }
        EXPECT_NEAR(sut[fmt::format("fuse.F.melted_s.{}", "abc"[k])], t, 1e-6) << "abc"[k];
        t += 0.001 + 2.0 / kFuseStepsPerS;
        while (fault_current(k, from_s, t) * fault_current(k, from_s, t + dt) > 0) {
            t += dt;
        }
        EXPECT_NEAR(open_s[static_cast<std::size_t>(k)], t, 1.5 / kFuseStepsPerS) << "abc"[k];
    }
}

TEST(FuseInWaveforms, AnEarthFaultMeltsItsOwnPoleOnly) {
    FusedGrid sut{"emt", fuse_type(", i2t_a2s: 10000")};
    sut.load(20);
    sut.until(0.05);
    sut.act(ApplyFault{.line = {}, .bus = "B", .type = FaultType::phase_ground, .name = "f"});
    sut.until(0.3);
    EXPECT_EQ(sut["fuse.F.pole.a"], 1);
    EXPECT_EQ(sut["fuse.F.pole.b"], 2);
    EXPECT_EQ(sut["fuse.F.position"], 0) << "neither open nor closed";
    EXPECT_EQ(sut["fuse.F.damage.b"], 0);
    ASSERT_EQ(sut.told.size(), 1U);
    EXPECT_EQ(sut.told[0], "F fuse_melted its link of phase a");
    double most_v = 0;
    for (double t = 0.3; t < 0.32; t += 1e-4) {
        sut.until(t);
        most_v = std::max(most_v, std::abs(sut["bus.B.v.b"]));
    }
    EXPECT_NEAR(most_v, 1e4 * std::sqrt(2.0 / 3), 200) << "the others still feed their load";
}

TEST(FuseInWaveforms, ACurrentLimitingOneStopsTheCurrentAfterItsArcingTime) {
    FusedGrid sut{"emt", fuse_type(", i2t_a2s: 500, arcing_ms: 1, opens: at_once")};
    sut.until(0.05);
    sut.act(ApplyFault{.line = {}, .bus = "B", .type = FaultType::phase_ground, .name = "f"});
    sut.until(0.1);
    double const melted_s = sut["fuse.F.melted_s.a"];
    EXPECT_LT(melted_s - 0.05, 0.004) << "before the first peak";
    FusedGrid again{"emt", fuse_type(", i2t_a2s: 500, arcing_ms: 1, opens: at_once")};
    again.until(0.05);
    again.act(ApplyFault{.line = {}, .bus = "B", .type = FaultType::phase_ground, .name = "f"});
    again.until(melted_s + 0.00095);
    EXPECT_EQ(again["fuse.F.pole.a"], 2);
    again.until(melted_s + 0.00105);
    EXPECT_EQ(again["fuse.F.pole.a"], 1);
    EXPECT_EQ(again["line.L.from.i.a"], 0);
}

/// A feeder with a breaker and a fuse, and a lateral with a smaller fuse; a fault of about 460 A at its end.
class Feeder {
  public:
    explicit Feeder(std::string const& solver) {
        Network n;
        auto const diagnostics =
            read_text("gridspace_network: 1\nname: t\nbase: {frequency_hz: 60, power_kva: 1000}\n"
                      "buses: {A: {voltage_v: 10000}, B: {voltage_v: 10000}, C: {voltage_v: 10000}}\n"
                      "sources: {S: {bus: A, r_ohm: 0.5, l_mh: 5}}\n"
                      "lines: {L: {from: A, to: B, r_ohm: 0.2, l_mh: 2}, M: {from: B, to: C, r_ohm: 0.3, l_mh: 3}}\n"
                      "breaker_types: {b: {}}\nbreakers: {K: {line: L, end: from, type: b}}\nfuse_types:\n"
                      "  large: {rated_a: 80, melting_a: [160, 400, 2000], melting_s: [300, 2, 0.04]}\n"
                      "  small: {rated_a: 40, melting_a: [80, 200, 1000], melting_s: [300, 2, 0.04]}\n"
                      "fuses: {F: {line: L, end: to, type: large}, G: {line: M, end: from, type: small}}\n"
                      "loads: {D: {bus: B, p_kw: 300, model: constant_impedance}, E: {bus: C, p_kw: 100, model: "
                      "constant_impedance}}\n",
                      n);
        EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
        engine_ = with_fuses(make(solver, n, kFuseBase), n, kFuseBase, SimSpan{1});
        must(engine_->initialise());
        until(0.1);
        act(ApplyFault{.line = {}, .bus = "C", .resistance_ohm = 11, .name = "f"});
    }
    void act(Action const& action) { must(engine_->apply(action)); }
    void until(double s) { must(engine_->advance({std::llround(s * kFuseStepsPerS)})); }
    [[nodiscard]] double operator[](std::string const& signal) const { return read(*engine_, signal); }

  private:
    std::unique_ptr<Engine> engine_;
};

TEST_P(FuseIn, TheSmallerOneOfTwoMeltsAndTheLargerOneKeepsAQuarterOfItsLife) {
    Feeder sut{GetParam()};
    sut.until(1);
    EXPECT_EQ(sut["fuse.G.position"], 1);
    EXPECT_EQ(sut["fuse.F.position"], 2);
    EXPECT_GT(sut["fuse.F.damage" + of_a_], 0.01);
    EXPECT_LT(sut["fuse.F.damage" + of_a_], 0.75) << "the usual margin of coordination";
    EXPECT_GT(sut["bus.B.v_pu"], 0.98);
    EXPECT_NEAR(sut["bus.C.v_pu"], 0, 1e-6);
}

TEST_P(FuseIn, ABreakerThatIsFasterSavesIt) {
    Feeder sut{GetParam()};
    sut.until(0.15);
    sut.act(SwitchBreaker{"K", false});
    sut.until(0.5);
    sut.act(ClearFault{"f"}); // it was a flashover
    sut.act(SwitchBreaker{"K", true});
    sut.until(1);
    EXPECT_EQ(sut["fuse.G.position"], 2);
    EXPECT_GT(sut["fuse.G.damage" + of_a_], 0.1);
    EXPECT_LT(sut["fuse.G.damage" + of_a_], 0.5);
    EXPECT_GT(sut["bus.C.v_pu"], 0.98);
}

TEST(FuseInPhasors, AFaultWithinAPeriodMeltsItAtItsIntegral) {
    FusedGrid sut{"phasor", fuse_type(", i2t_a2s: 10000")};
    sut.until(0.1);
    sut.act(ApplyFault{.line = {}, .bus = "B", .name = "f"});
    sut.until(0.102);
    double const i_a = sut["line.L.from.i_a"];
    EXPECT_NEAR(i_a, 1e4 / std::sqrt(3.0) / std::hypot(1, 0.01 * kFuseOmega), 1);
    sut.until(0.2);
    EXPECT_NEAR(sut["fuse.F.melted_s"], 0.1 + 10000 / (i_a * i_a), 1e-6);
    EXPECT_EQ(sut["fuse.F.position"], 1);
}

TEST(Fuse, WhatCannotBeIsAnError) {
    Network n;
    auto const wrong = [&n](std::string const& type) { return read_fused(type, n).errors(); };
    EXPECT_EQ(wrong(fuse_type()), 0);
    EXPECT_EQ(wrong("rated_a: 90, melting_a: [80, 200], melting_s: [300, 2]"), 1) << "its rated current melts it";
    EXPECT_EQ(wrong("rated_a: 40, melting_a: [80, 200], melting_s: [300]"), 1);
    EXPECT_EQ(wrong("rated_a: 40, melting_a: [80], melting_s: [300]"), 1);
    EXPECT_EQ(wrong("rated_a: 40, melting_a: [200, 80], melting_s: [300, 2]"), 1);
    EXPECT_EQ(wrong("rated_a: 40, melting_a: [80, 200], melting_s: [2, 300]"), 1);
    EXPECT_GE(wrong("rated_a: 40, melting_a: [0, 200], melting_s: [300, 2]"), 1);
    EXPECT_EQ(wrong(fuse_type(", i2t_a2s: 50000")), 1) << "more than the last point's 40 kA2s";
    EXPECT_EQ(wrong(fuse_type(", i2t_a2s: 100")), 1) << "80 A bring 107 A2s in a period";
}

TEST(Simulation, TellsWhatElementsDoByThemselves) {
    Network const n = fused(fuse_type(", i2t_a2s: 10000"));
    std::vector<TimedAction> const timeline{
        {Rational{1, 10}, ApplyFault{.line = {}, .bus = "B", .name = "f"}, "short"}};
    Simulation sut{
        with_fuses(make("phasor", n, kFuseBase), n, kFuseBase, SimSpan{48}), {kFuseBase, SimSpan{48}}, timeline};
    std::vector<Happening> told;
    sut.on_happening([&told](Happening const& h) { told.push_back(h); });
    must(sut.start([](SimTime) {}));
    must(sut.run_until({kFuseStepsPerS}, [](SimTime) {}));
    ASSERT_EQ(told.size(), 1U);
    EXPECT_EQ(told[0].event, "fuse_melted");
    EXPECT_NEAR(told[0].at_s, 0.1046, 1e-3);
}

} // namespace
} // namespace gridspace::sim
