// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/description_writer.hpp"

#include "fmi/units.hpp"

#include <gtest/gtest.h>
#include <numbers>

namespace gridspace::fmi {
namespace {

Variable variable(std::string name, std::uint32_t reference, Causality causality) {
    Variable v;
    v.name = std::move(name);
    v.reference = reference;
    v.causality = causality;
    return v;
}

ModelDescription description() {
    ModelDescription d;
    d.version_text = "3.0";
    d.name = "grid <1> & \"2\"";
    d.token = "t";
    d.co_simulation = CoSimulation{.identifier = "grid", .variable_step = true, .fixed_internal_step_s = 1.0 / 48000};
    d.start_s = 0;
    d.stop_s = 10;
    d.step_s = 1.0 / 48000;
    d.variables.push_back(variable("time", 0, Causality::independent));
    Variable power = variable("p", 1, Causality::input);
    power.unit = "kW";
    power.start = "0.1";
    power.min = -5;
    d.variables.push_back(power);
    Variable closed = variable("closed", 2, Causality::input);
    closed.type = Type::boolean;
    closed.variability = Variability::discrete;
    closed.start = "true";
    d.variables.push_back(closed);
    Variable voltage = variable("v", 3, Causality::output);
    voltage.unit = "V";
    d.variables.push_back(voltage);
    return d;
}

TEST(DescriptionWriter, ReadsBackAsWhatItWasMadeFrom) {
    ModelDescription const d = description();

    auto const read = parse_model_description(write_model_description(d), "grid.fmu");

    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->name, d.name);
    EXPECT_EQ(read->token, d.token);
    EXPECT_EQ(read->step_s, d.step_s) << "the shortest text is the same double";
    EXPECT_EQ(read->co_simulation->fixed_internal_step_s, 1.0 / 48000);
    EXPECT_TRUE(read->co_simulation->variable_step);
    EXPECT_FALSE(read->co_simulation->can_get_and_set_state || read->co_simulation->needs_execution_tool);
    ASSERT_EQ(read->variables.size(), 4U);
    for (std::size_t i = 0; i < 4; ++i) {
        Variable const &ours = d.variables[i], &theirs = read->variables[i];
        EXPECT_EQ(theirs.name, ours.name);
        EXPECT_EQ(theirs.reference, ours.reference);
        EXPECT_EQ(theirs.type, ours.type);
        EXPECT_EQ(theirs.causality, ours.causality);
        EXPECT_EQ(theirs.variability, ours.variability);
        EXPECT_EQ(theirs.unit, ours.unit);
        EXPECT_EQ(theirs.start, ours.start);
    }
}

TEST(DescriptionWriter, ListsEachOutputWithoutDependenciesAndEachUnitOnce) {
    std::string const xml = write_model_description(description());
    for (char const* part : {"<Output valueReference=\"3\" dependencies=\"\"/>",
                             "<InitialUnknown valueReference=\"3\" dependencies=\"\"/>",
                             "<BaseUnit kg=\"1\" m=\"2\" s=\"-3\" factor=\"1000\"/>", "min=\"-5\""}) {
        EXPECT_NE(xml.find(part), std::string::npos) << part << '\n' << xml;
    }
    EXPECT_EQ(xml.find("max="), std::string::npos);
    EXPECT_EQ(xml.find("<Output"), xml.rfind("<Output"));
}

TEST(DescriptionWriter, GivesEachEnumerationATypeWithItsWords) {
    ModelDescription d = description();
    Variable mode = variable("mode", 4, Causality::input);
    mode.type = Type::enumeration;
    mode.variability = Variability::discrete;
    mode.start = "1";
    mode.items = {"droop", "fixed_power"};
    d.variables.push_back(mode);

    std::string const xml = write_model_description(d);

    for (char const* part : {"<EnumerationType name=\"type.mode\">", "<Item name=\"fixed_power\" value=\"2\"/>",
                             "declaredType=\"type.mode\""}) {
        EXPECT_NE(xml.find(part), std::string::npos) << part << '\n' << xml;
    }
    auto const read = parse_model_description(xml, "grid.fmu");
    ASSERT_TRUE(read) << read.error().message;
    EXPECT_EQ(read->variables.back().type, Type::enumeration);
    EXPECT_EQ(write_model_description(description()).find("TypeDefinitions"), std::string::npos);
}

TEST(DescriptionWriter, HasNoEmptyListOfUnits) {
    ModelDescription d = description();
    for (Variable& v : d.variables) {
        v.unit.clear();
    }
    EXPECT_EQ(write_model_description(d).find("UnitDefinitions"), std::string::npos);
}

/// Against the definitions of the SI: V = W / A, W = J / s = kg m2 / s3, kWh = 3.6 MJ.
TEST(Units, AreThoseOfTheSi) {
    Unit const &v = *unit_named("V"), &a = *unit_named("A"), &kw = *unit_named("kW");
    EXPECT_EQ(v.kg + a.kg, kw.kg);
    EXPECT_EQ(v.m + a.m, kw.m);
    EXPECT_EQ(v.s + a.s, kw.s);
    EXPECT_EQ(v.a + a.a, kw.a);
    EXPECT_EQ(v.factor * a.factor * 1000, kw.factor);
    EXPECT_EQ(180 * unit_named("deg")->factor, std::numbers::pi);
    EXPECT_EQ(unit_named("degC")->factor * 25 + unit_named("degC")->offset, 298.15);
    EXPECT_EQ(unit_named("kWh/kg")->factor, 1000 * 3600);
    EXPECT_EQ(100 * unit_named("%")->factor, 1);
    EXPECT_EQ(unit_named("Hz")->s, -1);
    EXPECT_EQ(unit_named("dpc"), nullptr) << "a code is no unit";
}

} // namespace
} // namespace gridspace::fmi
