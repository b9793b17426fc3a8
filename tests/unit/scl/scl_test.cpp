// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_export.hpp"
#include "gateways/scl/scl_import.hpp"

#include "common/config/yaml.hpp"

#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>

namespace gridspace::scl {
namespace {

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

constexpr char kStreams[] = R"(
SMV21: {kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: GS_TL2_MU21, conf_rev: 3, rate_hz: 4800, samples_per_frame: 2, vlan_id: 100,
        vlan_priority: 6, send_refr_tm: true, data_set_name: MU21LD1/LLN0$Currents, data_set: {Ia: float32, Ib: float32, Ic: float32, q: quality}}
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
    auto const scl = export_streams(before, "test");
    ASSERT_TRUE(scl) << describe(scl.error());
    auto const imported = import_streams(*scl, "test.cid", {});
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

TEST(Scl, OnlyTheNamedIedIsImported) {
    auto const scl = export_streams(read(kStreams), "test");
    ImportOptions options;
    options.ied = "IED2";
    EXPECT_EQ(import_streams(*scl, "x", options)->streams.entries.size(), 1U);
    options.ied = "IED3";
    auto const refused = import_streams(*scl, "x", options);
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
    ASSERT_EQ(imported->notes.size(), 3U);
    EXPECT_THAT(imported->notes[0], HasSubstr("'nonsense'"));
    EXPECT_THAT(imported->notes[1], HasSubstr("'g3' has no address"));
    EXPECT_THAT(imported->notes[2], HasSubstr("4800 Hz"));
}

TEST(Scl, NamesWhatIsNoScl) {
    EXPECT_THAT(import_streams("<a><b></a>", "f.scd", {}).error().message, HasSubstr("f.scd:1: not XML"));
    EXPECT_THAT(import_streams("<html/>", "f.scd", {}).error().message, HasSubstr("'html', not SCL"));
    EXPECT_FALSE(import_streams("", "f.scd", {}));
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
    auto const refused = export_streams(
        read(
            R"(T: {kind: goose, mac: "01:0C:CD:01:00:02", control_block: ALD0/LLN0$GO$T, data_set: {h: [float32, float32]}})"),
        "x");
    ASSERT_FALSE(refused);
    EXPECT_THAT(refused.error().message, HasSubstr("stream 'T': member 'h' is an array"));
}

TEST(Scl, IsValidByTheSchema) { // which is not ours to ship
    char const* const schema = std::getenv("GRIDSPACE_SCL_SCHEMA");
    if (schema == nullptr) {
        GTEST_SKIP() << "GRIDSPACE_SCL_SCHEMA does not name SCL.xsd (2007B4)";
    }
    std::string const file = testing::TempDir() + "/gridspace-export.cid";
    std::ofstream{file} << *export_streams(read(kStreams), "test");
    EXPECT_EQ(std::system(("xmllint --noout --schema '" + std::string{schema} + "' '" + file + "'").c_str()), 0);
}

} // namespace
} // namespace gridspace::scl
