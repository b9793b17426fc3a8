// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/comtrade/comtrade_record.hpp"
#include "common/comtrade/comtrade_writer.hpp"
#include "tests/support/temporary_folder.hpp"

#include <cmath>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>

namespace gridspace {
namespace {

constexpr std::int64_t kEpochNs = 1'575'158'400'000'000'000; // 2019-12-01T00:00:00Z

class Comtrade : public ::testing::Test {
  protected:
    static std::string text_of(std::filesystem::path const& file) {
        std::ifstream stream{file, std::ios::binary};
        return {std::istreambuf_iterator<char>{stream}, {}};
    }

    /// Two rows at 4800 Hz that begin 0.7 us before a minute ends: a clock that rounds shows second 60.
    static ComtradeRecord record() {
        ComtradeRecord out;
        out.header.station = "a,b";
        out.header.device = "relay2";
        out.header.sample_rate_hz = 4800;
        out.header.start_unix_ns = kEpochNs + 59'999'999'300;
        out.header.trigger_unix_ns = kEpochNs + 60'000'207'600;
        out.header.analog = {{"CT21 Ia", "A", "A", "CT21"}, {"B1 Va", "A", "V", "B1"}};
        out.analog = {{-100, 50}, {0, std::nan("")}};
        for (int n = 0; n < 17; ++n) {
            out.header.digital.push_back({"d" + std::to_string(n), "", ""});
            out.digital.push_back({n == 0 || n == 16, n == 1});
        }
        out.header.digital[0].normally_set = true;
        return out;
    }
    TemporaryFolder temporary_;
    std::filesystem::path folder_{temporary_.path()};
};

TEST_F(Comtrade, TheConfigurationSaysWhatTheStandardAsksFor) {
    ASSERT_TRUE(write_comtrade(folder_ / "r", record(), ComtradeFormat::binary));

    std::string const cfg = text_of(folder_ / "r.cfg");

    EXPECT_TRUE(cfg.starts_with("a_b,relay2,2013\r\n19,2A,17D\r\n1,CT21 Ia,A,CT21,A,")) << cfg;
    EXPECT_NE(
        cfg.find(",0,0,-32767,32767,1,1,P\r\n2,B1 Va,A,B1,V,1,0,0,-32767,32767,1,1,P\r\n1,d0,,,1\r\n2,d1,,,0\r\n"),
        std::string::npos)
        << cfg;
    EXPECT_TRUE(cfg.ends_with("\r\n60\r\n1\r\n4800,2\r\n01/12/2019,00:00:59.999999\r\n01/12/"
                              "2019,00:01:00.000208\r\nBINARY\r\n1\r\n0,0\r\n0,0\r\n"))
        << cfg;
}

TEST_F(Comtrade, AsciiKeepsTheLargestValueAtFullScaleAndMarksWhatIsMissing) {
    ASSERT_TRUE(write_comtrade(folder_ / "r", record(), ComtradeFormat::ascii));

    EXPECT_EQ(text_of(folder_ / "r.dat"), "1,0,-99998,0,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0,1\r\n"
                                          "2,208,49999,99999,0,1,0,0,0,0,0,0,0,0,0,0,0,0,0,0,0\r\n\x1a");
}

TEST_F(Comtrade, BinaryIsLittleEndianWithSixteenDigitalsAWord) {
    ASSERT_TRUE(write_comtrade(folder_ / "r", record(), ComtradeFormat::binary));

    using namespace std::string_literals;
    EXPECT_EQ(text_of(folder_ / "r.dat"), "\x01\0\0\0\0\0\0\0\x01\x80\0\0\x01\0\x01\0"
                                          "\x02\0\0\0\xd0\0\0\0\0\x40\0\x80\x02\0\0\0"s);
}

TEST_F(Comtrade, AFolderThatDoesNotExistIsAnErrorThatNamesTheFile) {
    auto const sut = write_comtrade(folder_ / "none" / "r", record(), ComtradeFormat::ascii);

    ASSERT_FALSE(sut);
    EXPECT_NE(sut.error().message.find("none/r.dat"), std::string::npos) << sut.error().message;
}

TEST_F(Comtrade, TheWriterOfLongRunsCountsItsRows) {
    ComtradeHeader header;
    header.sample_rate_hz = 1000;
    header.analog = {{"v", "", "V"}};
    auto sut = ComtradeWriter::create(folder_ / "long.cfg", header);
    ASSERT_TRUE(sut);
    for (int n = 0; n < 3; ++n) {
        double const v = n;
        sut->row({&v, 1}, {});
    }
    ASSERT_TRUE(sut->finish());

    EXPECT_EQ(std::filesystem::file_size(folder_ / "long.dat"), 3U * 12U);
    std::string const cfg = text_of(folder_ / "long.cfg");
    EXPECT_NE(cfg.find("\r\n1000,3\r\n"), std::string::npos) << cfg;
    EXPECT_NE(cfg.find("\r\nFLOAT32\r\n"), std::string::npos) << cfg;
}

} // namespace
} // namespace gridspace
