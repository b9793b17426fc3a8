// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "support.hpp"

namespace gridspace::opendss {
namespace {

std::string const kCircuit = "New Circuit.c basekv=4.16\n";

/// The values that a script gives an object, in its order: "kw=5".
std::vector<std::string> values(Script const& script, char const* class_name, char const* name) {
    std::vector<std::string> out;
    Object const* object = script.find(class_name, name);
    for (std::size_t i = 0; object != nullptr && i < object->assignments.size(); ++i) {
        Assignment const& a = object->assignments[i];
        out.push_back(std::string{object->info->properties[a.property]} + "=" + a.value.value);
    }
    return out;
}

Script correct(std::string const& text, Files const& files = {}) {
    config::Diagnostics diagnostics;
    Script script = script_of(text, diagnostics, files);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return script;
}

TEST(DssScript, ReadsPropertiesByNameByTheBeginningOfANameAndByPlace) {
    Script const s = correct(kCircuit + "New object=Line.a b1 b2 code1 0.4 Phases=1 3.3\n"
                                        "~ unit=kft\n");
    EXPECT_THAT(values(s, "line", "a"), testing::ElementsAre("bus1=b1", "bus2=b2", "linecode=code1", "length=0.4",
                                                             "phases=1", "r1=3.3", "units=kft"));
}

TEST(DssScript, EditsObjectsByCommandByPathAndInBatches) {
    Script const s = correct(kCircuit + "New Load.a1 kW=1\nNew Load.a2 kW=2\nNew Load.b1 kW=3\n"
                                        "Edit Load.a1 kvar=4\nLOAD.A2.kW=(2 3 *) pf=0.9\n"
                                        "BatchEdit Load..*1 model=2\ndisable load.b1\n");
    EXPECT_THAT(values(s, "load", "a1"), testing::ElementsAre("kw=1", "kvar=4", "model=2"));
    EXPECT_THAT(values(s, "load", "a2"), testing::ElementsAre("kw=2", "kw=2 3 *", "pf=0.9"));
    EXPECT_THAT(values(s, "load", "b1"), testing::ElementsAre("kw=3", "model=2", "enabled=no"));
}

TEST(DssScript, LikeCopiesEverythingButTheBuses) {
    Script const s = correct(kCircuit + "New Load.a Bus1=x kW=1 model=2\nNew Load.b Bus1=y kW=7 like=a kvar=3\n");
    EXPECT_THAT(values(s, "load", "b"), testing::ElementsAre("bus1=y", "kw=1", "model=2", "kvar=3"));
}

TEST(DssScript, ReadsRedirectedFilesFromTheirFoldersAndCompiledOnesForGood) {
    Files const files{{"sub/part.dss", "Redirect more/deep.dss\n"},
                      {"sub/more/deep.dss", "New Load.deep kW=1\n"},
                      {"after.dss", "New Load.after kW=2\n"},
                      {"sub/after.dss", "New Load.sub kW=3\n"}};
    Script const redirected = correct(kCircuit + "redirect sub\\part.dss\nredirect after.dss\n", files);
    EXPECT_NE(redirected.find("load", "deep"), nullptr);
    EXPECT_NE(redirected.find("load", "after"), nullptr);
    Script const compiled = correct(kCircuit + "compile (sub/part.dss)\nredirect after.dss\n", files);
    EXPECT_NE(compiled.find("load", "sub"), nullptr);
    EXPECT_EQ(compiled.find("load", "after"), nullptr);
}

TEST(DssScript, RefusesFilesThatRedirectInACircleOrTooDeep) {
    EXPECT_THAT(mistakes(kCircuit + "redirect a\n", {{"a", "redirect b\n"}, {"b", "redirect a\n"}}),
                testing::HasSubstr("b:1:10: error: 'a' is being read already: the files redirect in a circle"));
    Files chain;
    for (int i = 0; i < 40; ++i) {
        chain[std::to_string(i)] = "redirect " + std::to_string(i + 1) + "\n";
    }
    EXPECT_THAT(mistakes(kCircuit + "redirect 0\n", chain), testing::HasSubstr("files redirect more than 32 deep"));
}

TEST(DssScript, SaysWhatItDoesNotKnowAndWhatIsNear) {
    EXPECT_THAT(mistakes("clear\nNew Circuit.c\nNew Laod.a kW=1\n"),
                testing::AllOf(testing::HasSubstr("main.dss:3:5: error: there is no class 'laod'"),
                               testing::HasSubstr("did you mean 'load'?")));
    EXPECT_THAT(mistakes(kCircuit + "New Load.a bus1=x kWat=1\n"),
                testing::HasSubstr("main.dss:2:24: error: a load has no property 'kwat'"));
    EXPECT_THAT(mistakes(kCircuit + "Edit Load.none kW=1\n"), testing::HasSubstr("there is no load.none"));
    EXPECT_THAT(mistakes(kCircuit + "sovle\n"), testing::HasSubstr("there is no command 'sovle'"));
    EXPECT_THAT(mistakes("New Load.a kW=1\n"), testing::HasSubstr("load.a comes before any circuit"));
    EXPECT_THAT(mistakes(kCircuit + "redirect none.dss\n"),
                testing::HasSubstr("main.dss:2:10: error: there is no file 'none.dss'"));
}

TEST(DssScript, ListsWhatIsNotTakenOver) {
    Script const s =
        correct(kCircuit + "New Storage.b kWrated=5\n~ kWh=5\nNew EnergyMeter.m Line.x 1\nallocateloads\n");
    ASSERT_EQ(s.left_out.size(), 3U);
    EXPECT_EQ(s.left_out[0].what, "storage.b");
    EXPECT_EQ(s.left_out[0].where.line, 2);
    EXPECT_TRUE(s.left_out[0].changes_result);
    EXPECT_FALSE(s.left_out[1].changes_result);
    EXPECT_EQ(s.left_out[2].what, "the command 'allocateloads'");
}

TEST(DssScript, PutsVariablesInPlaceAndSkipsCommentsOfSeveralLines) {
    Script const s = correct(kCircuit + "var @p=4\n/* New Load.gone kW=1\nNew Load.gone kW=1 */\n"
                                        "New Load.a kW=(@p 2 *)\n");
    EXPECT_EQ(s.find("load", "gone"), nullptr);
    EXPECT_THAT(values(s, "load", "a"), testing::ElementsAre("kw=4 2 *"));
}

TEST(DssScript, ClearBeginsAnewAndKeepsTheBaseFrequency) {
    Script const s = correct("Set DefaultBaseFrequency=50\nNew Circuit.a\nNew Load.x kW=1\nClear\nNew Circuit.b\n");
    EXPECT_EQ(s.circuit, "b");
    EXPECT_EQ(s.find("load", "x"), nullptr);
    EXPECT_EQ(s.options.at("defaultbasefrequency").value, "50");
}

TEST(DssScript, AnOptionIsKnownByTheBeginningOfItsName) {
    Script const s = correct(kCircuit + "Set loadmu=0.5 loadm=admittance Volt=[4.16] nothing_of_ours=1\n");
    EXPECT_EQ(s.options.at("loadmult").value, "0.5");
    EXPECT_EQ(s.options.at("loadmodel").value, "admittance");
    EXPECT_TRUE(s.options.contains("voltagebases"));
    EXPECT_TRUE(s.options.contains("nothing_of_ours"));
}

TEST(DssScript, BoundsWhatLikeCanMakeOfAShortFile) {
    std::string text = kCircuit + "New Load.l0 kW=1 kvar=2\n";
    for (int i = 1; i <= 64; ++i) { // copies of copies must not double
        text += fmt::format("New Load.l{0} like=l{1} like=l{1} pf=0.9\n", i, i - 1);
    }
    Script const s = correct(text);
    EXPECT_EQ(s.find("load", "l64")->assignments.size(), 2U + 64);
}

} // namespace
} // namespace gridspace::opendss
