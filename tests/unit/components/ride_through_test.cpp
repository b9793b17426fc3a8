// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/components/element_fixture.hpp"

#include <cmath>
#include <fmt/format.h>
#include <gtest/gtest.h>

/// What a PV inverter does in abnormal voltages and frequencies, by the tables of IEEE 1547-2018.
namespace gridspace::sim {
namespace {

TimeBase const kBase{Rational{1, 48000}};

config::Diagnostics read_pv(std::string const& ride_through, Network& out, double hz = 60) {
    std::string const text =
        fmt::format("gridspace_network: 1\nname: t\nbase: {{frequency_hz: {}, power_kva: 100}}\n"
                    "buses: {{A: {{voltage_v: 400}}}}\nsources: {{S: {{bus: A, r_ohm: 0.01, l_mh: 0.05}}}}\n"
                    "pv: {{P: {{bus: A, p_kw: 20, rating_kva: 25{}}}}}\n",
                    hz, ride_through);
    return read_text(text, out);
}

class Inverter {
  public:
    explicit Inverter(std::string const& ride_through, double hz = 60) {
        Network n;
        auto const diagnostics = read_pv(ride_through, n, hz);
        EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
        engine_ = make("emt", n, kBase, SimSpan{2});
        must(engine_->initialise());
    }
    /// Lets the voltage (p.u.) be so for a time.
    Inverter& at(double volts_pu, double for_s) { return set("sources.S.voltage_pu", volts_pu, for_s); }
    Inverter& frequency(double hz, double for_s) { return set("sources.S.frequency_hz", hz, for_s); }
    [[nodiscard]] double kw() const { return read(*engine_, "pv.P.p_kw"); }
    [[nodiscard]] double share() const { return read(*engine_, "pv.P.in_service_share"); }

