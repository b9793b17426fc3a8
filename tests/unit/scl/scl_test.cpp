// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_export.hpp"
#include "gateways/scl/scl_import.hpp"

#include "common/config/yaml.hpp"

#include <cstdlib>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>

namespace gridspace::scl {
namespace {

using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

std::vector<streams::Stream> read(std::string const& yaml) {
    config::Diagnostics diagnostics;
    auto node = config::parse_yaml(yaml, config::make_source("streams.yaml", yaml), diagnostics);
    auto out = streams::read_streams(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return out;
}

std::vector<streams::Stream> read(config::Node const& node) {
    config::Diagnostics diagnostics;
    auto out = streams::read_streams(node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return out;
}

/// The streams as a file; none of them is refused.
std::string written(std::string const& yaml) {
    auto const streams = read(yaml);
    Export const out = export_streams(streams, "test");
    for (Refusal const& one : out.refused) {
        ADD_FAILURE() << one.stream.name << ": " << describe(one.why);
    }
    return out.text;
}

/// "NAME: why" of those that are refused.
std::vector<std::string> refusals(std::string const& yaml) {
    std::vector<std::string> out;
    for (Refusal const& one : export_streams(read(yaml), "test").refused) {
        out.push_back(one.stream.name + ": " + describe(one.why));
    }
    return out;
}

constexpr char kStreams[] = R"(
SMV21: {kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: GS_TL2_MU21, conf_rev: 3, rate_hz: 4800, samples_per_frame: 2, vlan_id: 100,
        vlan_priority: 6, send_refr_tm: true, send_smp_rate: true, data_set_name: MU21LD1/LLN0$Currents, data_set: {Ia: float32, Ib: float32, Ic: float32, q: quality}}
TRIP2: {kind: goose, mac: "01:0C:CD:01:00:02", app_id: 0x8002, control_block: IED2LD0/LLN0$GO$Trip, conf_rev: 7, go_id: TRIP2, integers: fixed,
        data_set: {status: boolean, pos: {stVal: position, q: quality}, n: int32, text: {type: visible_string, length: 65}, e: enumerated, t: timestamp},
        min_time_ms: 1.5, max_time_ms: 10}
OTHER: {kind: goose, mac: "01:0C:CD:01:00:03", app_id: 0x0003, control_block: functional_name/LLN0$GO$gcb1, data_set: {x: float64}}
)";

/// What must be the same on the wire.
void expect_same(streams::Stream const& a, streams::Stream const& b) {
    EXPECT_EQ(a.address.destination, b.address.destination);
    EXPECT_EQ(a.address.app_id, b.address.app_id);
    EXPECT_EQ(a.address.vlan, b.address.vlan);
    EXPECT_EQ(a.conf_rev, b.conf_rev);
    EXPECT_EQ(a.sv_id, b.sv_id);
    EXPECT_EQ(a.rate_hz, b.rate_hz);
    EXPECT_EQ(a.samples_per_frame, b.samples_per_frame);
    EXPECT_EQ(a.send_refr_tm, b.send_refr_tm);
    EXPECT_EQ(a.send_smp_rate, b.send_smp_rate);
    EXPECT_EQ(a.control_block, b.control_block);
    EXPECT_EQ(a.integers, b.integers);
    EXPECT_EQ(a.data_set.members.size(), b.data_set.members.size());
    auto const x = leaves_of(a.data_set), y = leaves_of(b.data_set);
    ASSERT_EQ(x.size(), y.size());
    for (std::size_t i = 0; i < x.size(); ++i) {
        EXPECT_EQ(x[i].type, y[i].type) << x[i].name;
        EXPECT_EQ(x[i].length, y[i].length) << x[i].name;
    }
    if (a.kind == streams::Kind::goose) {
        EXPECT_EQ(a.timing.min_time_ms, b.timing.min_time_ms);
        EXPECT_EQ(a.timing.max_time_ms, b.timing.max_time_ms);
    }
}

TEST(Scl, WhatIsExportedIsImportedAsTheSameStreams) {
    auto const before = read(kStreams);
    auto const imported = import_streams(written(kStreams), "test.cid", {});
    ASSERT_TRUE(imported);
    EXPECT_THAT(imported->notes, IsEmpty());
    auto const after = read(imported->streams);
    ASSERT_EQ(after.size(), 3U);
    for (streams::Stream const& a : before) {
        auto const same = std::find_if(after.begin(), after.end(),
                                       [&](auto const& b) { return b.address.app_id == a.address.app_id; });
        ASSERT_NE(same, after.end()) << a.name.name;
        expect_same(a, *same);
    }
    EXPECT_EQ(find_stream(after, "IED2_Trip")->go_id, "TRIP2");
    EXPECT_EQ(find_stream(after, "MU21_MSVCB01")->data_set_name, "MU21LD1/LLN0$Currents");
}

TEST(Scl, StreamsOverUdpKeepTheirGroup) {
    std::string const scl = written(R"(
A: {kind: smv, udp: {group: 239.192.0.21, dscp: 40}, app_id: 0x4021, sv_id: A, data_set_name: MU21LD1/LLN0$Currents, data_set: {Ia: float32}}
B: {kind: goose, udp: {group: 239.192.0.2}, app_id: 0x8002, control_block: IED2LD0/LLN0$GO$Trip, data_set: {status: boolean}}
)");
    EXPECT_THAT(scl, AllOf(HasSubstr(R"(<Protocol mustUnderstand="true">R-GOOSE</Protocol>)"),
                           HasSubstr(R"(<Protocol mustUnderstand="true">R-SV</Protocol>)"),
                           HasSubstr(R"(<P type="MAC-Address">01-00-5E-40-00-15</P>)")));
    auto const imported = import_streams(scl, "test.cid", {});
    ASSERT_TRUE(imported);
    EXPECT_THAT(imported->notes, IsEmpty());
    auto const after = read(imported->streams);
    ASSERT_EQ(after.size(), 2U);
    for (streams::Stream const& s : after) {
        ASSERT_TRUE(s.udp);
        bool const goose = s.kind == streams::Kind::goose;
        EXPECT_EQ(s.udp->group, (iec61850::Ipv4{239, 192, 0, static_cast<std::uint8_t>(goose ? 2 : 21)}));
        EXPECT_EQ(s.udp->dscp, goose ? 46 : 40);
    }
    std::string wrong = scl;
    for (char const* group : {"239.192.0.21", "239.192.0.2"}) {
        wrong.replace(wrong.find(group), std::string{group}.size(), "10.0.0.1");
    }
    auto const without = import_streams(wrong, "test.cid", {});
    ASSERT_TRUE(without);
    EXPECT_THAT(without->notes, testing::Each(HasSubstr("'10.0.0.1', which is no group that routers forward")));
    EXPECT_EQ(without->notes.size(), 2U);
    EXPECT_EQ(read(without->streams).size(), 2U);
}

/// Two streams that call their data sets the same, in one device.
std::string two_streams(std::string const& second_set) {
    return R"(
A: {kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: A, data_set_name: MU21LD1/LLN0$Currents, data_set: {Ia: float32, q: quality}}
B: {kind: smv, mac: "01:0C:CD:04:00:22", app_id: 0x4022, sv_id: B, data_set_name: MU21LD1/LLN0$Currents, data_set: )" +
           second_set + "}\n";
}

TEST(Scl, StreamsThatNameTheSameDataSetShareIt) {
    std::string const scl = written(two_streams("{Ia: float32, q: quality}"));
    std::size_t const at = scl.find("<DataSet ");
    ASSERT_NE(at, std::string::npos);
    EXPECT_EQ(scl.find("<DataSet ", at + 1), std::string::npos) << scl;
    auto const imported = import_streams(scl, "test.cid", {});
    ASSERT_TRUE(imported);
    auto const after = read(imported->streams);
    ASSERT_EQ(after.size(), 2U);
    EXPECT_EQ(after[0].data_set, after[1].data_set);
    EXPECT_EQ(leaves_of(after[1].data_set).size(), 2U);
}

TEST(Scl, OneNameForTwoDifferentDataSetsIsRefused) {
    EXPECT_THAT(
        refusals(two_streams("{Ia: int32, q: quality}")),
        ElementsAre(testing::AllOf(HasSubstr("streams 'A' and 'B' call different data sets 'Currents' in MU21LD1"),
                                   HasSubstr("data_set_name"))));
}

/// One GOOSE stream.
std::string goose(std::string const& name, int app_id, std::string const& rest) {
    return fmt::format("{}: {{kind: goose, mac: \"01:0C:CD:01:00:{:02X}\", app_id: {}, {}}}\n", name, app_id, app_id,
                       rest);
}

TEST(Scl, WhatIsOnTheWireIsNeverRenamed) {
    auto const why = [](std::string const& rest) {
        auto const all = refusals(goose("T", 1, "data_set: {x: boolean}, " + rest));
        return all.size() == 1 ? all[0] : "";
    };
    std::string const longest(32, 'a');
    EXPECT_THAT(why("control_block: IED2LD0/LLN0$GO$x-y"),
                HasSubstr("T: SCL cannot say its control_block "
                          "'IED2LD0/LLN0$GO$x-y'; expected DEVICE/LLN0$GO$NAME"));
    EXPECT_THAT(why("control_block: IED2LD0/LLN0$GO$" + longest + "a"), HasSubstr("at most 64 and 32 characters"));
    EXPECT_THAT(why("control_block: IED2LD0/LLN0$GO$1"), HasSubstr("cannot say its control_block"));
    EXPECT_THAT(why("control_block: IED2LD0/PTRC1$GO$x"), HasSubstr("cannot say its control_block"));
    EXPECT_THAT(why("control_block: IED-2/LLN0$GO$x"), HasSubstr("cannot say its control_block"));
    EXPECT_THAT(why("control_block: AB/LLN0$GO$x, data_set_name: AB/LLN0$a-b"),
                HasSubstr("cannot say its data_set_name 'AB/LLN0$a-b'"));
    EXPECT_THAT(why("control_block: AB/LLN0$GO$x, data_set_name: CD/LLN0$x"), HasSubstr("AB/LLN0$x"));
    auto const imported = import_streams(
        written(goose("T", 1, "data_set: {x: boolean}, control_block: IED2LD0/LLN0$GO$" + longest)), "x", {});
    EXPECT_EQ(read(imported->streams).at(0).control_block, "IED2LD0/LLN0$GO$" + longest);
}

TEST(Scl, OneControlBlockIsNotWrittenTwice) {
    std::string const same = "control_block: IED2LD0/LLN0$GO$a, data_set_name: IED2LD0/LLN0$d, data_set: {x: boolean}";
    auto const streams = read(goose("A", 1, same) + goose("B", 2, same));
    Export const out = export_streams(streams, "test");
    ASSERT_EQ(out.refused.size(), 1U);
    EXPECT_EQ(out.refused[0].stream.name, "B");
    EXPECT_EQ(out.refused[0].stream.where.line, 2);
    EXPECT_THAT(out.refused[0].why.message, HasSubstr("stream 'A' has the same control_block"));
    EXPECT_EQ(import_streams(out.text, "x", {})->streams.entries.size(), 1U) << "the others are written";
}

TEST(Scl, DevicesWithLikeNamesStayTwo) {
    auto const streams = read(goose("A", 1, "control_block: IED2/LLN0$GO$a, data_set: {x: boolean}") +
                              goose("B", 2, "control_block: IED2LD0/LLN0$GO$a, data_set: {x: float32}"));
    auto const after = read(import_streams(export_streams(streams, "test").text, "x", {})->streams);
    ASSERT_EQ(after.size(), 2U);
    std::vector<std::string> blocks{after[0].control_block, after[1].control_block};
    EXPECT_THAT(blocks, testing::UnorderedElementsAre("IED2/LLN0$GO$a", "IED2LD0/LLN0$GO$a"));
}

TEST(Scl, WritesTheTypesThatItReads) {
    std::string const set =
        "data_set: {id: {type: octet_string, length: 64}, e: entry_time, entry: {type: octet_string, length: 8}, "
        "check: {type: bit_string, length: 2}, h: [float32, float32], "
        "pos: {stVal: position, a-b: int8, a_b: int16, origin: {orCat: enumerated, orIdent: {type: octet_string, "
        "length: 64}}}, "
        "s: {t: entry_time, l: {array: {f: float32, q: quality}, count: 3}}, l: {array: {v: uint8}, count: 2}}";
    auto const before = read(goose("T", 1, "control_block: AB/LLN0$GO$T, " + set));
    auto const imported = import_streams(written(goose("T", 1, "control_block: AB/LLN0$GO$T, " + set)), "x", {});
    EXPECT_THAT(imported->notes, IsEmpty());
    auto const after = read(imported->streams);
    ASSERT_EQ(after.size(), 1U);
    expect_same(before[0], after[0]);
    auto const& members = after[0].data_set.members;
    EXPECT_EQ(members[4].kind, iec61850::DataNode::Kind::array);
    EXPECT_EQ(members[5].members[2].name, "aBx2") << "two attributes, though their names become one";
    EXPECT_EQ(members[6].members[1].kind, iec61850::DataNode::Kind::array);
    EXPECT_EQ(members[7].kind, iec61850::DataNode::Kind::array);
    EXPECT_EQ(members[7].members[1].kind, iec61850::DataNode::Kind::structure);
}

TEST(Scl, SaysThatFramesCarryTheIdentityOfTheClock) {
    std::string const streams =
        R"(A: {kind: smv, mac: "01:0C:CD:04:00:21", sv_id: A, gm_identity: "001122FFFE334455", data_set: 9-2LE})";
    EXPECT_THAT(written(streams), HasSubstr("synchSourceId=\"true\""));
    EXPECT_THAT(import_streams(written(streams), "x", {})->notes,
                ElementsAre(HasSubstr("a publisher needs gm_identity")));
    EXPECT_THAT(written(kStreams), HasSubstr("synchSourceId=\"false\""));
}

TEST(Scl, OnlyTheNamedIedIsImported) {
    std::string const scl = written(kStreams);
    ImportOptions options;
    options.ieds = {"IED2"};
    EXPECT_EQ(import_streams(scl, "x", options)->streams.entries.size(), 1U);
    options.ieds = {"IED3"};
    auto const refused = import_streams(scl, "x", options);
    ASSERT_FALSE(refused);
    EXPECT_THAT(describe(refused.error()), testing::AllOf(HasSubstr("there is no IED 'IED3'"), HasSubstr("IED2")));
}

/// A file as tools of the first edition write them: prefix, no version, VLAN in lower case, a wrong control block
/// beside a right one.
constexpr char kLiberal[] = R"(<?xml version="1.0"?>
<scl:SCL xmlns:scl="http://www.iec.ch/61850/2003/SCL">
 <scl:Header id="x"/>
 <scl:Communication><scl:SubNetwork name="W1"><scl:ConnectedAP iedName="MU" apName="S1">
  <scl:GSE ldInst="A" cbName="g1"><scl:Address><scl:P type="MAC-Address">01-0c-cd-01-00-05</scl:P><scl:P type="APPID"> 00ab </scl:P></scl:Address></scl:GSE>
  <scl:GSE ldInst="A" cbName="g2"><scl:Address><scl:P type="MAC-Address">nonsense</scl:P><scl:P type="APPID">0001</scl:P></scl:Address></scl:GSE>
  <scl:SMV ldInst="A" cbName="s1"><scl:Address><scl:P type="MAC-Address">01-0C-CD-04-00-01</scl:P><scl:P type="APPID">4000</scl:P><scl:P type="VLAN-ID">00a</scl:P></scl:Address></scl:SMV>
 </scl:ConnectedAP></scl:SubNetwork></scl:Communication>
 <scl:IED name="MU"><scl:AccessPoint name="S1"><scl:Server><scl:LDevice inst="A"><scl:LN0 lnClass="LLN0" inst="" lnType="L0">
  <scl:DataSet name="d1"><scl:FCDA ldInst="A" prefix="P" lnClass="XCBR" lnInst="1" doName="Pos" daName="stVal" fc="ST"/><scl:FCDA ldInst="A" prefix="P" lnClass="XCBR" lnInst="1" doName="Pos" fc="ST"/></scl:DataSet>
  <scl:DataSet name="d2"><scl:FCDA ldInst="A" lnClass="TCTR" lnInst="1" doName="Amp" daName="instMag.i" fc="MX"/><scl:FCDA ldInst="A" lnClass="TCTR" lnInst="1" doName="Amp" daName="q" fc="MX"/></scl:DataSet>
  <scl:DataSet name="d3"><scl:FCDA ldInst="A" lnClass="TCTR" lnInst="1" doName="Nope" daName="q" fc="MX"/></scl:DataSet>
  <scl:GSEControl name="g1" datSet="d1" appID="G1"/><scl:GSEControl name="g2" datSet="d1" appID="G2"/><scl:GSEControl name="g3" datSet="d1" appID="G3"/>
  <scl:SampledValueControl name="s1" datSet="d2" smvID="xxxxMUnn01" smpRate="80" nofASDU="1" confRev="1"><scl:SmvOpts/></scl:SampledValueControl>
 </scl:LN0><scl:LN prefix="P" lnClass="XCBR" inst="1" lnType="X"/><scl:LN lnClass="TCTR" inst="1" lnType="T"/></scl:LDevice></scl:Server></scl:AccessPoint></scl:IED>
 <scl:DataTypeTemplates>
  <scl:LNodeType id="X" lnClass="XCBR"><scl:DO name="Pos" type="DPC"/></scl:LNodeType><scl:LNodeType id="T" lnClass="TCTR"><scl:DO name="Amp" type="SAV"/></scl:LNodeType>
  <scl:DOType id="DPC" cdc="DPC"><scl:DA name="stVal" bType="Dbpos" fc="ST"/><scl:DA name="q" bType="Quality" fc="ST"/><scl:DA name="ctlModel" bType="Enum" fc="CF"/></scl:DOType>
  <scl:DOType id="SAV" cdc="SAV"><scl:DA name="instMag" bType="Struct" type="AV" fc="MX"/><scl:DA name="q" bType="Quality" fc="MX"/></scl:DOType>
  <scl:DAType id="AV"><scl:BDA name="i" bType="INT32"/></scl:DAType>
 </scl:DataTypeTemplates>
</scl:SCL>)";

TEST(Scl, ReadsFilesOfOlderToolsAndNotesWhatItLeavesOut) {
    ImportOptions options;
    options.nominal_hz = 60;
    auto const imported = import_streams(kLiberal, "old.icd", options);
    ASSERT_TRUE(imported) << describe(imported.error());
    auto const streams = read(imported->streams);
    ASSERT_EQ(streams.size(), 2U);
    streams::Stream const& goose = *find_stream(streams, "MU_g1");
    EXPECT_EQ(goose.control_block, "MUA/LLN0$GO$g1");
    EXPECT_EQ(goose.address.app_id, 0xAB);
    ASSERT_EQ(goose.data_set.members.size(), 2U);
    EXPECT_EQ(goose.data_set.members[0].type, iec61850::BasicType::position);
    EXPECT_EQ(goose.data_set.members[1].kind, iec61850::DataNode::Kind::structure)
        << "a whole object, with the attributes of its constraint";
    EXPECT_EQ(goose.data_set.members[1].members.size(), 2U);
    streams::Stream const& smv = *find_stream(streams, "MU_s1");
    EXPECT_EQ(smv.rate_hz, Rational{4800});
    EXPECT_EQ(smv.address.vlan->id, 10);
    EXPECT_EQ(leaves_of(smv.data_set)[0].type, iec61850::BasicType::int32);
    EXPECT_THAT(imported->notes, ElementsAre(HasSubstr("'g1' has no confRev: 1 is assumed"), HasSubstr("'nonsense'"),
                                             HasSubstr("'g3' has no address"), HasSubstr("4800 Hz")));
}

/// A file with the given data sets, control blocks and types; everything else is as usual.
std::string file_with(std::string const& sets_and_blocks, std::string const& nodes, std::string const& types,
                      std::string const& addresses = "", std::string const& ied = "F1") {
    std::string const usual = R"(<ConnectedAP iedName=")" + ied + R"(" apName="S1">
      <GSE ldInst="L" cbName="g"><Address><P type="MAC-Address">01-0C-CD-01-00-01</P><P type="APPID">0001</P></Address></GSE>
      <SMV ldInst="L" cbName="s"><Address><P type="MAC-Address">01-0C-CD-04-00-01</P><P type="APPID">4001</P></Address></SMV></ConnectedAP>)";
    return R"(<SCL xmlns="http://www.iec.ch/61850/2003/SCL" version="2007" revision="B"><Communication><SubNetwork name="N">)" +
           (addresses.empty() ? usual : addresses) + "</SubNetwork></Communication><IED name=\"" + ied +
           R"("><AccessPoint name="S1"><Server><LDevice inst="L"><LN0 lnClass="LLN0" inst="" lnType="L0">)" +
           sets_and_blocks + "</LN0>" + nodes + "</LDevice></Server></AccessPoint></IED><DataTypeTemplates>" + types +
           "</DataTypeTemplates></SCL>";
}

