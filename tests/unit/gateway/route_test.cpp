// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/route.hpp"

#include "bus/topics.hpp"
#include "common/config/merge.hpp"
#include "common/config/yaml.hpp"
#include "gateways/mapping/record_writer.hpp"

#include <gmock/gmock.h>

namespace gridspace::gateways {
namespace {

using mapping::Value;
using testing::AllOf;
using testing::HasSubstr;

constexpr char const* kStreams = R"(
streams:
  SV: {kind: smv, mac: "01:0C:CD:04:00:03", app_id: 0x4003, sv_id: MU03, data_set: {Ia: int32, q: quality, P: float32}}
  LE: {kind: smv, mac: "01:0C:CD:04:00:04", app_id: 0x4004, sv_id: MU04, data_set: 9-2LE}
  GO: {kind: goose, mac: "01:0C:CD:01:00:03", app_id: 3, control_block: LD/LLN0$GO$a, data_set: {st: boolean, pos: position, id: {type: visible_string, length: 8}}}
  GQ: {kind: goose, mac: "01:0C:CD:01:00:04", app_id: 4, control_block: LD/LLN0$GO$q, data_set: {q: quality}}
)";

struct Made {
    GatewayConfig config;
    std::vector<streams::Stream> streams;
    std::vector<Route> routes;
    std::string said; ///< diagnostics; empty when nothing is wrong
};

/// Routes of a table as it would stand in a file.
std::unique_ptr<Made> make(std::string const& mappings) {
    auto out = std::make_unique<Made>();
    config::Diagnostics diagnostics;
    std::string const text = kStreams + mappings;
    auto root = config::parse_yaml(text, config::make_source("gw.yaml", text), diagnostics);
    if (root) {
        out->streams = streams::read_streams(*root->find("streams"), diagnostics);
        config::Node table = config::Node::map();
        table.set("mappings", *root->find("mappings"));
        config::read_fields(table, "", diagnostics, [&](config::Fields& f) { describe(f, out->config); });
        if (diagnostics.ok()) {
            out->routes = make_routes(out->config, out->streams, bus::idl_of_type, diagnostics);
        }
    }
    out->said = diagnostics.errors() > 0 ? diagnostics.render() : "";
    return out;
}

std::string mapping_of(std::string const& from, std::string const& to, std::string const& fields,
                       std::string const& more = "") {
    return "mappings:\n  m:\n    from: " + from + "\n    to: " + to + "\n    fields: " + fields + "\n" + more;
}

std::string const kBus = "{topic: bus_measurements, type: BusMeasurement, where: {bus: B3}}";
std::string const kFeeder = "{topic: feeders, type: \"example::FeederState\"}";

TEST(Route, TakesAUsersOwnTypeFromItsIdlFileAlone) {
    auto const sut = make(mapping_of(
        "{stream: GO}", kFeeder,
        "{energised: st, position: pos, \"angles_mrad[1]\": {value: -7}, source: {value: SOURCE_ESTIMATED}}"));
    ASSERT_EQ(sut->said, "");
    Route& route = sut->routes.front();
    std::vector<Value> in(route.from.size()), out;
    for (mapping::Field const& field : route.to) {
        out.push_back({field.type, 0, 0, {}});
    }
    in[0] = Value::of(true);
    in[1] = {mapping::BasicType::position, 0, 2, {}};
    route.rules.apply(in, out);
    auto const at = [&](char const* name) { return out[*route.to_type->index_of(name)]; };
    EXPECT_TRUE(at("energised").boolean());
    EXPECT_EQ(at("position").bits, 2U);
    EXPECT_EQ(at("angles_mrad.1").as_signed(), -7);
    EXPECT_EQ(at("source").as_signed(), 1);
    EXPECT_TRUE(route.time_field.has_value()) << "time_ns is the gateway's";
}

TEST(Route, TakesUnitsFromTheNamesOfTopicFields) {
    auto const sut = make(mapping_of(kBus, "{stream: SV}", "{P: {from: p_kw, to_unit: W}}"));
    ASSERT_EQ(sut->said, "");
    Route& route = sut->routes.front();
    std::vector<Value> in(route.from.size());
    in[*route.from_type->index_of("p_kw")] = Value::of(1.5);
    std::vector<Value> out(route.to.size());
    route.rules.apply(in, out);
    EXPECT_EQ(out[2].number(), 1500);
    EXPECT_EQ(route.filters.size(), 1U);
    EXPECT_TRUE(route.is_held());
}

TEST(Route, SaysEverythingThatIsWrongAtItsPlace) {
    auto const sut =
        make(mapping_of(kBus, "{stream: SV}", "{Ia: v_puu, q: {value: goood}, X: v_pu, P: {from: p_kw, to_unit: V}}"));
    EXPECT_THAT(sut->said,
                AllOf(HasSubstr("gw.yaml:11:18: error: there is no field 'v_puu'"), HasSubstr("did you mean 'v_pu'?"),
                      HasSubstr("gw.yaml:11:36: error: 'goood' is no value of 'q', which is quality"),
                      HasSubstr("expected good, invalid"), HasSubstr("gw.yaml:11:44: error: there is no field 'X'"),
                      HasSubstr("there are: Ia, q, P"),
                      HasSubstr("'p_kw' is in kW, 'P' in V: they measure different things"), HasSubstr("4 errors")))
        << sut->said;
}

struct Mistake {
    char const* name;
    std::string mappings;
    char const* said;
};
class Mistakes : public testing::TestWithParam<Mistake> {};

TEST_P(Mistakes, AreRefusedWithAReason) {
    auto const sut = make(GetParam().mappings);
    EXPECT_THAT(sut->said, HasSubstr(GetParam().said));
}

INSTANTIATE_TEST_SUITE_P(
    Route, Mistakes,
    testing::Values(
        Mistake{"BothTopics", mapping_of(kBus, kFeeder, "{position: v_pu}"),
                "mapping 'm' goes from a topic to a topic"},
        Mistake{"NeitherTopicNorStream", mapping_of("{}", "{stream: SV}", "{Ia: x}"),
                "a mapping needs a topic or a stream here"},
        Mistake{"TopicWithoutType", mapping_of("{topic: x}", "{stream: SV}", "{Ia: x}"),
                "the type of topic 'x' is missing"},
        Mistake{"UnknownType", mapping_of("{topic: x, type: Foo}", "{stream: SV}", "{Ia: x}"),
                "no IDL file of this build defines the type 'Foo'"},
        Mistake{"UnknownStream", mapping_of(kBus, "{stream: SW}", "{Ia: v_pu}"), "there is no stream 'SW'"},
        Mistake{"NumberToBoolean", mapping_of(kBus, "{stream: GO}", "{st: v_pu}"), "what is true is a decision"},
        Mistake{"DerivedInGoose", mapping_of(kBus, "{stream: GQ}", "{q: {value: 0x2003}}"),
                "a number up to 0x1fff: GOOSE has no bit for 'derived'"},
        Mistake{"LongTextToAShortOne", mapping_of(kBus, "{stream: GO}", "{id: bus}"),
                "32 characters do not fit into 8"},
        Mistake{"TimeIsTheGateways", mapping_of("{stream: GO}", kFeeder, "{time_ns: $t}"),
                "'time_ns' is written by the gateway itself"},
        Mistake{
            "SamplesWithoutIndex",
            mapping_of("{topic: TL_21, type: LineCurrents}", "{stream: SV}", "{P: samples.ia}", "    each: samples\n"),
            "samples of a sequence need their place in time"},
        Mistake{
            "NotASequence",
            mapping_of("{topic: TL_21, type: LineCurrents}", "{stream: SV}", "{P: samples.ia}", "    each: sample\n"),
            "'sample' is not a sequence of the type 'LineCurrents'"},
        Mistake{"TextAsIndex",
                mapping_of("{topic: TL_21, type: LineCurrents}", "{stream: SV}", "{P: samples.ia}",
                           "    each: samples\n    index: transformer\n"),
                "'transformer' cannot hold an index"},
        Mistake{"EveryOfGoose", mapping_of("{stream: GO}", kFeeder, "{energised: st}", "    every: 2\n"),
                "`every`, which is for sampled values"},
        Mistake{"FieldTwice",
                mapping_of("{stream: GO}", kFeeder, "{angles_mrad.0: $st_num, \"angles_mrad[0]\": $sq_num}"),
                "field 'angles_mrad.0' is written twice"},
        Mistake{"FieldOfTheOtherKind", mapping_of("{stream: GO}", kFeeder, "{energised: st, angles_mrad.0: $smp_cnt}"),
                "there is no field '$smp_cnt'"},
        Mistake{"FromAndValue", mapping_of(kBus, "{stream: SV}", "{P: {from: v_pu, value: 1}}"),
                "`from` and `value` at once"},
        Mistake{"UnknownKey", mapping_of(kBus, "{stream: SV}", "{P: {from: v_pu, sclae: 2}}"), "unknown key 'sclae'"},
        Mistake{"FieldIsAList", mapping_of(kBus, "{stream: SV}", "{P: [v_pu]}"), "field 'P' is a list"},
        Mistake{"NoFields", mapping_of(kBus, "{stream: SV}", "{}"), "the fields are"},
        Mistake{"FilterOfAnotherType",
                mapping_of("{topic: b, type: BusMeasurement, where: {v_pu: high}}", "{stream: SV}", "{P: v_pu}"),
                "'high' is no value of 'v_pu' to choose samples by"},
        Mistake{"WatchedText", mapping_of("{stream: GO}", kFeeder, "{feeder: id}", "    watch: [feeder]\n"),
                "a signal is a number"},
        Mistake{"TwoForOneStream",
                mapping_of(kBus, "{stream: SV}", "{P: v_pu}") + "  n: {from: " + kBus +
                    ", to: {stream: SV}, fields: {P: v_pu}}\n",
                "stream 'SV' is sent by mapping 'm' already"}),
    [](auto const& mistake) { return mistake.param.name; });

TEST(Route, CallsTheChannelsInvalidThatNobodyWrites) {
    auto const invalid = [](std::string const& fields) {
        auto const sut = make(mapping_of(kBus, "{stream: LE}", fields));
        EXPECT_EQ(sut->said, "");
        std::vector<std::string> out;
        for (std::size_t const field : sut->routes.front().invalid) {
            out.push_back(sut->routes.front().to[field].name);
        }
        return out;
    };
    EXPECT_THAT(invalid("{Ia: v_pu, Ib: v_pu, Ic: v_pu}"),
                testing::ElementsAre("In_q", "Va_q", "Vb_q", "Vc_q", "Vn_q"));
    EXPECT_THAT(invalid("{Ia: v_pu, Ib: v_pu, Ic: {value: 0}, In_q: {value: good}, Va: v_pu, Vb: v_pu, Vc: v_pu}"),
                testing::ElementsAre("Vn_q"));
    auto const held = make(mapping_of("{stream: GO}", kFeeder, "{energised: st}"));
    EXPECT_TRUE(held->routes.front().invalid.empty()) << "a topic says what it says";
}

TEST(Route, KeepsTheQualitiesThatAStreamCanCarry) {
    auto const constant = [](std::string const& stream, std::string const& value) {
        auto const sut = make(mapping_of(kBus, "{stream: " + stream + "}", "{q: {value: \"" + value + "\"}}"));
        EXPECT_EQ(sut->said, "");
        std::vector<Value> in(sut->routes.front().from.size()), out(sut->routes.front().to.size());
        sut->routes.front().rules.apply(in, out);
        return out[sut->routes.front().written.front()].bits;
    };
    EXPECT_EQ(constant("SV", "questionable | derived"), 0x2003U);
    EXPECT_EQ(constant("GQ", "questionable | out_of_range"), 0xBU);
}

TEST(Route, KeepsItsConstantsWhenItMoves) {
    auto const sut = make(mapping_of("{stream: GO}", kFeeder, "{feeder: {value: A1}}"));
    ASSERT_EQ(sut->said, "");
    Route route = std::move(sut->routes.front());
    std::vector<Value> in(route.from.size()), out(route.to.size());
    route.rules.apply(in, out);
    EXPECT_EQ(to_string(out[0]), "A1");
}

} // namespace
} // namespace gridspace::gateways