  private:
    Inverter& set(std::string const& path, double value, double for_s) {
        must(engine_->apply(SetParameter{path, value}));
        t_ += for_s;
        must(engine_->advance(SimTime{} + SimSpan{std::llround(t_ * 48000)}));
        return *this;
    }
    std::unique_ptr<Engine> engine_;
    double t_{0};
};

std::string category(std::string const& name, std::string const& more = "") {
    return ", ride_through: {category: " + name + more + "}";
}
std::string const kSoon = ", enter_service: {delay_s: 0.5, ramp_s: 1}";

TEST(RideThrough, CategoryThreeCeasesMomentarilyAndIsBackWithinFourTenthsOfASecond) {
    Inverter sut{category("III")};
    sut.at(1, 0.1);
    EXPECT_NEAR(sut.kw(), 20, 0.05);
    sut.at(0.4, 0.083); // table 16: 83 ms to cease
    EXPECT_EQ(sut.share(), 0);
    EXPECT_NEAR(sut.kw(), 0, 0.2);
    sut.at(0.4, 0.8); // rides through 1 s
    sut.at(1, 0.4);   // 6.4.2.7: 80 % within 0.4 s
    EXPECT_GT(sut.kw(), 0.8 * 20);
}

TEST(RideThrough, APauseWhileItEntersServiceIsNoShortcut) {
    Inverter sut{category("III", ", trip: {uv2: {after_s: 0.1}}, enter_service: {delay_s: 0.1, ramp_s: 2}")};
    sut.at(0.4, 0.3).at(1, 0.5); // tripped, and 0.4 s into its ramp
    EXPECT_GT(sut.share(), 0.1);
    sut.at(0.4, 0.06); // a pause
    EXPECT_EQ(sut.share(), 0);
    sut.at(1, 0.5);
    EXPECT_NEAR(sut.share(), 0.25, 0.03) << "the ramp of 2 s from its beginning, not that of 0.4 s";
}

TEST(RideThrough, CategoryTwoTripsWhereCategoryThreeStays) {
    for (bool const three : {false, true}) {
        Inverter sut{category(three ? "III" : "II", kSoon)};
        sut.at(0.4, 0.3).at(1, 0.45); // UV2 of II: 0.45 p.u., 0.16 s; of III: 0.5 p.u., 2 s
        EXPECT_EQ(sut.share() == 0, !three);
        sut.at(1, 0.35); // enters service after 0.5 s of a fit grid, along a ramp of 1 s
        if (!three) {
            EXPECT_NEAR(sut.share(), 0.3, 0.06);
            EXPECT_NEAR(sut.kw(), 0.3 * 20, 1.5);
        }
        sut.at(1, 1);
        EXPECT_NEAR(sut.kw(), 20, 0.1);
    }
}

TEST(RideThrough, ADipToSixTenthsTripsCategoryOneAfterTwoSecondsAndNoOther) {
    for (char const* name : {"I", "II", "III"}) {
        Inverter sut{category(name)};
        sut.at(0.6, 1.9);
        EXPECT_EQ(sut.share(), 1) << name;
        sut.at(0.6, 0.2);
        EXPECT_EQ(sut.share(), name == std::string{"I"} ? 0 : 1) << name;
    }
}

TEST(RideThrough, OvervoltageTripsByItsTwoElements) {
    Inverter high{category("II")}, low{category("II")};
    high.at(1.25, 0.2);
    EXPECT_EQ(high.share(), 0) << "OV2: 1.2 p.u., 0.16 s";
    low.at(1.14, 1.9);
    EXPECT_EQ(low.share(), 1);
    low.at(1.14, 0.2);
    EXPECT_EQ(low.share(), 0) << "OV1: 1.1 p.u., 2 s";
}

TEST(RideThrough, FrequencyElementsGoWithTheNominalFrequency) {
    for (double const hz : {60.0, 50.0}) {
        Inverter inside{category("II"), hz}, outside{category("II"), hz};
        inside.at(1, 0.1).frequency(61.8 / 60 * hz, 0.5); // OF2: 62 Hz of 60, 0.16 s
        EXPECT_EQ(inside.share(), 1) << hz;
        outside.at(1, 0.1).frequency(62.3 / 60 * hz, 0.5);
        EXPECT_EQ(outside.share(), 0) << hz;
    }
}

TEST(RideThrough, OwnSettingsComeBeforeThoseOfTheCategory) {
    Inverter sut{
        category("II", ", trip: {uv1: {voltage_pu: 0.8, after_s: 0.3}}, enter_service: {delay_s: 0.1, ramp_s: 0.1}")};
    sut.at(0.75, 0.25);
    EXPECT_EQ(sut.share(), 1);
    sut.at(0.75, 0.1);
    EXPECT_EQ(sut.share(), 0);
    sut.at(0.9, 0.5);
    EXPECT_EQ(sut.share(), 0) << "0.9 p.u. is not fit to enter service";
    sut.at(1, 0.5);
    EXPECT_EQ(sut.share(), 1);
}

TEST(RideThrough, WithoutItASourceComesBackAfterFourTenthsAndShowsNoShare) {
    Inverter sut{""};
    sut.at(0.4, 0.3).at(1, 0.8);
    EXPECT_NEAR(sut.kw(), 20, 0.1);
}

TEST(RideThrough, ThresholdsInTheWrongOrderAreAnError) {
    Network n;
    EXPECT_EQ(read_pv(category("II", ", trip: {uv1: {voltage_pu: 0.3}}"), n).errors(), 1);
    EXPECT_EQ(read_pv(category("II", ", trip: {uf1: {frequency_hz: 57}, uf2: {frequency_hz: 58}}"), n).errors(), 1);
    EXPECT_EQ(read_pv(category("II", ", enter_service: {voltage_min_pu: 1.1, voltage_max_pu: 1}"), n).errors(), 1);
    EXPECT_EQ(read_pv(category("IV"), n).errors(), 1);
}

} // namespace
} // namespace gridspace::sim