constexpr char kMeter[] = R"(<LN lnClass="MMXU" inst="1" lnType="M"/>)";
constexpr char kMeterTypes[] = R"(
  <LNodeType id="M" lnClass="MMXU"><DO name="A" type="WYE"/><DO name="HA" type="HWYE"/></LNodeType>
  <DOType id="WYE" cdc="WYE"><SDO name="phsA" type="CMV"/><SDO name="phsB" type="CMV"/><DA name="d" bType="VisString255" fc="DC"/></DOType>
  <DOType id="HWYE" cdc="HWYE"><SDO name="phsAHar" type="CMV" count="3"/><DA name="n" bType="INT16U" fc="CF" count="maxPts"/></DOType>
  <DOType id="CMV" cdc="CMV"><DA name="cVal" bType="Struct" type="Vector" fc="MX"/><DA name="q" bType="Quality" fc="MX"/></DOType>
  <DAType id="Vector"><BDA name="mag" bType="Struct" type="AV"/><BDA name="ang" bType="Struct" type="AV"/></DAType>
  <DAType id="AV"><BDA name="f" bType="FLOAT32"/></DAType>)";

std::string fcda(std::string const& rest) {
    return R"(<FCDA ldInst="L" lnClass="MMXU" lnInst="1" fc="MX" )" + rest + "/>";
}
constexpr char kBlock[] = R"(</DataSet><GSEControl name="g" datSet="d" appID="x" confRev="1"/>)";

