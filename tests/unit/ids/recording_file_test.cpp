// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "ids/data/recording_file.hpp"

#include <gtest/gtest.h>

#include <cmath>
#include <cstring>
#include <fstream>

namespace gridspace::ids {
namespace {

class RecordingFile : public testing::Test {
  protected:
    std::filesystem::path write(std::string const& name, std::string const& text) {
        std::filesystem::path const file = std::filesystem::path{testing::TempDir()} /
                                           ("gridspace_recording_" + std::to_string(::getpid()) + "_" + name);
        std::ofstream{file, std::ios::binary} << text;
        written_.push_back(file);
        return file;
    }
    void TearDown() override {
        for (auto const& file : written_) {
            std::filesystem::remove(file);
        }
    }
    std::string error_of(std::filesystem::path const& file, RecordingOptions const& options = {}) {
        auto const r = read_recording(file, options);
        EXPECT_FALSE(r);
        return r ? "" : r.error().message;
    }
    std::vector<std::filesystem::path> written_;
};

TEST_F(RecordingFile, ReadsThreeAndSixColumnsOfCsv) {
    auto const three = read_recording(
        write("3.csv", "# a comment\ntime_s, ia, ib, ic\n0, 1, 2, 3\n0.000208333, 4, nan, 6\n0.000416667,7,8,9\n"), {});
    ASSERT_TRUE(three) << three.error().message;
    EXPECT_EQ(three->rate_hz, 4800);
    ASSERT_EQ(three->size(), 3U);
    EXPECT_TRUE(three->to.empty());
    EXPECT_EQ(three->from[2], (Abc{7, 8, 9}));
    EXPECT_TRUE(std::isnan(three->from[1][1]));
    auto const six = read_recording(write("6.csv", "t;a;b;c;d;e;f\r\n0;1;2;3;4;5;6\r\n0.00025;1;2;3;4;5;6.5\r\n"),
                                    {{}, 50, 0.00025});
    ASSERT_TRUE(six) << six.error().message;
    EXPECT_EQ(six->rate_hz, 4000);
    EXPECT_EQ(six->to[1], (Abc{4, 5, 6.5}));
    EXPECT_EQ(six->event, 1);
}

TEST_F(RecordingFile, NamesTheLineOfAMistake) {
    EXPECT_NE(error_of(write("a.csv", "t,a,b,c\n0,1,2,3\n1,2,x,4\n")).find("a.csv:3: column 3: 'x' is not a number"),
              std::string::npos);
    EXPECT_NE(error_of(write("b.csv", "t,a,b\n0,1,2\n")).find("b.csv:1: 3 columns"), std::string::npos);
    EXPECT_NE(error_of(write("c.csv", "t,a,b,c\n0,1,2,3\n0,1,2,3\n")).find("c.csv:3: time 0 s after 0 s"),
              std::string::npos);
    EXPECT_NE(error_of(write("d.csv", "t,a,b,c\n0,1,2,3\n1,2,3\n")).find("d.csv:3: 3 columns"), std::string::npos);
    EXPECT_NE(error_of(write("e.csv", "0,1,2,3\n1,2,3,4\n")).find("e.csv:1: the first row holds numbers"),
              std::string::npos);
    EXPECT_NE(error_of(write("f.csv", "")).find("0 samples"), std::string::npos);
    EXPECT_NE(error_of("/nonexistent.csv").find("no such file"), std::string::npos);
}

std::string npy(std::string const& header, std::vector<double> const& values) {
    std::string out = std::string{"\x93NUMPY\x01\x00", 8};
    out += static_cast<char>(header.size());
    out += '\0';
    out += header;
    for (double const v : values) {
        char bytes[8];
        std::memcpy(bytes, &v, 8);
        out.append(bytes, 8);
    }
    return out;
}

TEST_F(RecordingFile, ReadsNpyAndRefusesOthers) {
    std::string const header = "{'descr': '<f8', 'fortran_order': False, 'shape': (2, 3), }\n";
    RecordingOptions options;
    options.rate_hz = 4800;
    auto const r = read_recording(write("a.npy", npy(header, {1, 2, 3, 4, 5, 6})), options);
    ASSERT_TRUE(r) << r.error().message;
    EXPECT_EQ(r->from[1], (Abc{4, 5, 6}));
    EXPECT_NE(error_of(write("b.npy", npy(header, {1, 2, 3, 4, 5, 6})), {}).find("sampling rate"), std::string::npos);
    EXPECT_NE(error_of(write("c.npy", npy(header, {1, 2, 3, 4, 5})), options).find("40 bytes of data"),
              std::string::npos);
    EXPECT_NE(error_of(write("d.npy", npy("{'descr': '<i4', 'fortran_order': False, 'shape': (2, 3), }", {})), options)
                  .find("float32"),
              std::string::npos);
    EXPECT_NE(error_of(write("e.npy", npy("{'descr': '<f8', 'fortran_order': True, 'shape': (2, 3), }", {})), options)
                  .find("columns"),
              std::string::npos);
    EXPECT_NE(
        error_of(write("f.npy", npy("{'descr': '<f8', 'fortran_order': False, 'shape': (99999999999999, 3), }", {})),
                 options)
            .find("bytes"),
        std::string::npos);
    EXPECT_NE(error_of(write("g.npy", "hello, this is text"), options).find("not an npy"), std::string::npos);
}

} // namespace
} // namespace gridspace::ids
