// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/closed_folder.hpp"

#include "launcher/folder/write_file.hpp"
#include "tests/support/temporary_folder.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <sys/stat.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

std::string text_of(fs::path const& file) {
    std::ifstream stream{file};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

/// A run's folder, and beside it what is none of its business.
struct ClosedFolder : testing::Test {
    ClosedFolder() {
        fs::create_directories(run / "report");
        std::ofstream{run / "manifest.json"} << "{}";
        std::ofstream{outside} << "mine";
    }
    [[nodiscard]] std::string refusal() const {
        auto const ok = check_closed(run);
        return ok ? "" : describe(ok.error());
    }
    TemporaryFolder const folder;
    fs::path const run{folder.path() / "run"}, outside{folder.path() / "outside"};
};

TEST_F(ClosedFolder, IsOneWithFilesAndFolders) {
    EXPECT_EQ(refusal(), "");
}

TEST_F(ClosedFolder, MayHaveALinkThatStaysInside) {
    fs::create_symlink("../manifest.json", run / "report" / "copy.json");
    EXPECT_EQ(refusal(), "");
}

TEST_F(ClosedFolder, IsNotOneWithALinkToAFileElsewhere) {
    fs::create_symlink(outside, run / "report" / "index.html");
    EXPECT_THAT(refusal(), HasSubstr("report/index.html' is a symbolic link to '" + outside.string()));
}

TEST_F(ClosedFolder, IsNotOneWithALinkToAFolderElsewhere) {
    fs::create_directory_symlink("../..", run / "csv");
    EXPECT_THAT(refusal(), HasSubstr("csv' is a symbolic link to '../..'"));
}

TEST_F(ClosedFolder, IsNotOneWithALinkThatAWriteWouldMakeAFileOf) {
    fs::create_symlink(folder.path() / "not_there_yet", run / "report" / "index.html");
    EXPECT_THAT(refusal(), HasSubstr("is a symbolic link"));
}

TEST_F(ClosedFolder, IsNotOneWithAPipeAtWhichAReaderWouldWait) {
    ASSERT_EQ(::mkfifo((run / "data.mcap").c_str(), 0600), 0);
    EXPECT_THAT(refusal(), HasSubstr("data.mcap' is a pipe or a device"));
}

TEST_F(ClosedFolder, IsFoundAlsoBehindTheLinkLatest) {
    fs::create_directory_symlink("run", folder.path() / "latest");
    EXPECT_TRUE(check_closed(folder.path() / "latest"));
}

TEST_F(ClosedFolder, AFileThatIsReplacedIsNeverWrittenThroughALinkOrAnotherName) {
    fs::create_symlink(outside, run / "soft");
    fs::create_hard_link(outside, run / "hard");
    fs::create_symlink(outside, run / "soft.new");
    for (char const* name : {"soft", "hard"}) {
        ASSERT_TRUE(replace_file(run / name, "new"));
        EXPECT_EQ(text_of(run / name), "new");
    }
    EXPECT_EQ(text_of(outside), "mine");
}

TEST_F(ClosedFolder, AFileThatCannotBeReplacedStaysAsItIs) {
    auto const ok = replace_file(run / "report" / "none" / "x", "new");
    ASSERT_FALSE(ok);
    EXPECT_THAT(describe(ok.error()), HasSubstr("No such file or directory"));
}

} // namespace
} // namespace gridspace::launcher