TEST(Scl, FollowsNestedDataObjectsAndArrays) {
    std::string const sets = "<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="cVal.mag.f")") +
                             fcda(R"(doName="A" daName="phsB.cVal.mag.f")") + fcda(R"(doName="A")") +
                             fcda(R"(doName="HA" )") + fcda(R"(doName="HA.phsAHar" daName="cVal.mag.f" ix="2")") +
                             kBlock;
    auto const imported = import_streams(file_with(sets, kMeter, kMeterTypes), "f.scd", {});
    ASSERT_TRUE(imported) << describe(imported.error());
    EXPECT_THAT(imported->notes, IsEmpty());
    auto const streams = read(imported->streams);
    ASSERT_EQ(streams.size(), 1U);
    auto const& members = streams[0].data_set.members;
    ASSERT_EQ(members.size(), 5U);
    EXPECT_EQ(members[0].name, "MMXU1_A_phsA_cVal_mag_f");
    EXPECT_EQ(members[0].type, iec61850::BasicType::float32);
    EXPECT_EQ(members[1].type, iec61850::BasicType::float32) << "a data object at the start of the attribute's path";
    ASSERT_EQ(members[2].members.size(), 2U) << "phsA and phsB; d has another constraint";
    EXPECT_EQ(members[2].members[1].name, "phsB");
    EXPECT_EQ(members[2].members[1].members[0].members[0].members[0].name, "f");
    iec61850::DataNode const& harmonics = members[3].members[0];
    EXPECT_EQ(harmonics.kind, iec61850::DataNode::Kind::array);
    EXPECT_EQ(harmonics.members.size(), 3U);
    EXPECT_EQ(members[4].name, "MMXU1_HA_phsAHar_cVal_mag_f_2");
    EXPECT_EQ(members[4].type, iec61850::BasicType::float32);
}

