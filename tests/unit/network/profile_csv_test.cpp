// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/profile/profile_csv.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

namespace gridspace::sim {
namespace {

using ::testing::AllOf;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

class ProfileCsv : public ::testing::Test {
  protected:
    Result<ProfilePoints> read(std::string_view text) {
        std::ofstream{file_, std::ios::binary} << text;
        return read_profile_csv(file_, "load");
    }
    std::string mistake(std::string_view text) {
        auto const read_text = read(text);
        return read_text ? "valid" : describe(read_text.error());
    }
    void TearDown() override { std::filesystem::remove(file_); }

    std::filesystem::path file_{
        std::filesystem::path{::testing::TempDir()} /
        (std::string{::testing::UnitTest::GetInstance()->current_test_info()->name()} + "_profile.csv")};
};

TEST_F(ProfileCsv, HasATimeUnderAnyOfItsNamesAndAColumn) {
    for (std::string const time : {"hours", "h", "time_h"}) {
        auto const sut = read("other," + time + ", load\r\n9,0,1.5\r\n\r\n9,0.5,-2e-1\r\n");
        ASSERT_TRUE(sut) << sut.error().message;
        EXPECT_THAT(sut->hours, ElementsAre(0, 0.5));
        EXPECT_THAT(sut->values, ElementsAre(1.5, -0.2));
    }
}

TEST_F(ProfileCsv, MayBeginWithTheMarkOfASpreadsheet) {
    auto const sut = read("\xEF\xBB\xBFhours,load\n0,1\n");
    ASSERT_TRUE(sut) << sut.error().message;
    EXPECT_THAT(sut->values, ElementsAre(1));
}

TEST_F(ProfileCsv, RefusesWhatIsNoNumberAndNamesItsLine) {
    for (std::string const cell : {"nan", "inf", "-inf", "1e999", "x", "", "1;5"}) {
        EXPECT_THAT(mistake("hours,load\n0,1\n1," + cell + "\n"),
                    AllOf(HasSubstr("_profile.csv:3: column 'load' is '" + cell + "'"), HasSubstr("finite")));
        EXPECT_THAT(mistake("hours,load\n" + cell + ",1\n"), HasSubstr(":2: column 'hours' is '" + cell + "'"));
    }
    EXPECT_THAT(mistake("hours,load\n0\n"), HasSubstr(":2: column 'load' is ''"));
}

TEST_F(ProfileCsv, NeedsARow) {
    EXPECT_THAT(mistake("hours,load\n"), HasSubstr("has a header and no rows"));
    EXPECT_THAT(mistake("hours,load\n\n \n"), HasSubstr("has a header and no rows"));
    EXPECT_THAT(mistake(""), HasSubstr("cannot read the profile"));
}

TEST_F(ProfileCsv, NeedsColumnsThatAreNotAmbiguous) {
    EXPECT_THAT(mistake("hours,load,load\n0,1,2\n"), HasSubstr("has two columns 'load'"));
    EXPECT_THAT(mistake("hours,load,h\n0,1,2\n"), HasSubstr("has a column 'hours' and a column 'h'"));
    EXPECT_THAT(mistake("time,load\n0,1\n"),
                AllOf(HasSubstr("has no column 'hours' (or 'h', 'time_h')"), HasSubstr("its columns are time, load")));
    EXPECT_THAT(mistake("hours,laod\n0,1\n"), HasSubstr("has no column 'load'"));
}

TEST_F(ProfileCsv, NamesTheLineWhereTimeDoesNotIncrease) {
    EXPECT_THAT(mistake("hours,load\n0,1\n\n2,1\n2,3\n"), HasSubstr("_profile.csv:5: 2 h comes after 2 h"));
    EXPECT_THAT(mistake("hours,load\n0,1\n0,1\n"), HasSubstr(":3: 0 h comes after 0 h"));
}

} // namespace
} // namespace gridspace::sim
