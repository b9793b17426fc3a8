// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/line_constants/line_constants.hpp"

#include "support.hpp"

namespace gridspace::opendss {
namespace {

using sim::Conductor;
using sim::EarthModel;
using sim::LineConstants;

constexpr double kMile = 1609.344, kFoot = 0.3048;

/// The pole of the IEEE 4-node feeder: three 336 kcmil phases and a 4/0 neutral.
std::vector<Conductor> pole() {
    auto const wire = [](double x_ft, double h_ft, double ohm_per_mile, double gmr_ft, double diameter_in) {
        return Conductor{x_ft * kFoot,         h_ft * kFoot,   ohm_per_mile / kMile / 1.02,
                         ohm_per_mile / kMile, gmr_ft * kFoot, diameter_in / 2 * 0.0254};
    };
    return {wire(0, 28, 0.306, 0.0244, 0.721), wire(2.5, 28, 0.306, 0.0244, 0.721), wire(7, 28, 0.306, 0.0244, 0.721),
            wire(4, 24, 0.592, 0.00814, 0.563)};
}

TEST(LineConstants, AreThosePublishedForTheIeee4NodeFeeder) {
    LineConstants const sut = line_constants(pole(), 3, 60, 100, EarthModel::carson);
    Complex const published[3][3] = {{{0.4576, 1.0780}, {0.1559, 0.5017}, {0.1535, 0.3849}},
                                     {{0.1559, 0.5017}, {0.4666, 1.0482}, {0.1580, 0.4236}},
                                     {{0.1535, 0.3849}, {0.1580, 0.4236}, {0.4615, 1.0651}}};
    double const nanofarads[3][3] = {{15.04, -4.8706, -1.8655}, {-4.8706, 15.855, -3.1008}, {-1.8655, -3.1008, 14.3}};
    for (int i = 0; i < 3; ++i) {
        for (int j = 0; j < 3; ++j) {
            EXPECT_LT(std::abs(sut.z_ohm_per_m(i, j) * kMile - published[i][j]), 5e-4) << i << j;
            EXPECT_NEAR(sut.c_f_per_m(i, j) * kMile * 1e9, nanofarads[i][j], 0.1) << i << j;
        }
    }
}

TEST(LineConstants, OfDeriAreNearThoseOfCarsonAndDependOnTheEarth) {
    LineConstants const carson = line_constants(pole(), 3, 60, 100, EarthModel::carson),
                        deri = line_constants(pole(), 3, 60, 100, EarthModel::deri),
                        rock = line_constants(pole(), 3, 60, 10000, EarthModel::deri);
    EXPECT_LT((carson.z_ohm_per_m - deri.z_ohm_per_m).cwiseAbs().maxCoeff() * kMile, 0.012);
    EXPECT_GT((rock.z_ohm_per_m - deri.z_ohm_per_m).cwiseAbs().maxCoeff() * kMile, 0.02);
}

TEST(LineConstants, OfAScriptAreThoseOfItsGeometry) {
    std::string const circuit = "Set EarthModel=Carson\nNew Circuit.c basekv=12.47 r1=0 x1=1e-6 r0=0 x0=1e-6\n";
    std::string const load = "New Load.l phases=1 bus1=end.1 kv=7.2 kw=1500 kvar=700 model=2\n";
    std::string const wires = "New WireData.p Runits=mi Rac=0.306 GMRunits=ft GMRac=0.0244 Radunits=in Diam=0.721\n"
                              "New WireData.n Runits=mi Rac=0.592 GMRunits=ft GMRac=0.00814 Radunits=in Diam=0.563\n";
    Solved const by_matrix =
        solved(circuit + "New Line.l bus1=sourcebus bus2=end length=2000 units=ft linecode=m\n" + load +
               "New Linecode.m units=mi rmatrix=(.4576 | .1559 .4666 | .1535 .1580 .4615) "
               "xmatrix=(1.078 | .5017 1.0482 | .3849 .4236 1.0651) cmatrix=(15.04 | -4.8706 15.855 | -1.8655 -3.1008 "
               "14.3)\n");
    for (std::string const& how :
         {std::string{"New LineGeometry.g nconds=4 nphases=3 reduce=yes\n~ cond=1 wire=p units=ft x=0 h=28\n"
                      "~ cond=2 wire=p x=2.5 h=28\n~ cond=3 wire=p x=7 h=28\n~ cond=4 wire=n x=4 h=24\n"
                      "New Line.l geometry=g bus1=sourcebus bus2=end length=2000 units=ft\n"},
          std::string{"New LineSpacing.s nconds=4 nphases=3 units=ft x=[0 2.5 7 4] h=[28 28 28 24]\n"
                      "New Line.l spacing=s wires=[p p p n] bus1=sourcebus bus2=end length=2000 units=ft\n"}}) {
        Solved const sut = solved(circuit + wires + how + load);
        EXPECT_LT(std::abs(sut.v("end", 1) - by_matrix.v("end", 1)), 0.05) << how;
        EXPECT_LT(std::abs(sut.v("end", 2) - by_matrix.v("end", 2)), 0.05) << how;
    }
    EXPECT_THAT(mistakes(circuit + "New Line.l bus1=a bus2=b geometry=g\n"),
                testing::HasSubstr("geometry 'g' does not exist"));
}

} // namespace
} // namespace gridspace::opendss