TEST(Scl, AMemberMayBeAWholeArrayOfDataObjects) {
    std::string const sets = "<DataSet name=\"d\">" + fcda(R"(doName="HA.phsAHar")") +
                             fcda(R"(doName="HA" daName="phsAHar")") + fcda(R"(doName="HA.phsAHar" ix="1")") + kBlock;
    auto const imported = import_streams(file_with(sets, kMeter, kMeterTypes), "f.scd", {});
    ASSERT_TRUE(imported) << describe(imported.error());
    EXPECT_THAT(imported->notes, IsEmpty());
    auto const streams = read(imported->streams);
    ASSERT_EQ(streams.size(), 1U);
    auto const& members = streams[0].data_set.members;
    ASSERT_EQ(members.size(), 3U);
    for (std::size_t i : {0U, 1U}) {
        EXPECT_EQ(members[i].kind, iec61850::DataNode::Kind::array);
        ASSERT_EQ(members[i].members.size(), 3U);
        EXPECT_EQ(members[i].members[2].kind, iec61850::DataNode::Kind::structure);
        EXPECT_EQ(members[i].members[2].members.size(), 2U) << "cVal and q";
    }
    EXPECT_EQ(members[2].kind, iec61850::DataNode::Kind::structure) << "one element of it";
    EXPECT_EQ(leaves_of(streams[0].data_set)[0].name, "MMXU1_HA_phsAHar.0.cVal.mag.f");
}

