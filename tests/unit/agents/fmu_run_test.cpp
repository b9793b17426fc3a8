// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/model_run.hpp"

#include "agents/fmu/unpacked_fmu.hpp"
#include "common/source_tree.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>

namespace gridspace::agents {
namespace {

using ::testing::HasSubstr;

constexpr double kTau = 10;

/// The lag of the example with an input of 1 kW, a period of a second, in a folder of its own.
class ALag : public ::testing::TestWithParam<int> {
  protected:
    void SetUp() override {
        before_ = std::filesystem::current_path();
        std::filesystem::current_path(folder_.path()); // the FMU is unpacked where the process runs
        config_.period_s = Rational{1};
        guard_ = std::make_unique<CallGuard>("lag", -1);
        auto unpacked = UnpackedFmu::open(build_tree(fmt::format("tests/fmus/lag_fmi{}.fmu", GetParam())), "lag");
        ASSERT_TRUE(unpacked) << unpacked.error().message;
        unpacked_ = std::move(*unpacked);
        config_.start = config::Node::map();
        config_.start.set("u", config::Node::scalar("1"));
        config_.watch = {{"y", {}}};
        config::Diagnostics diagnostics;
        table_ = make_table(config_, unpacked_->description(), "lag", {}, diagnostics);
        ASSERT_TRUE(diagnostics.ok()) << diagnostics.render();
    }
    void TearDown() override { std::filesystem::current_path(before_); }

    ModelRun make(bool keeps_state) {
        auto instance = unpacked_->instantiate("lag", *guard_);
        EXPECT_TRUE(instance) << instance.error().message;
        return ModelRun{{config_, table_, unpacked_->description(), base_, second_, keeps_state ? "lag.fmu_state" : ""},
                        std::move(*instance),
                        *guard_};
    }
    SimTime at(std::int64_t seconds) const { return SimTime{} + SimSpan{second_.quanta * seconds}; }
    double y(ModelRun const& run) const { return run.values()[table_.watched.front()].number(); }
    static double theory(double t) { return 1 - std::exp(-t / kTau); }

    TemporaryFolder folder_;
    std::filesystem::path before_;
    TimeBase base_{Rational{1, 10}};
    SimSpan second_{10};
    FmuConfig config_;
    FmuTable table_;
    std::unique_ptr<CallGuard> guard_;
    std::unique_ptr<UnpackedFmu> unpacked_;
};
INSTANTIATE_TEST_SUITE_P(Fmi, ALag, ::testing::Values(2, 3),
                         [](auto const& of) { return "Fmi" + std::to_string(of.param); });

TEST_P(ALag, StepsFromPointToPoint) {
    ModelRun sut = make(false);
    for (int t = 0; t <= 5; ++t) {
        auto const goes_on = sut.exchange(at(t));
        ASSERT_TRUE(goes_on && *goes_on);
        EXPECT_NEAR(y(sut), theory(t), 1e-12);
    }
}

TEST_P(ALag, BeginsAtItsFirstPointWhateverTimeThatIs) {
    ModelRun sut = make(false);
    ASSERT_TRUE(sut.exchange(at(100)));
    EXPECT_EQ(y(sut), 0);
    ASSERT_TRUE(sut.exchange(at(101)));
    EXPECT_NEAR(y(sut), theory(1), 1e-12);
}

TEST_P(ALag, MakesUpForPointsThatWereLeftOut) {
    ModelRun sut = make(false);
    ASSERT_TRUE(sut.exchange(at(0)));
    ASSERT_TRUE(sut.exchange(at(7)));
    EXPECT_NEAR(y(sut), theory(7), 1e-12);
}

TEST_P(ALag, HoldsAnInputOverTheStepAfterThePointAtWhichItCame) {
    ModelRun sut = make(false);
    ASSERT_TRUE(sut.exchange(at(0)));
    auto const& variables = unpacked_->description().variables;
    std::size_t const u = static_cast<std::size_t>(unpacked_->description().find("u") - variables.data());
    sut.input(u, 3.0);
    ASSERT_TRUE(sut.exchange(at(1)));
    EXPECT_NEAR(y(sut), theory(1), 1e-12) << "the step before was with the old one";
    ASSERT_TRUE(sut.exchange(at(2)));
    EXPECT_NEAR(y(sut), 3 + (theory(1) - 3) * std::exp(-1 / kTau), 1e-12);
}

TEST_P(ALag, ResumesWithTheStateOfAnEarlierProcess) {
    {
        ModelRun first = make(true);
        ASSERT_TRUE(first.exchange(at(0)));
        ASSERT_TRUE(first.exchange(at(4)));
    }
    ModelRun sut = make(true);

    auto const resumed = sut.resume();

    ASSERT_TRUE(resumed) << resumed.error().message;
    EXPECT_TRUE(*resumed);
    ASSERT_TRUE(sut.exchange(at(6)));
    EXPECT_NEAR(y(sut), theory(6), 1e-12);
}

TEST_P(ALag, WithoutAStateOfAnEarlierProcessBeginsAnew) {
    ModelRun sut = make(true);
    auto const resumed = sut.resume();
    ASSERT_TRUE(resumed);
    EXPECT_FALSE(*resumed);
}

TEST_P(ALag, RefusesAStateThatIsDamaged) {
    {
        ModelRun first = make(true);
        ASSERT_TRUE(first.exchange(at(0)));
    }
    std::filesystem::resize_file("lag.fmu_state", std::filesystem::file_size("lag.fmu_state") - 1);
    ModelRun sut = make(true);

    auto const resumed = sut.resume();

    ASSERT_FALSE(resumed);
    EXPECT_EQ(resumed.error().code, ExitCode::environment);
    EXPECT_THAT(resumed.error().message, HasSubstr("'lag.fmu_state' is no state of an FMU, or damaged"));
}

TEST_P(ALag, LeavesNothingUnpackedBehind) {
    EXPECT_TRUE(std::filesystem::exists(".gridspace-fmu-lag/modelDescription.xml"));
    unpacked_.reset();
    EXPECT_TRUE(std::filesystem::is_empty(folder_.path()));
}

} // namespace
} // namespace gridspace::agents
