// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/model_description.hpp"

#include "common/source_tree.hpp"

#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>

namespace gridspace::fmi {
namespace {

using ::testing::HasSubstr;

std::string text_of(std::string const& file) {
    std::ifstream in{file};
    return {std::istreambuf_iterator<char>{in}, {}};
}

std::string example(int version) {
    return text_of(source_tree(fmt::format("examples/fmu/lag_fmi{}.xml", version)));
}

/// The example of a version with one text replaced; what is said about it.
std::string complaint(int version, std::string const& wanted, std::string const& instead) {
    std::string text = example(version);
    std::size_t const at = text.find(wanted);
    EXPECT_NE(at, std::string::npos) << wanted;
    text.replace(at, wanted.size(), instead);
    auto const read = parse_model_description(text, "sut.fmu");
    if (!read) {
        EXPECT_EQ(read.error().code, ExitCode::usage);
        return read.error().message;
    }
    auto const usable = read->usable();
    return usable ? "nothing" : usable.error().message;
}

TEST(AModelDescription, OfBothVersionsSaysTheSameOfTheSameModel) {
    for (int const version : {2, 3}) {
        auto const sut = parse_model_description(example(version), "lag.fmu");
        ASSERT_TRUE(sut) << sut.error().message;
        EXPECT_EQ(sut->version, version == 2 ? Version::fmi2 : Version::fmi3);
        EXPECT_EQ(sut->name, "lag");
        EXPECT_EQ(sut->license, "Apache-2.0");
        EXPECT_EQ(sut->stop_s, 60);
        ASSERT_TRUE(sut->co_simulation);
        EXPECT_TRUE(sut->co_simulation->variable_step);
        EXPECT_TRUE(sut->co_simulation->can_serialize_state);
        EXPECT_EQ(sut->variables.size(), 8U);
        Variable const* u = sut->find("u");
        ASSERT_NE(u, nullptr);
        EXPECT_EQ(u->reference, 1U);
        EXPECT_EQ(u->causality, Causality::input);
        EXPECT_EQ(u->variability, Variability::continuous);
        EXPECT_EQ(u->unit, "kW") << "of its declared type";
        EXPECT_EQ(u->start, "0");
        EXPECT_TRUE(u->takes_start());
        EXPECT_EQ(sut->find("tau")->unit, "s");
        EXPECT_EQ(sut->find("steps")->type, Type::int32);
        EXPECT_EQ(sut->find("steps")->variability, Variability::discrete);
        EXPECT_EQ(sut->find("hold")->type, Type::boolean);
        EXPECT_EQ(sut->find("label")->type, Type::string);
        EXPECT_FALSE(sut->find("time")->takes_start());
        EXPECT_EQ(sut->find("nothing"), nullptr);
    }
}

TEST(AModelDescription, AStructuralParameterTakesNoStartValueOutsideOfConfigurationMode) {
    Variable sut;
    sut.causality = Causality::structural_parameter;
    sut.variability = Variability::fixed;
    sut.start = "3";
    EXPECT_FALSE(sut.takes_start());
    sut.causality = Causality::parameter;
    EXPECT_TRUE(sut.takes_start());
}

TEST(AModelDescription, OfAnotherVersionIsRefused) {
    EXPECT_THAT(complaint(2, "fmiVersion=\"2.0\"", "fmiVersion=\"1.0\""),
                HasSubstr("fmiVersion is '1.0', and 2.0 and 3.0 are known"));
    EXPECT_THAT(complaint(3, "fmiVersion=\"3.0\"", "fmiVersion=\"4.0\""), HasSubstr("fmiVersion is '4.0'"));
    EXPECT_THAT(complaint(3, "fmiVersion=\"3.0\"", ""), HasSubstr("fmiVersion is ''"));
    EXPECT_EQ(complaint(3, "fmiVersion=\"3.0\"", "fmiVersion=\"3.0.2\""), "nothing");
}

TEST(AModelDescription, ForModelExchangeOnlyIsRefusedAsAnAgent) {
    EXPECT_THAT(complaint(2, "<CoSimulation", "<ModelExchange"), HasSubstr("for model exchange only"));
    EXPECT_THAT(complaint(3, "<CoSimulation", "<ScheduledExecution"), HasSubstr("for scheduled execution only"));
    EXPECT_THAT(complaint(3, "<CoSimulation", "<Nothing"), HasSubstr("for no interface at all only"));
}

TEST(AModelDescription, ThatIsBrokenNamesTheLine) {
    EXPECT_THAT(complaint(2, "</ModelVariables>", ""), HasSubstr("sut.fmu: modelDescription.xml:"));
    EXPECT_THAT(complaint(2, "</ModelVariables>", ""), HasSubstr("not XML"));
    EXPECT_THAT(complaint(2, "<ModelVariables>", "<Variables>"), HasSubstr("not XML"));
    EXPECT_THAT(complaint(3, "causality=\"input\" declaredType", "causality=\"imput\" declaredType"),
                HasSubstr("causality is 'imput', expected structuralParameter, parameter,"));
    EXPECT_THAT(complaint(2, "valueReference=\"3\"", "valueReference=\"-3\""),
                HasSubstr("xml:17: valueReference is '-3'"));
    EXPECT_THAT(complaint(2, "valueReference=\"3\"", ""), HasSubstr("ScalarVariable has no 'valueReference'"));
    EXPECT_THAT(complaint(2, "<Real start=\"1\"/>", ""), HasSubstr("variable 'k' has no type"));
    EXPECT_THAT(complaint(3, "name=\"y\"", "name=\"u\""), HasSubstr("two variables 'u'"));
    EXPECT_THAT(complaint(2, " guid=", " id="), HasSubstr("has no 'guid'"));
    EXPECT_THAT(complaint(3, "stopTime=\"60\"", "stopTime=\"soon\""),
                HasSubstr("stopTime is 'soon', expected a number"));
    EXPECT_THAT(complaint(3, "canGetAndSetFMUState=\"true\"", "canGetAndSetFMUState=\"yes\""),
                HasSubstr("expected true or false"));
    EXPECT_FALSE(parse_model_description("", "sut.fmu"));
    EXPECT_THAT(parse_model_description("<SCL/>", "sut.fmu").error().message, HasSubstr("root element is 'SCL'"));
}

TEST(AModelDescription, WhoseIdentifierWouldLeaveTheFolderOfBinariesIsRefused) {
    for (char const* name : {"../../evil", "a/b", "", ".hidden", "a b"}) {
        EXPECT_THAT(complaint(3, "modelIdentifier=\"lag\"", fmt::format("modelIdentifier=\"{}\"", name)),
                    HasSubstr("modelIdentifier is"))
            << name;
    }
}

TEST(AModelDescription, NestedWithoutEndOrWithEntitiesOfItsOwnDoesNoHarm) {
    std::string deep = "<fmiModelDescription fmiVersion=\"3.0\">";
    for (int i = 0; i < 100'000; ++i) {
        deep += "<a>";
    }
    EXPECT_FALSE(parse_model_description(deep, "sut.fmu"));
    std::string const bomb = "<!DOCTYPE a [<!ENTITY b \"bbbbbbbbbb\"><!ENTITY c \"&b;&b;&b;\">]>";
    auto const read = parse_model_description(bomb + example(3).substr(example(3).find("<fmi")), "sut.fmu");
    EXPECT_TRUE(read) << read.error().message; // entities are not expanded
}

TEST(AModelDescription, KnowsArraysAndOtherNamesOfAVariable) {
    auto const sut = parse_model_description(
        R"(<fmiModelDescription fmiVersion="3.0" modelName="m" instantiationToken="t"><CoSimulation modelIdentifier="m"/><ModelVariables>
           <Float64 name="h" valueReference="1" causality="output" start="1"><Alias name="h_again" description="the same"/></Float64>
           <Float64 name="a" valueReference="2" causality="input" start="1 2"><Dimension start="2"/></Float64></ModelVariables></fmiModelDescription>)",
        "sut.fmu");
    ASSERT_TRUE(sut) << sut.error().message;
    EXPECT_EQ(sut->find("h_again")->reference, 1U);
    EXPECT_TRUE(sut->find("a")->is_array);
    EXPECT_FALSE(sut->find("h")->is_array);
}

} // namespace
} // namespace gridspace::fmi