TEST(Scl, NotesControlBlocksThatAReceiverCannotTellApart) {
    constexpr char kTwo[] = R"(<ConnectedAP iedName="F1" apName="S1">
      <SMV ldInst="L" cbName="s"><Address><P type="MAC-Address">01-0C-CD-04-00-01</P><P type="APPID">4001</P></Address></SMV>
      <SMV ldInst="L" cbName="t"><Address><P type="MAC-Address">01-0C-CD-04-00-01</P><P type="APPID">4001</P></Address></SMV></ConnectedAP>)";
    auto const notes = [&](std::string const& second) {
        std::string const sv = R"(" datSet="d" smpRate="4000" smpMod="SmpPerSec" nofASDU="1" confRev="1" smvID=")";
        auto const imported = import_streams(file_with("<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="q")") +
                                                           "</DataSet><SampledValueControl name=\"s" + sv + "MU\"/>" +
                                                           "<SampledValueControl name=\"t" + sv + second + "\"/>",
                                                       kMeter, kMeterTypes, kTwo),
                                             "f.scd", {});
        EXPECT_EQ(imported->streams.entries.size(), 2U);
        return imported->notes;
    };
    EXPECT_THAT(notes("MU"), ElementsAre(HasSubstr("'F1 t' has the MAC address, the APPID and the svID of 'F1 s'")));
    EXPECT_THAT(notes("MU2"), ElementsAre(HasSubstr("has the APPID 0x4001, which 'F1 s' has too")));
}

