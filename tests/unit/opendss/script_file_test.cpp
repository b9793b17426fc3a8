// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/opendss_file.hpp"

#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

/// Which files a script may read.
namespace gridspace::opendss {
namespace {

namespace fs = std::filesystem;

class ScriptFiles : public testing::Test {
  protected:
    ScriptFiles() {
        std::string name = (fs::temp_directory_path() / "gridspace-XXXXXX").string();
        root_ = ::mkdtemp(name.data());
        for (char const* file : {"feeder/codes.dss", "codes.dss", "codes.key", "other/codes.dss"}) {
            write(file, "New LineCode.c nphases=1 r1=1 x1=1 r0=1 x0=1\n");
        }
    }
    ~ScriptFiles() override { fs::remove_all(root_); }
    void write(fs::path const& file, std::string const& text) const {
        fs::create_directories((root_ / file).parent_path());
        std::ofstream{root_ / file} << text;
    }
    /// What is said of a circuit that reads this file; empty: nothing.
    [[nodiscard]] std::string said_of(std::string const& file, std::vector<fs::path> const& folders = {}) const {
        write("feeder/main.dss", "New Circuit.c basekv=0.4\nRedirect " + file +
                                     "\nNew Line.l bus1=sourcebus.1 bus2=b.1 phases=1 linecode=c\n");
        config::Diagnostics diagnostics;
        bool const loaded = load_circuit(root_ / "feeder/main.dss", {folders, {}, {}}, diagnostics).has_value();
        EXPECT_EQ(loaded, diagnostics.render().find("error") == std::string::npos);
        return diagnostics.render();
    }
    fs::path root_;
};

TEST_F(ScriptFiles, ThoseOfItsFolderAndScriptsBesideItAreRead) {
    EXPECT_EQ(said_of("codes.dss"), "");
    EXPECT_EQ(said_of("..\\Codes.DSS"), "");
}

TEST_F(ScriptFiles, NothingElseOutsideIsRead) {
    for (char const* file : {"../codes.key", "../other/codes.dss", "/etc/hostname"}) {
        EXPECT_THAT(said_of(file), testing::HasSubstr("lies outside the script's folder")) << file;
    }
    EXPECT_EQ(said_of("../other/codes.dss", {root_ / "other"}), "") << "its folder is named";
    fs::create_symlink(root_ / "codes.key", root_ / "feeder/link.dss");
    EXPECT_THAT(said_of("link.dss"), testing::HasSubstr("lies outside the script's folder"));
}

} // namespace
} // namespace gridspace::opendss
