// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/wind_turbine/wind_turbine.hpp"

#include "tests/unit/components/element_fixture.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <numbers>

/// A turbine of 2000 kW behind a stiff source.
namespace gridspace::sim {
namespace {

TimeBase const kBase{Rational{1, 20000}};
constexpr double kRated = 2000;

Network turbine_network(std::string const& keys, std::string const& profile = "hours: [0], values: [1]") {
    std::string const text = "gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 1000}\n"
                             "buses: {A: {voltage_v: 690}}\nsources: {S: {bus: A, r_ohm: 0.002, l_mh: 0.02}}\n"
                             "wind_turbines: {W: {bus: A, rated_kw: 2000, scale: P, " +
                             keys + "}}\nprofiles: {P: {" + profile + "}}\n";
    Network n;
    auto const diagnostics = read_text(text, n);
    EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
    return n;
}

/// Heier's formula, written again.
double heier(double ratio, double pitch) {
    double const li = 1 / (1 / (ratio + 0.08 * pitch) - 0.035 / (std::pow(pitch, 3) + 1));
    return 0.5176 * (116 / li - 0.4 * pitch - 5) * std::exp(-21 / li) + 0.0068 * ratio;
}

TEST(WindTurbine, HasTheLargestPowerCoefficientThatIsPublishedForItsFormula) {
    wind::RotorData rotor;
    ASSERT_TRUE(rotor.complete());
    EXPECT_NEAR(rotor.best_cp, 0.48, 5e-4);
    EXPECT_NEAR(rotor.best_ratio, 8.1, 0.01);
    for (double ratio : {4.0, 6.0, 9.0}) {
        for (double pitch : {0.0, 5.0, 10.0}) {
            EXPECT_NEAR(wind::power_coefficient(rotor, ratio, pitch), std::max(0.0, heier(ratio, pitch)), 1e-12);
        }
    }
}

class WindTurbineIn : public testing::TestWithParam<char const*> {};
INSTANTIATE_TEST_SUITE_P(Solver, WindTurbineIn, testing::Values("phasor", "emt"));

TEST_P(WindTurbineIn, GivesTheCubeOfTheWindUpToItsRatedPowerAndHoldsItByPitch) {
    struct Case {
        double wind, kw, speed;
    };
    for (Case const c : {Case{6, kRated / 8, 0.5}, Case{9, kRated * 27 / 64, 0.75}, Case{12, kRated, 1},
                         Case{18, kRated, 1}, Case{24, kRated, 1}}) {
        auto const sut = make(GetParam(), turbine_network(fmt::format("wind_m_s: {}", c.wind)), kBase);
        must(sut->initialise());
        for (int k : {0, 10000}) { // and stays there
            if (k > 0) {
                must(sut->advance(SimTime{} + SimSpan{k}));
            }
            EXPECT_NEAR(read(*sut, "wind_turbine.W.p_kw"), c.kw, 2e-4 * kRated) << c.wind << " " << k;
            EXPECT_NEAR(read(*sut, "wind_turbine.W.rotor_speed_pu"), c.speed, 1e-5) << c.wind;
            EXPECT_NEAR(read(*sut, "wind_turbine.W.available_kw"), c.kw, 1e-9 * kRated) << c.wind;
        }
        double const pitch = read(*sut, "wind_turbine.W.pitch_deg");
        double const share = c.wind / 12;
        EXPECT_NEAR(heier(8.1001 * c.speed / share, pitch) / heier(8.1001, 0) * std::pow(share, 3), c.kw / kRated, 2e-4)
            << c.wind;
    }
}

TEST_P(WindTurbineIn, GivesNothingInALullOrAStorm) {
    for (double const wind : {0.0, 2.0, 26.0}) {
        auto const sut = make(GetParam(), turbine_network(fmt::format("wind_m_s: {}", wind)), kBase);
        must(sut->initialise());
        must(sut->advance(SimTime{} + SimSpan{2000}));
        EXPECT_NEAR(read(*sut, "wind_turbine.W.p_kw"), 0, 1e-3) << wind;
    }
}

/// The block diagram by Runge-Kutta with a step of 0.5 ms: speed of blades and generator, shaft, pitch, integral,
/// power.
struct TurbineOracle {
    double ht, hg, k, damping, limit{1};
    bool connected{true};
    std::array<double, 6> x{};
    [[nodiscard]] std::array<double, 6> slopes(std::array<double, 6> const& s, double wind) const {
        double const share = wind / 12, blade = std::pow(share, 3) *
                                                std::max(0.0, heier(8.10009 * s[0] / share, s[3])) / heier(8.10009, 0);
        double const shaft = s[2] + damping * (s[0] - s[1]), fast = s[1] - 1, asked = 150 * fast + s[4];
        double const order = s[1] < 0.42 ? std::clamp(std::pow(0.42, 3) * (s[1] - 0.4) / 0.02, 0.0, limit)
                                         : std::min({std::pow(s[1], 3), 1.0, limit});
        return {(blade / s[0] - shaft) / (2 * ht),
                (shaft - (connected ? s[5] : 0) / s[1]) / (2 * hg),
                k * (s[0] - s[1]),
                std::clamp((std::clamp(asked, 0.0, 45.0) - s[3]) / 0.3, -10.0, 10.0),
                (asked <= 0 && fast < 0) || (asked >= 45 && fast > 0) ? 0 : 25 * fast,
                ((connected ? order : 0) - s[5]) / 0.05};
    }
    template <class Wind>
    void advance(double from, double to, Wind const& wind) {
        constexpr double kStep = 5e-4;
        for (int n = 0; n < std::lround((to - from) / kStep); ++n) {
            double const t = from + n * kStep;
            auto const at = [&](std::array<double, 6> const& slope, double h) {
                auto y = x;
                for (std::size_t i = 0; i < y.size(); ++i) {
                    y[i] += h * slope[i];
                }
                return y;
            };
            auto const a = slopes(x, wind(t)), b = slopes(at(a, kStep / 2), wind(t + kStep / 2));
            auto const c = slopes(at(b, kStep / 2), wind(t + kStep / 2)), d = slopes(at(c, kStep), wind(t + kStep));
            for (std::size_t i = 0; i < x.size(); ++i) {
                x[i] += kStep / 6 * (a[i] + 2 * b[i] + 2 * c[i] + d[i]);
            }
        }
    }
};

TEST_P(WindTurbineIn, FollowsAGustAsItsBlockDiagramSays) {
    // From 10 m/s to 16 in two seconds, and its shaft rings at 1.8 Hz.
    Network const n = turbine_network("wind_m_s: 10, shaft: {turbine_share: 0.9, frequency_hz: 1.8, damping_pu: 0.5}",
                                      "hours: [0, 0.0002777777777777778, 0.0008333333333333334], values: [1, 1, 1.6]");
    auto const wind = [](double t) { return 10 + 6 * std::clamp((t - 1) / 2, 0.0, 1.0); };
    double const ht = 3.6, hg = 0.4, w = 2 * std::numbers::pi * 1.8;
    TurbineOracle oracle{.ht = ht, .hg = hg, .k = 2 * ht * hg / (ht + hg) * w * w, .damping = 0.5};
    double const speed = 10.0 / 12, power = std::pow(speed, 3);
    oracle.x = {speed, speed, power / speed, 0, 0, power};
    auto const sut = make(GetParam(), n, kBase);
    must(sut->initialise());
    double worst_power = 0, worst_speed = 0, worst_pitch = 0, most = 0;
    for (int k = 1; k <= 100; ++k) {
        oracle.advance((k - 1) * 0.1, k * 0.1, wind);
        must(sut->advance(SimTime{} + SimSpan{2000 * k}));
        worst_power = std::max(worst_power, std::abs(read(*sut, "wind_turbine.W.p_kw") / kRated - oracle.x[5]));
        worst_speed = std::max(worst_speed, std::abs(read(*sut, "wind_turbine.W.rotor_speed_pu") - oracle.x[1]));
        worst_pitch = std::max(worst_pitch, std::abs(read(*sut, "wind_turbine.W.pitch_deg") - oracle.x[3]));
        most = std::max(most, oracle.x[3]);
    }
    EXPECT_GT(most, 10);          // the pitch had to act
    EXPECT_LT(worst_power, 1e-3); // waveforms: the lag of the converter's current
    EXPECT_LT(worst_speed, 2e-5);
    EXPECT_LT(worst_pitch, 5e-3);
    ::testing::Test::RecordProperty("worst_power_pu", fmt::format("{:.2e}", worst_power));
    ::testing::Test::RecordProperty("worst_speed_pu", fmt::format("{:.2e}", worst_speed));
    ::testing::Test::RecordProperty("worst_pitch_deg", fmt::format("{:.2e}", worst_pitch));
}

TEST_P(WindTurbineIn, IsCurtailedToASetPointAndTurnsItsBlades) {
    auto const sut = make(GetParam(), turbine_network("wind_m_s: 11"), kBase);
    must(sut->initialise());
    must(sut->apply(SetParameter{"wind_turbines.W.p_limit_kw", 500}));
    must(sut->apply(SetParameter{"wind_turbines.W.q_kvar", 300}));
    must(sut->advance(SimTime{} + SimSpan{60 * 20000}));
    EXPECT_NEAR(read(*sut, "wind_turbine.W.p_kw"), 500, 0.5);
    EXPECT_NEAR(read(*sut, "wind_turbine.W.q_kvar"), 300, 0.5);
    EXPECT_NEAR(read(*sut, "wind_turbine.W.rotor_speed_pu"), 1, 1e-3);
    double const pitch = read(*sut, "wind_turbine.W.pitch_deg"), share = 11.0 / 12;
    EXPECT_NEAR(heier(8.1001 / share, pitch) / heier(8.1001, 0) * std::pow(share, 3), 0.25, 2e-3);
}

TEST_P(WindTurbineIn, StopsAboveItsCutOutWindAndStartsAgainBelowTheOther) {
    auto const sut = make(GetParam(), turbine_network("wind_m_s: 20"), kBase);
    must(sut->initialise());
    auto const set = [&](double wind, int until_s) {
        must(sut->apply(SetParameter{"wind_turbines.W.wind_m_s", wind}));
        must(sut->advance(SimTime{} + SimSpan{until_s * 20000}));
        return read(*sut, "wind_turbine.W.p_kw");
    };
    EXPECT_NEAR(set(24, 5), kRated, 0.02 * kRated); // below cut-out it runs on
    EXPECT_NEAR(set(26, 35), 0, 1e-3);
    EXPECT_LT(read(*sut, "wind_turbine.W.rotor_speed_pu"), 1 - 0.1 / 8 * 23); // the brake, when the blades have turned
    EXPECT_NEAR(read(*sut, "wind_turbine.W.pitch_deg"), 90, 0.1);
    EXPECT_NEAR(set(23, 40), 0, 1e-3); // between the bounds it stays
    EXPECT_NEAR(set(20, 100), kRated, 0.02 * kRated);
}

TEST(WindTurbine, OfTypeThreeSpeedsUpInADipAndOneOfTypeFourDoesNot) {
    for (bool const doubly_fed : {false, true}) {
        auto const sut = make(
            "phasor",
            turbine_network(std::string{"wind_m_s: 12, generator: "} + (doubly_fed ? "doubly_fed" : "full_converter")),
            kBase);
        must(sut->initialise());
        must(sut->apply(ApplyFault{
            .line = "", .bus = "A", .type = FaultType::three_phase_ground, .resistance_ohm = 0.0005, .name = "f"}));
        must(sut->advance(SimTime{} + SimSpan{3000}));
        double const v = read(*sut, "bus.A.v_pu"), given = read(*sut, "wind_turbine.W.p_kw") / kRated;
        ASSERT_LT(v, 0.6);
        EXPECT_NEAR(given, 1.1 * 1.2 * v, 1e-3); // the limit of its current
        double const faster = read(*sut, "wind_turbine.W.rotor_speed_pu") - 1;
        // 2 H w' = (1 - given) / w over 0.15 s
        EXPECT_NEAR(faster, doubly_fed ? (1 - given) * 0.15 / 8 : 0, doubly_fed ? 1.5e-3 : 1e-6);
    }
}

TEST(WindTurbine, ThatCannotBeIsRefusedWithWhatToDo) {
    struct Case {
        std::string keys, message;
    };
    for (Case const& c :
         {Case{"cut_out_m_s: 11", "is not above rated_wind_m_s"}, Case{"restart_m_s: 30", "is above cut_out_m_s"},
          Case{"cp: [1, 2]", "2 numbers"}, Case{"cp: [0.5, 0, 0, 5, 21, 0]", "has no maximum"},
          Case{"rating_kva: 1900", "more than its rating"},
          Case{"wind_m_s: 24, pitch: {max_deg: 2}", "pitch.max_deg of 2 is too little"},
          Case{"shaft: {turbine_share: 1.2}", "turbine_share"}}) {
        Network n;
        auto const diagnostics =
            read_text("gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 1000}\n"
                      "buses: {A: {voltage_v: 690}}\nsources: {S: {bus: A, r_ohm: 0.002, l_mh: 0.02}}\n"
                      "wind_turbines: {W: {bus: A, rated_kw: 2000, " +
                          c.keys + "}}\n",
                      n);
        EXPECT_GE(diagnostics.errors(), 1) << c.keys;
        EXPECT_NE(diagnostics.render().find(c.message), std::string::npos) << diagnostics.render();
    }
}

} // namespace
} // namespace gridspace::sim