TEST(Scl, AVlanPriorityThatIsNoneLosesNoStream) {
    auto const imported_with = [](std::string const& priority) {
        std::string const addresses = R"(<ConnectedAP iedName="F1" apName="S1"><GSE ldInst="L" cbName="g"><Address>
      <P type="MAC-Address">01-0C-CD-01-00-01</P><P type="APPID">0001</P><P type="VLAN-ID">00A</P><P type="VLAN-PRIORITY">)" +
                                      priority + "</P></Address></GSE></ConnectedAP>";
        return *import_streams(file_with("<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="q")") + kBlock,
                                         kMeter, kMeterTypes, addresses),
                               "f.scd", {});
    };
    for (char const* none : {"9", "8", "-1", "high"}) {
        Import const sut = imported_with(none);
        EXPECT_THAT(sut.notes, ElementsAre(HasSubstr("VLAN-PRIORITY '" + std::string{none} + "', which is none")));
        auto const streams = read(sut.streams);
        ASSERT_EQ(streams.size(), 1U) << none;
        EXPECT_EQ(streams[0].address.vlan->id, 10);
        EXPECT_EQ(streams[0].address.vlan->priority, 4);
    }
    Import const seven = imported_with("7");
    EXPECT_THAT(seven.notes, IsEmpty());
    EXPECT_EQ(read(seven.streams)[0].address.vlan->priority, 7);
}

TEST(Scl, SaysWhyAMemberCannotBeResolved) {
    auto const note_of = [](std::string const& member) {
        auto const imported =
            import_streams(file_with("<DataSet name=\"d\">" + member + kBlock, kMeter, kMeterTypes), "f.scd", {});
        return imported && imported->notes.size() == 1 && imported->streams.entries.empty() ? imported->notes[0] : "";
    };
    EXPECT_THAT(note_of(fcda(R"(doName="HA.phsAHar" daName="cVal.mag.f")")), HasSubstr("'phsAHar' is an array"));
    EXPECT_THAT(note_of(R"(<FCDA ldInst="L" lnClass="MMXU" lnInst="1" doName="HA" daName="n" fc="CF"/>)"),
                HasSubstr("the array 'n' has maxPts elements"));
    EXPECT_THAT(note_of(R"(<FCDA ldInst="L" lnClass="XCBR" lnInst="1" doName="Pos" fc="ST"/>)"),
                HasSubstr("there is no logical node 'XCBR1' in 'L'"));
    EXPECT_THAT(note_of(fcda("")), HasSubstr("names no data object"));
    EXPECT_THAT(note_of(fcda(R"(doName="A.phsD")")), HasSubstr("has no data object 'A.phsD'"));
    EXPECT_THAT(note_of(""), HasSubstr("data set 'd' is empty"));
}

TEST(Scl, FindsTheAddressAtAnotherAccessPointOfTheDevice) {
    constexpr char kElsewhere[] = R"(<ConnectedAP iedName="F1" apName="P2"><GSE ldInst="L" cbName="g"><Address>
      <P type="MAC-Address">010CCD010009</P><P type="APPID"><!-- hexadecimal --> 0x3fff </P></Address></GSE></ConnectedAP>
      <ConnectedAP iedName="F2" apName="S1"><GSE ldInst="L" cbName="g"><Address><P type="MAC-Address">01-0C-CD-01-00-02</P><P type="APPID">0002</P></Address></GSE></ConnectedAP>)";
    std::string const sets = "<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="q")") + kBlock;
    auto const imported =
        import_streams("\xEF\xBB\xBF" + file_with(sets, kMeter, kMeterTypes, kElsewhere), "f.scd", {});
    ASSERT_TRUE(imported) << describe(imported.error());
    auto const streams = read(imported->streams);
    ASSERT_EQ(streams.size(), 1U);
    EXPECT_EQ(streams[0].address.app_id, 0x3FFF);
    EXPECT_EQ(streams[0].address.destination.to_string(), "01:0C:CD:01:00:09");
}

