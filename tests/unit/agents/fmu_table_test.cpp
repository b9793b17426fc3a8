// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/fmu_table.hpp"

#include "bus/topics.hpp"
#include "common/config/yaml.hpp"
#include "common/source_tree.hpp"

#include <fstream>
#include <gmock/gmock.h>

namespace gridspace::agents {
namespace {

using ::testing::ElementsAre;
using ::testing::HasSubstr;

/// Settings as YAML beside the lag's description (u and y in kW).
struct Settings {
    explicit Settings(std::string const& yaml) {
        std::ifstream in{source_tree("examples/fmu/lag_fmi3.xml")};
        auto read = fmi::parse_model_description(std::string{std::istreambuf_iterator<char>{in}, {}}, "lag.fmu");
        EXPECT_TRUE(read);
        description = *read;
        std::string const text = "fmu: lag.fmu\nperiod_s: 1\n" + yaml;
        auto const root = config::parse_yaml(text, config::make_source("own.yaml", text), diagnostics);
        config::read_fields(*root, "", diagnostics, [&](config::Fields& f) { describe(f, config); });
        table = make_table(config, description, "lag", bus::idl_of_type, diagnostics);
    }
    std::size_t variable(std::string_view name) const {
        return static_cast<std::size_t>(description.find(name) - description.variables.data());
    }
    fmi::ModelDescription description;
    config::Diagnostics diagnostics;
    FmuConfig config;
    FmuTable table;
};

TEST(AnFmuTable, ConvertsTheUnitsOfTopicAndFmu) {
    Settings sut{"inputs: {a: {topic: t, type: BusMeasurement, fields: {u: {from: v_pu, from_unit: W}}}}"};
    ASSERT_TRUE(sut.diagnostics.ok()) << sut.diagnostics.render();
    FmuTable::Input& input = sut.table.inputs.front();
    std::vector<mapping::Value> in(input.type.fields.size()), out(sut.table.variables.size());
    in[*input.type.type->index_of("v_pu")] = mapping::Value::of(2500.0);

    input.rules.apply(in, out);

    EXPECT_EQ(out[sut.variable("u")].number(), 2.5); // kW
}

TEST(AnFmuTable, MakesASetPointOfAVariableWithConstantsForElementAndQuantity) {
    Settings sut{"outputs: {a: {set_point: battery.BAT1.p_kw, from: y, scale: -1, valid_for_s: 3}}"};
    ASSERT_TRUE(sut.diagnostics.ok()) << sut.diagnostics.render();
    ASSERT_EQ(sut.table.outputs.size(), 1U);
    FmuTable::Output& output = sut.table.outputs.front();
    EXPECT_EQ(output.topic, "set_points");
    EXPECT_TRUE(output.time_field);
    EXPECT_THAT(sut.table.read, ElementsAre(sut.variable("y")));
    std::vector<mapping::Value> in(sut.table.variables.size()), out(output.type.fields.size());
    in[sut.variable("y")] = mapping::Value::of(2.5);

    output.rules.apply(in, out);

    auto const field = [&](std::string_view name) { return out[*output.type.type->index_of(name)]; };
    EXPECT_EQ(to_string(field("element")), "battery.BAT1");
    EXPECT_EQ(to_string(field("quantity")), "p_kw");
    EXPECT_EQ(field("value").number(), -2.5);
    EXPECT_EQ(field("valid_for_s").number(), 3);
}

TEST(AnFmuTable, RefusesAQuantityOfAnotherUnit) {
    Settings sut{"outputs: {a: {set_point: ev.EV1.current_a, from: y}}"};
    EXPECT_FALSE(sut.diagnostics.ok());
    EXPECT_THAT(sut.diagnostics.render(), HasSubstr("kW"));
}

TEST(AnFmuTable, TakesStartValuesOfEachTypeAndKeepsTheirPlaces) {
    Settings sut{"start: {tau: 5, hold: true, label: pump 1}"};
    ASSERT_TRUE(sut.diagnostics.ok()) << sut.diagnostics.render();
    ASSERT_EQ(sut.table.start.size(), 3U);
    EXPECT_EQ(std::get<double>(sut.table.start[0].value), 5);
    EXPECT_TRUE(std::get<bool>(sut.table.start[1].value));
    EXPECT_EQ(std::get<std::string>(sut.table.start[2].value), "pump 1");
}

TEST(AnFmuTable, NamesTheVariablesAndWordsThatItDoesNotKnow) {
    Settings sut{"watch: [z]\nstart: {tua: 1}\noutputs: {a: {topic: t, type: Nothing, fields: {a: y}}}"};
    std::string const said = sut.diagnostics.render();
    EXPECT_THAT(said, HasSubstr("own.yaml:3:9: error: the FMU has no variable 'z'"));
    EXPECT_THAT(said, HasSubstr("own.yaml:4:9: error: the FMU has no variable 'tua'"));
    EXPECT_THAT(said, HasSubstr("no IDL file of this build defines the type 'Nothing'"));
}

TEST(AnFmuTable, MakesNamesOfSignalsThatExpectationsCanRead) {
    EXPECT_EQ(signal_name("lag", "der(x)"), "agent.lag.der_x_");
    EXPECT_EQ(signal_name("lag", "pipe[2].T"), "agent.lag.pipe.2.T");
}

} // namespace
} // namespace gridspace::agents
