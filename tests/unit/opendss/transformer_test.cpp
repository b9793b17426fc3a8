// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

namespace gridspace::opendss {
namespace {

std::string const kSource = "Set DefaultBaseFrequency=60\nNew Circuit.c basekv=4.16 r1=0 x1=1e-6 r0=0 x0=1e-6\n";

double turned(Solved const& s, char const* bus) {
    return std::remainder(degrees(s.v(bus, 1)) - degrees(s.v("sourcebus", 1)), 360);
}

TEST(DssTransformer, TurnsTheLowVoltageByThirtyDegreesBackOrForthByItsStandard) {
    struct Row {
        char const* connections;
        double degrees;
    };
    for (Row const row : {Row{"conns=[delta wye]", -30}, Row{"conns=[wye delta]", -30}, Row{"conns=[wye wye]", 0},
                          Row{"conns=[delta delta]", 0}, Row{"conns=[delta wye] leadlag=lead", 30},
                          Row{"conns=[wye delta] leadlag=euro", 30}}) {
        Solved const s = solved(kSource + "New Transformer.t buses=[sourcebus low] kVs=[4.16 0.48] kVAs=[500 500] " +
                                row.connections + "\n");
        EXPECT_NEAR(turned(s, "low"), row.degrees, 0.01) << row.connections;
        EXPECT_NEAR(std::abs(s.v("low", 1)), 480 / std::sqrt(3.0), 0.1) << row.connections;
    }
}

TEST(DssTransformer, DropsItsShortCircuitVoltageAtRatedCurrent) {
    // A load of constant impedance that is exactly one p.u. of the transformer: V = 1 / |1 + z|.
    Solved const s =
        solved(kSource + "New Transformer.t buses=[sourcebus low] kVs=[4.16 0.48] kVA=500 XHL=6 %Rs=[0.5 0.7]\n"
                         "New Load.l bus1=low kv=0.48 kw=500 kvar=0 model=2\n"
                         "Set voltagebases=[4.16 0.48]\n");
    EXPECT_NEAR(s.pu("low", 2), 1 / std::abs(Complex{1.012, 0.06}), 1e-6);
    EXPECT_NEAR(s.flow.losses_va.real(), 500e3 * 0.012 / std::norm(Complex{1.012, 0.06}), 1);
}

TEST(DssTransformer, RaisesTheVoltageByItsTapAndLosesItsIronLosses) {
    Solved const s = solved(kSource + "New Transformer.t buses=[sourcebus low] kVs=[4.16 0.48] kVA=500 ppm=0\n"
                                      "~ %noloadloss=0.3 %imag=1.2 wdg=2 tap=1.05\nSet voltagebases=[4.16 0.48]\n");
    EXPECT_NEAR(s.pu("low", 1), 1.05, 2e-3); // less the drop of the magnetising current
    EXPECT_NEAR(s.flow.losses_va.real(), 1500, 10);
    EXPECT_NEAR(s.flow.losses_va.imag(), 6000, 20);
}

TEST(DssTransformer, OfThreeWindingsReadsItsCodeAndListsOfImpedances) {
    std::string const code = "New XfmrCode.code windings=3 conns=[delta wye wye] kVs=[4.16 0.48 0.24] "
                             "kVAs=[300 200 100] XHL=7 XHT=9 XLT=4 %Rs=[0.3 0.3 0.3]\n";
    std::string const load = "New Load.l bus1=low kv=0.48 kw=90 kvar=30 model=2\n";
    Solved const coded =
        solved(kSource + code + "New Transformer.t xfmrcode=code buses=[sourcebus low other]\n" + load);
    Solved const listed = solved(kSource +
                                 "New Transformer.t windings=3 buses=[sourcebus low other] conns=[delta wye wye] "
                                 "kVs=[4.16 0.48 0.24] kVAs=[300 200 100] Xscarray=[7 9 4] %Rs=[0.3 0.3 0.3]\n" +
                                 load);
    EXPECT_LT(std::abs(coded.v("low", 1) - listed.v("low", 1)), 1e-9);
    // The third winding is open: its voltage is that behind the impedance of the first, (7 + 9 - 4) / 2 = 6 percent.
    double const drop = 1 - std::abs(coded.v("other", 1)) * std::sqrt(3.0) / 240;
    EXPECT_NEAR(drop, 0.06 * 30 / 300 + 0.003 * 90 / 300, 5e-4);
}

TEST(DssTransformer, SaysWhatIsMissingOrCannotBe) {
    EXPECT_THAT(mistakes(kSource + "New Transformer.t buses=[sourcebus]\n"),
                testing::HasSubstr("main.dss:3:5: error: transformer.t: winding 2 has no bus"));
    EXPECT_THAT(mistakes(kSource + "New Transformer.t buses=[sourcebus low] kVs=[4.16 0]\n"),
                testing::HasSubstr("main.dss:3:51: error: transformer.t: kvs is 0"));
    EXPECT_THAT(mistakes(kSource + "New Transformer.t wdg=3\n"), testing::HasSubstr("wdg is 3"));
    EXPECT_THAT(mistakes(kSource + "New Transformer.t buses=[sourcebus low] xfmrcode=none\n"),
                testing::HasSubstr("xfmrcode 'none' does not exist"));
}

} // namespace
} // namespace gridspace::opendss