TEST(Scl, LeavesOutWhatTheWireDoesNotCarryAndKeepsTheRest) {
    std::string const set = "<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="q")") + "</DataSet>";
    std::string const sv =
        R"(<SampledValueControl name="s" datSet="d" smpRate="4000" smpMod="SmpPerSec" nofASDU="1" confRev="1" )";
    auto const import = [&](std::string const& blocks) {
        return *import_streams(file_with(set + blocks, kMeter, kMeterTypes, "", "1 Süd"), "f.scd", {});
    };
    Import const odd =
        import(R"(<GSEControl name="g" datSet="d" appID="0012" confRev="1"/>)" + sv + R"(smvID="Süd" />)");
    ASSERT_EQ(odd.streams.entries.size(), 0U);
    EXPECT_THAT(odd.notes, ElementsAre(HasSubstr("control block 'g' was left out: '1 SüdL/LLN0$GO$g' is no reference"),
                                       HasSubstr("control block 's' was left out: stream 'stream': svID")));
    auto const umlaut = import_streams(file_with(set + R"(<GSEControl name="g" datSet="d" appID="0012" confRev="1"/>)",
                                                 kMeter, kMeterTypes, "", "Süd"),
                                       "f.scd", {});
    EXPECT_THAT(umlaut->notes, ElementsAre(HasSubstr("control block 'g' was left out: stream 'stream': gocbRef")));
    Import const long_names = import(sv + "smvID=\"" + std::string(130, 'x') + "\"/>");
    EXPECT_THAT(long_names.notes, ElementsAre(HasSubstr("svID has 130 characters")));
    Import const good = import(sv + R"(smvID="0012"/>)");
    EXPECT_THAT(good.notes, IsEmpty());
    auto const streams = read(good.streams);
    ASSERT_EQ(streams.size(), 1U);
    EXPECT_EQ(streams[0].name.name, "_1_S__d_s") << "a key begins with a letter or _";
    EXPECT_EQ(streams[0].sv_id, "0012") << "a text, not a number";
}

TEST(Scl, DefaultsStandInForWhatIsForgottenAndAreNoted) {
    constexpr char kBare[] = R"(<ConnectedAP iedName="F1" apName="S1"><SMV ldInst="L" cbName="s"><Address>
      <P type="MAC-Address">01-0C-CD-04-00-01</P><P type="VLAN-ID">FFF</P></Address></SMV></ConnectedAP>)";
    std::string const sets = "<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="")") +
                             R"(</DataSet><SampledValueControl name="s" datSet="d" smvID="x" smpRate="4800"/>)";
    auto const imported = import_streams(file_with(sets, kMeter, kMeterTypes, kBare), "f.scd", {});
    ASSERT_TRUE(imported) << describe(imported.error());
    EXPECT_THAT(imported->notes,
                ElementsAre(HasSubstr("0x4000"), HasSubstr("VLAN-ID 'FFF'"),
                            HasSubstr("'s' has no confRev: 1 is assumed"), HasSubstr("samples per second"),
                            HasSubstr("'s' has no nofASDU: 1 is assumed")));
    auto const streams = read(imported->streams);
    ASSERT_EQ(streams.size(), 1U);
    EXPECT_EQ(streams[0].address.app_id, 0x4000);
    EXPECT_EQ(streams[0].rate_hz, Rational{4800});
}

TEST(Scl, TimesThatContradictEachOtherAreReplacedAndNoted) {
    auto const timing_of = [](std::string const& times, std::size_t notes) {
        std::string const addresses =
            R"(<ConnectedAP iedName="F1" apName="S1"><GSE ldInst="L" cbName="g"><Address><P type="MAC-Address">01-0C-CD-01-00-01</P><P type="APPID">0001</P></Address>)" +
            times + "</GSE></ConnectedAP>";
        std::string const sets = "<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="q")") + kBlock;
        auto const imported = import_streams(file_with(sets, kMeter, kMeterTypes, addresses), "f.scd", {});
        EXPECT_EQ(imported->notes.size(), notes) << times;
        return read(imported->streams).at(0).timing;
    };
    EXPECT_EQ(timing_of("<MinTime>4</MinTime><MaxTime>500</MaxTime>", 0).max_time_ms, 500);
    EXPECT_EQ(timing_of("<MinTime>5000</MinTime>", 0).max_time_ms, 5000) << "not the default, which is shorter";
    EXPECT_EQ(timing_of("<MaxTime>2</MaxTime>", 0).min_time_ms, 2);
    EXPECT_EQ(timing_of("<MinTime>100</MinTime><MaxTime>10</MaxTime>", 1).min_time_ms, 100);
    EXPECT_EQ(timing_of("<MinTime>0.002</MinTime><MaxTime>2</MaxTime>", 1).min_time_ms, 0.002) << "perhaps seconds";
    EXPECT_EQ(timing_of("<MinTime>soon</MinTime><MaxTime>0</MaxTime>", 2).max_time_ms, 1000);
}

