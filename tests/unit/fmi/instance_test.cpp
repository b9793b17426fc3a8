// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/stepper.hpp"
#include "tests/unit/fmi/fmu_under_test.hpp"

#include <cfenv>
#include <cmath>

namespace gridspace::fmi {
namespace {

/// Both versions of the standard.
class AnInstance : public ::testing::TestWithParam<int> {};
INSTANTIATE_TEST_SUITE_P(Fmi, AnInstance, ::testing::Values(2, 3),
                         [](auto const& of) { return "Fmi" + std::to_string(of.param); });

enum Fault : std::int64_t { kError = 5, kFatal = 4, kDiscard = 6, kEarly = 7, kTerminate = 9, kWarning = 11 };

struct Misfit : FmuUnderTest {
    Misfit(int version, Fault fault, double at_s, double largest_s = 1e9) : FmuUnderTest{own_fmu("misfit", version)} {
        set("fault", std::int64_t{fault});
        set("at", at_s);
        set("largest", largest_s);
        begin();
    }
    Result<Advance> advance(double from_s, double step_s) {
        return fmi::advance(*instance, can(), description.file, from_s, step_s);
    }
};

TEST_P(AnInstance, OfALagFollowsItsAnalyticSolution) {
    FmuUnderTest sut{own_fmu("lag", GetParam())};
    sut.set("tau", 5.0);
    sut.set("k", 2.0);
    sut.begin();
    sut.set("u", 3.0);

    for (int i = 0; i < 20; ++i) {
        ASSERT_TRUE(advance(*sut.instance, sut.can(), "lag", i * 0.5, 0.5));
        double const t = (i + 1) * 0.5;
        EXPECT_NEAR(sut.number("y"), 6 * (1 - std::exp(-t / 5)), 1e-12) << t;
    }
    EXPECT_EQ(std::get<std::int64_t>(sut.get("steps")), 20);
    EXPECT_EQ(sut.host.depth, 0);
}

TEST_P(AnInstance, TakesAndGivesValuesOfEachType) {
    FmuUnderTest sut{own_fmu("lag", GetParam())};
    sut.set("label", std::string{"pump 1"});
    sut.begin();
    sut.set("u", 3.0);
    sut.set("hold", true); // and so y stays
    ASSERT_TRUE(advance(*sut.instance, sut.can(), "lag", 0, 1));

    EXPECT_EQ(std::get<std::string>(sut.get("label")), "pump 1");
    EXPECT_TRUE(std::get<bool>(sut.get("hold")));
    EXPECT_EQ(sut.number("y"), 0);
    EXPECT_EQ(std::get<std::int64_t>(sut.get("steps")), 1);
}

TEST_P(AnInstance, IsSetBackToTheStateThatWasKept) {
    FmuUnderTest sut{own_fmu("lag", GetParam())};
    sut.begin();
    sut.set("u", 1.0);
    ASSERT_TRUE(advance(*sut.instance, sut.can(), "lag", 0, 1));
    double const y = sut.number("y");
    ASSERT_TRUE(sut.instance->keep_state());
    ASSERT_TRUE(sut.instance->do_step(1, 1, true));
    ASSERT_NE(sut.number("y"), y);

    ASSERT_TRUE(sut.instance->restore_state());

    EXPECT_EQ(sut.number("y"), y);
}

TEST_P(AnInstance, GoesOnWithTheStateOfAnotherThatWasWrittenAsOctets) {
    FmuUnderTest first{own_fmu("lag", GetParam())};
    first.begin();
    first.set("u", 1.0);
    ASSERT_TRUE(advance(*first.instance, first.can(), "lag", 0, 1));
    auto const octets = first.instance->serialize();
    ASSERT_TRUE(octets);
    ASSERT_TRUE(first.instance->do_step(1, 1, false));

    FmuUnderTest sut{own_fmu("lag", GetParam())};
    ASSERT_TRUE(sut.instance->deserialize(*octets));
    ASSERT_TRUE(sut.instance->do_step(1, 1, false));

    EXPECT_EQ(sut.number("y"), first.number("y"));
    EXPECT_FALSE(sut.instance->deserialize({std::byte{1}})); // and not with octets of something else
}

TEST_P(AnInstance, RepeatsADiscardedStepWithSmallerOnesFromTheStateBeforeIt) {
    Misfit sut{GetParam(), kDiscard, 2, 0.3};

    ASSERT_TRUE(sut.advance(0, 1));
    auto const second = sut.advance(1, 1);
    auto const third = sut.advance(2, 1);

    ASSERT_TRUE(second && third);
    EXPECT_EQ(second->discarded, 0); // until then it is content
    EXPECT_EQ(third->discarded, 2);  // 1 s and 0.5 s
    EXPECT_EQ(third->steps, 4);
    EXPECT_NEAR(sut.number("y"), 3, 1e-9);
}

TEST_P(AnInstance, WhoseStepIsDiscardedHoweverSmallEndsWithAMessageThatNamesTheStep) {
    Misfit sut{GetParam(), kDiscard, 2, 1e-6};

    auto const failed = sut.advance(2, 1);

    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, ExitCode::child_died);
    EXPECT_NE(failed.error().message.find("step from 2 s to"), std::string::npos) << failed.error().message;
    EXPECT_NE(failed.error().message.find("was discarded"), std::string::npos) << failed.error().message;
}

TEST_P(AnInstance, ThatCanNotSetItsStateBackFailsAtTheFirstDiscardedStepAndSaysWhatItLacks) {
    Misfit sut{GetParam(), kDiscard, 0, 0.3};
    CoSimulation can = sut.can();
    can.can_get_and_set_state = false;

    auto const failed = advance(*sut.instance, can, "misfit", 0, 1);

    ASSERT_FALSE(failed);
    EXPECT_NE(failed.error().remedy.find("canGetAndSetFMUState"), std::string::npos);
    EXPECT_EQ(sut.host.calls[GetParam() == 2 ? "fmi2DoStep" : "fmi3DoStep"], 1);
}

TEST_P(AnInstance, ThatComesBackEarlyIsAskedToGoOn) {
    Misfit sut{GetParam(), kEarly, 0, 0.4};

    auto const done = sut.advance(0, 1);

    ASSERT_TRUE(done) << done.error().message;
    EXPECT_NEAR(sut.number("y"), 1, 1e-9);
    EXPECT_EQ(done->reached_s, 1);
    EXPECT_EQ(done->discarded, GetParam() == 2 ? 2 : 0); // FMI 2.0 knows no early return: it is a discarded step
}

TEST_P(AnInstance, ThatWantsToEndSaysSo) {
    Misfit sut{GetParam(), kTerminate, 1};

    auto const first = sut.advance(0, 1);
    auto const second = sut.advance(1, 1);

    ASSERT_TRUE(first && second);
    EXPECT_FALSE(first->terminated);
    EXPECT_TRUE(second->terminated);
}

TEST_P(AnInstance, WhoseStepFailsNamesFmuFunctionAndWhatTheFmuSaid) {
    Misfit sut{GetParam(), kError, 1};
    ASSERT_TRUE(sut.advance(0, 1));

    auto const failed = sut.advance(1, 1);

    ASSERT_FALSE(failed);
    EXPECT_EQ(failed.error().code, ExitCode::child_died);
    std::string const function = GetParam() == 2 ? "fmi2DoStep" : "fmi3DoStep";
    for (std::string const& word : {fmt::format("misfit_fmi{}.fmu", GetParam()), function, std::string{"from 1 s"},
                                    std::string{"returned error"}, std::string{"found no solution"}}) {
        EXPECT_NE(failed.error().message.find(word), std::string::npos) << failed.error().message;
    }
    sut.instance.reset();
    EXPECT_EQ(sut.host.calls[GetParam() == 2 ? "fmi2Terminate" : "fmi3Terminate"], 0);
    EXPECT_EQ(sut.host.calls[GetParam() == 2 ? "fmi2FreeInstance" : "fmi3FreeInstance"], 1);
}

TEST_P(AnInstance, IsNotCalledAnyMoreAfterAFatalError) {
    Misfit sut{GetParam(), kFatal, 0};

    ASSERT_FALSE(sut.advance(0, 1));
    int const before = static_cast<int>(sut.host.calls.size());
    sut.instance.reset();

    EXPECT_EQ(static_cast<int>(sut.host.calls.size()), before); // not even to be freed
}

TEST_P(AnInstance, IsTerminatedAndFreedAtTheEnd) {
    FmuUnderTest sut{own_fmu("lag", GetParam())};
    sut.begin();

    sut.instance.reset();

    EXPECT_EQ(sut.host.calls[GetParam() == 2 ? "fmi2Terminate" : "fmi3Terminate"], 1);
    EXPECT_EQ(sut.host.calls[GetParam() == 2 ? "fmi2FreeInstance" : "fmi3FreeInstance"], 1);
}

TEST_P(AnInstance, WithAWarningGoesOnAndTheWarningIsHeard) {
    Misfit sut{GetParam(), kWarning, 0};

    ASSERT_TRUE(sut.advance(0, 1));

    EXPECT_EQ(sut.number("y"), 1);
    ASSERT_EQ(sut.host.said.size(), 1U);
    EXPECT_NE(sut.host.said.front().find("warning"), std::string::npos);
    EXPECT_NE(sut.host.said.front().find("close to the edge"), std::string::npos);
}

TEST_P(AnInstance, IsNotMadeForADescriptionOfAnotherModel) {
    FmuUnderTest sut{own_fmu("lag", GetParam())};
    ModelDescription other = sut.description;
    other.token = "{00000000-0000-0000-0000-000000000000}";
    auto const archive = Archive::open(own_fmu("lag", GetParam()));
    ASSERT_TRUE(archive);

    auto const made = instantiate(other, sut.folder.path(), *binary_of(*archive, other), "other", sut.host);

    ASSERT_FALSE(made);
    EXPECT_NE(made.error().message.find(GetParam() == 2 ? "fmi2Instantiate" : "fmi3InstantiateCoSimulation"),
              std::string::npos);
}

TEST_P(AnInstance, OfAnotherVersionThanItsDescriptionNamesTheFunctionsThatItLacks) {
    FmuUnderTest sut{own_fmu("lag", GetParam())};
    ModelDescription other = sut.description;
    other.version = GetParam() == 2 ? Version::fmi3 : Version::fmi2;
    auto const archive = Archive::open(own_fmu("lag", GetParam()));
    auto const binary = binary_of(*archive, sut.description);

    auto const made = instantiate(other, sut.folder.path(), *binary, "other", sut.host);

    ASSERT_FALSE(made);
    EXPECT_EQ(made.error().code, ExitCode::usage);
    EXPECT_NE(made.error().message.find(GetParam() == 2 ? "fmi3Instantiate" : "fmi2Instantiate"), std::string::npos)
        << made.error().message;
}

} // namespace
} // namespace gridspace::fmi
