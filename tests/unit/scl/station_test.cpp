// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "gateways/scl/station.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <iterator>

namespace gridspace::scl {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::string const& file() {
    static std::string const text = [] {
        std::ifstream stream{source_tree("configs/scl/small_station.scd"), std::ios::binary};
        return std::string{std::istreambuf_iterator<char>{stream}, {}};
    }();
    return text;
}

std::string with(std::string text, std::string const& what, std::string const& instead) {
    std::size_t const at = text.find(what);
    EXPECT_NE(at, std::string::npos) << what;
    return at == std::string::npos ? text : text.replace(at, what.size(), instead);
}

Station read(std::string const& text) {
    auto const document = Document::parse(text, "s.scd");
    EXPECT_TRUE(document) << describe(document.error());
    auto station = read_station(*document, 50);
    EXPECT_TRUE(station) << describe(station.error());
    return std::move(*station);
}

/// "IED hears STREAM: members" of each subscription.
std::vector<std::string> subscriptions(Station const& station) {
    std::vector<std::string> out;
    for (StreamSubscription const& one : station.subscriptions) {
        std::string text = one.ied + " hears " + station.import.blocks[one.block].stream + ":";
        for (std::string const& member : one.members) {
            text += " " + member;
        }
        out.push_back(text + (one.supervisor.empty() ? "" : " by " + one.supervisor));
    }
    return out;
}

/// "line:column kind subject: text" of each finding.
std::vector<std::string> findings(Station const& station) {
    std::vector<std::string> out;
    for (Finding const& f : station.import.findings) {
        out.push_back(fmt::format("{}:{} {} {}: {} ({})", f.where.line, f.where.column, kind_name(f.kind), f.subject,
                                  f.text, f.remedy));
    }
    return out;
}

/// Line and column of a text, as an editor counts them.
std::string place(std::string const& text, std::string const& what) {
    std::size_t const at = text.find(what);
    auto const line = std::count(text.begin(), text.begin() + static_cast<std::ptrdiff_t>(at), '\n') + 1;
    std::size_t const begin = text.rfind('\n', at);
    return fmt::format("{}:{} ", line, at - (begin == std::string::npos ? 0 : begin + 1) + 1);
}

TEST(Station, BindsExtRefsOfEveryEdition) {
    EXPECT_THAT(subscriptions(read(file())),
                ElementsAre("PROT1 hears MU1_MSVCB01: I01ATCTR1_AmpSv_instMag_i I01ATCTR1_AmpSv_q "
                            "I01BTCTR2_AmpSv_instMag_i I01BTCTR2_AmpSv_q I01CTCTR3_AmpSv_instMag_i "
                            "I01CTCTR3_AmpSv_q by LD0/LSVS1",
                            "PROT1 hears BRK1_Position: XCBR1_Pos_stVal by LD0/LGOS1",
                            "BRK1 hears PROT1_Trip: PTRC1_Tr_general"));
}

TEST(Station, SaysWhatIsNotPlayedAndWhatIsBoundToNothing) {
    EXPECT_THAT(findings(read(file())),
                ElementsAre(HasSubstr("80 samples per period: 4000 Hz"),
                            testing::AllOf(HasSubstr("left_out BRK1: the input 'spare' is bound to nothing"),
                                           testing::StartsWith(place(file(), "<ExtRef intAddr=\"spare\""))),
                            testing::AllOf(HasSubstr("left_out HMI1: 'BRK1LD0/XCBR1.Pos' comes by Report"),
                                           testing::StartsWith(place(file(), "serviceType=\"Report\"")))));
}

TEST(Station, KeepsTheScaleOfSampledValues) {
    Station const station = read(file());
    ControlBlock const& block = station.import.blocks.at(0);
    EXPECT_EQ(block.members.at(0).scale, 0.001);
    EXPECT_EQ(block.members.at(8).scale, 0.01);
    Station const set = read(with(
        file(), R"(<LN prefix="I01A" lnClass="TCTR" inst="1" lnType="TCTR"/>)",
        R"(<LN prefix="I01A" lnClass="TCTR" inst="1" lnType="TCTR"><DOI name="AmpSv"><SDI name="sVC"><DAI name="scaleFactor"><Val>0.5</Val></DAI></SDI></DOI></LN>)"));
    EXPECT_EQ(set.import.blocks.at(0).members.at(0).scale, 0.5) << "the instance wins over its type";
    EXPECT_EQ(set.import.blocks.at(0).members.at(2).scale, 0.001);
}

/// What is found when `what` is written otherwise, beside what is found anyway.
std::vector<std::string> found_with(std::string const& what, std::string const& instead) {
    std::vector<std::string> out;
    std::vector<std::string> const usual = findings(read(file()));
    for (std::string const& one : findings(read(with(file(), what, instead)))) {
        std::string const text = one.substr(one.find(' '));
        bool const known = std::any_of(usual.begin(), usual.end(),
                                       [&](std::string const& u) { return u.substr(u.find(' ')) == text; });
        if (!known) {
            out.push_back(one);
        }
    }
    return out;
}

TEST(Station, DanglingExtRefsAreToldAtTheirPlaceWithTheNearestName) {
    EXPECT_THAT(
        found_with(R"(ExtRef iedName="BRK1" ldInst="LD0" lnClass="XCBR" lnInst="1" doName="Pos" daName="stVal")",
                   R"(ExtRef iedName="BRK2" ldInst="LD0" lnClass="XCBR" lnInst="1" doName="Pos" daName="stVal")"),
        ElementsAre(
            testing::AllOf(HasSubstr("'BRK2LD0/XCBR1.Pos.stVal' is asked of IED 'BRK2', which is not in the file"),
                           HasSubstr("did you mean 'BRK1'?"))));
    EXPECT_THAT(found_with(R"(serviceType="SMV" srcLDInst="MU" srcLNClass="LLN0" srcCBName="MSVCB01" intAddr="Ia")",
                           R"(serviceType="SMV" srcLDInst="MU" srcLNClass="LLN0" srcCBName="MSVCB02" intAddr="Ia")"),
                ElementsAre(testing::AllOf(HasSubstr("IED 'MU1' has no control block 'MSVCB02'"),
                                           HasSubstr("did you mean 'MSVCB01'?"))));
    EXPECT_THAT(found_with(R"(doName="Tr" daName="general" serviceType="GOOSE" intAddr)",
                           R"(doName="Op" daName="general" serviceType="GOOSE" intAddr)"),
                ElementsAre(testing::AllOf(HasSubstr("no data set of a control block of IED 'PROT1' has"),
                                           HasSubstr("'PROT1LD0/PTRC1.Op.general'"))));
    EXPECT_THAT(found_with("<Val>BRK1LD0/LLN0.Position</Val>", "<Val>BRK1LD0/LLN0.Positions</Val>"),
                ElementsAre(HasSubstr("LD0/LGOS1 supervises 'BRK1LD0/LLN0.Positions', which is no usable GOOSE")));
}

TEST(Station, AnExtRefToABlockThatWasLeftOutNamesItsLine) {
    EXPECT_THAT(found_with(R"(<P type="MAC-Address">01-0C-CD-04-00-11</P>)", R"(<P type="MAC-Address">nonsense</P>)"),
                testing::Contains(HasSubstr("comes with control block 'MSVCB01', which was left out (line ")));
}

TEST(Station, DuplicatesAreDoubtfulAndNamed) {
    EXPECT_THAT(found_with(R"(<P type="APPID">0031</P>)", R"(<P type="APPID">8021</P>)"),
                ElementsAre(testing::AllOf(HasSubstr("doubtful BRK1 Position"),
                                           HasSubstr("has the APPID 0x8021, which 'PROT1 Trip' has too"))));
    EXPECT_THAT(
        found_with(R"(<P type="MAC-Address">01-0C-CD-01-00-31</P>)", R"(<P type="MAC-Address">01-0C-CD-01-00-21</P>)"),
        ElementsAre(HasSubstr("has the MAC address 01:0C:CD:01:00:21, which 'PROT1 Trip' has too")));
    EXPECT_THAT(found_with(R"(<IED name="HMI1")", R"(<IED name="BRK1")"),
                ElementsAre(HasSubstr("left_out BRK1: there are two IEDs 'BRK1'")));
}

TEST(Station, ANamespaceThatIsMissingOrAnotherIsDoubtful) {
    EXPECT_THAT(found_with(R"( xmlns="http://www.iec.ch/61850/2003/SCL")", ""),
                ElementsAre(testing::AllOf(HasSubstr("doubtful SCL: the root element has no xmlns"),
                                           HasSubstr("xmlns=\"http://www.iec.ch/61850/2003/SCL\""))));
    EXPECT_THAT(found_with("http://www.iec.ch/61850/2003/SCL", "http://example.org/other"),
                ElementsAre(HasSubstr("xmlns is 'http://example.org/other'")));
}

TEST(Station, WithoutTypesNothingCanBeResolvedAndThatIsSaidFirst) {
    std::size_t const from = file().find("<DataTypeTemplates>"), until = file().find("</DataTypeTemplates>");
    std::string without = file();
    without.erase(from, until + std::string_view{"</DataTypeTemplates>"}.size() - from);
    Station const station = read(without);
    EXPECT_THAT(station.import.blocks, IsEmpty());
    EXPECT_THAT(findings(station).at(0), HasSubstr("there is no DataTypeTemplates"));
}

TEST(Station, ClientsOfAnIedInTheSamePlaceDoNotCount) { // "@" and the IED itself
    EXPECT_EQ(subscriptions(read(with(file(), R"(ExtRef iedName="BRK1" ldInst="LD0" lnClass="XCBR")",
                                      R"(ExtRef iedName="@" ldInst="LD0" lnClass="XCBR")")))
                  .size(),
              3U)
        << "LGOS1 alone subscribes to the position then";
}

/// A file whose types are nested so that each line of it stands for ten of the next.
std::string bomb(std::string const& constraint) {
    std::string types = R"(<LNodeType id="L" lnClass="GGIO"><DO name="Ind" type="D0"/></LNodeType>)";
    for (int level = 0; level < 12; ++level) {
        types += fmt::format("<DOType id=\"D{}\" cdc=\"X\">", level);
        for (int i = 0; i < 10; ++i) {
            types += fmt::format("<SDO name=\"s{}\" type=\"D{}\"/>", i, level + 1);
        }
        types += "</DOType>";
    }
    types += R"(<DOType id="D12" cdc="X"><DA name="stVal" bType="BOOLEAN" fc=")" + constraint + R"("/></DOType>)";
    return R"(<SCL xmlns="http://www.iec.ch/61850/2003/SCL"><Communication><SubNetwork name="n"><ConnectedAP iedName="A" apName="P"><GSE ldInst="L" cbName="g"><Address><P type="MAC-Address">01-0C-CD-01-00-01</P><P type="APPID">0001</P></Address></GSE></ConnectedAP></SubNetwork></Communication><IED name="A"><AccessPoint name="P"><Server><LDevice inst="L"><LN0 lnClass="LLN0" inst=""><DataSet name="d"><FCDA ldInst="L" lnClass="GGIO" lnInst="1" doName="Ind" fc="ST"/></DataSet><GSEControl name="g" datSet="d" confRev="1"/></LN0><LN lnClass="GGIO" inst="1" lnType="L"/></LDevice></Server></AccessPoint></IED><DataTypeTemplates>)" +
           types + "</DataTypeTemplates></SCL>";
}

TEST(Station, TypesThatGrowWithoutEndAreCutOff) {
    for (char const* constraint : {"ST", "MX"}) { // the member asks for ST: of MX it would find nothing, after years
        Station const station = read(bomb(constraint));
        EXPECT_THAT(station.import.blocks, IsEmpty());
        EXPECT_THAT(findings(station), ElementsAre(HasSubstr("it has more than 4096 values")));
    }
}

TEST(Document, RefusesADocumentTypeAndItsEntities) {
    std::string const laughs = "<?xml version=\"1.0\"?>\n<!DOCTYPE lolz [\n <!ENTITY a \"lol\">\n <!ENTITY b "
                               "\"&a;&a;&a;\">\n]>\n<SCL>&b;</SCL>";
    auto const refused = Document::parse(laughs, "s.scd");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("s.scd:2:1: the file has a document type"));
    EXPECT_THAT(refused.error().remedy, HasSubstr("take the lines out"));
}

TEST(Document, SaysWhereItIsNoXml) {
    auto const open = Document::parse("<SCL>\n  <IED>\n</SCL>", "s.scd");
    ASSERT_FALSE(open);
    EXPECT_THAT(open.error().message, HasSubstr("s.scd:2:3: not XML: an element begins here"));
    auto const quotes = Document::parse("<SCL>\n  <IED name=A/>\n</SCL>", "s.scd");
    ASSERT_FALSE(quotes);
    EXPECT_THAT(quotes.error().message, HasSubstr("not XML: an attribute is not written NAME=\"VALUE\""));
    std::string deep;
    for (int i = 0; i < 200; ++i) {
        deep += "<SCL>";
    }
    EXPECT_THAT(Document::parse(deep, "s.scd").error().message, HasSubstr("nested more than"));
    EXPECT_THAT(Document::parse("", "s.scd").error().message, HasSubstr("the file is empty"));
}

TEST(SourcePlaces, FindsTheColumnAmongSeveralElementsOfALine) {
    std::string const text = "<SCL>\n<a n=\"1\"/><a n=\"2\"\n   m=\"3\"/>\n</SCL>";
    auto const document = Document::parse(text, "s.scd");
    ASSERT_TRUE(document);
    auto const all = children(document->root(), "a");
    EXPECT_EQ(document->places().of(*all.at(0)).to_string(), "s.scd:2:1");
    EXPECT_EQ(document->places().of(*all.at(1)).to_string(), "s.scd:2:11");
    EXPECT_EQ(document->places().of(*all.at(1), "n").to_string(), "s.scd:2:14");
    EXPECT_EQ(document->places().of(*all.at(1), "m").to_string(), "s.scd:3:4");
}

} // namespace
} // namespace gridspace::scl