TEST(Scl, OptionsThatStreamsDoNotKeepAreNoted) {
    auto const notes_of = [](std::string const& smv, std::string const& options) {
        std::string const sets =
            "<DataSet name=\"d\">" + fcda(R"(doName="A.phsA" daName="q")") +
            "</DataSet><SampledValueControl name=\"s\" datSet=\"d\" smvID=\"x\" nofASDU=\"1\" confRev=\"1\" " + smv +
            "><SmvOpts " + options + "/></SampledValueControl>";
        return import_streams(file_with(sets, kMeter, kMeterTypes), "f.scd", {})->notes;
    };
    std::string const per_second = R"(smpRate="4000" smpMod="SmpPerSec")", per_period = R"(smpRate="80")";
    EXPECT_THAT(notes_of(per_second, R"(sampleRate="true" refreshTime="true" dataSet="true")"), IsEmpty());
    EXPECT_THAT(notes_of(per_second, R"(synchSourceId="true" security="true")"),
                ElementsAre(HasSubstr("synchSourceId"), HasSubstr("the option security")));
    EXPECT_THAT(
        notes_of(per_period, R"(sampleRate="true")"),
        ElementsAre(HasSubstr("4000 Hz"), HasSubstr("sends smpRate 80 and smpMod 0 (samples per period); a stream "
                                                    "with send_smp_rate sends 4000 and 1")));
    EXPECT_THAT(notes_of(per_second + R"( securityEnable="Signature")", ""), ElementsAre(HasSubstr("securityEnable")));
}

TEST(Scl, TypesThatContainThemselvesAreToldFromTypesThatAreMissing) {
    auto const note_of = [](std::string const& types) {
        auto const imported = import_streams(
            file_with("<DataSet name=\"d\">" + fcda(R"(doName="A")") + kBlock, kMeter, types), "f.scd", {});
        return imported->notes.size() == 1 && imported->streams.entries.empty() ? imported->notes[0] : "";
    };
    std::string const node = R"(<LNodeType id="M" lnClass="MMXU"><DO name="A" type="T"/></LNodeType>)";
    std::string const object = R"(<DOType id="T" cdc="MV"><DA name="x" bType="Struct" type="AV" fc="MX"/></DOType>)";
    EXPECT_THAT(note_of(node + object), HasSubstr("there is no DAType 'AV'"));
    EXPECT_THAT(note_of(node + object + R"(<DAType id="AV"><BDA name="x" bType="Struct" type="AV"/></DAType>)"),
                testing::AllOf(HasSubstr("levels deep at DAType 'AV'"), HasSubstr("it may contain itself")));
    EXPECT_THAT(
        note_of(node +
                R"(<DOType id="T" cdc="MV"><DA name="q" bType="Quality" fc="MX"/><SDO name="a" type="T"/></DOType>)"),
        HasSubstr("levels deep at DOType 'T'"));
}

TEST(Scl, NamesWhatIsNoScl) {
    EXPECT_THAT(import_streams("<a><b></a>", "f.scd", {}).error().message, HasSubstr("f.scd:1:1: not XML"));
    EXPECT_THAT(import_streams("<html/>", "f.scd", {}).error().message, HasSubstr("'html', not SCL"));
    EXPECT_FALSE(import_streams("", "f.scd", {}));
    EXPECT_THAT(import_streams(std::string{"\xFF\xFE<\0S\0", 6}, "f.scd", {}).error().message, HasSubstr("UTF-16"));
}

TEST(Scl, SurvivesDamage) {
    std::string const whole = kLiberal;
    for (std::size_t i = 0; i < whole.size(); i += 3) {
        std::string damaged = whole;
        damaged[i] = i % 2 == 0 ? '<' : 'x';
        (void)import_streams(damaged, "x", {});
        (void)import_streams(whole.substr(0, i), "x", {});
    }
}

TEST(Scl, RefusesToExportWhatSclHasNoWordsFor) {
    auto const why = [](std::string const& type) {
        auto const all = refusals(goose("T", 1, "control_block: ALD0/LLN0$GO$T, data_set: {x: {h: " + type + "}}"));
        return all.size() == 1 ? all[0] : "";
    };
    EXPECT_THAT(why("[float32, int8]"), HasSubstr("T: its member 'x' is or holds an array of different types"));
    EXPECT_THAT(why("[[int8, int8]]"), HasSubstr("an array of arrays"));
    EXPECT_THAT(why("{type: bit_string, length: 5}"), HasSubstr("a bit_string of 5 bits"));
    EXPECT_THAT(why("{array: {type: octet_string, length: 65}, count: 2}"), HasSubstr("an octet_string of 65 octets"));
}

TEST(Scl, IsValidByTheSchema) { // which is not ours to ship
    char const* const schema = std::getenv("GRIDSPACE_SCL_SCHEMA");
    if (schema == nullptr) {
        GTEST_SKIP() << "GRIDSPACE_SCL_SCHEMA does not name SCL.xsd (2007B4)";
    }
    std::string const file = testing::TempDir() + "/gridspace-export.cid";
    std::ofstream{file} << written(kStreams);
    EXPECT_EQ(std::system(("xmllint --noout --schema '" + std::string{schema} + "' '" + file + "'").c_str()), 0);
}

} // namespace
} // namespace gridspace::scl
