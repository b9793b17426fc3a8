// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/latency_traces.hpp"

#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <iterator>

namespace gridspace::launcher {
namespace {

using testing::ElementsAre;

std::string text_of(std::filesystem::path const& file) {
    std::ifstream in{file};
    return {std::istreambuf_iterator<char>{in}, {}};
}

struct LatencyTraces : testing::Test {
    std::filesystem::path const folder = [] {
        std::string name = (std::filesystem::temp_directory_path() / "gridspace-latency-XXXXXX").string();
        return std::filesystem::path{::mkdtemp(name.data())};
    }();
    ~LatencyTraces() override { std::filesystem::remove_all(folder); }
};

TEST_F(LatencyTraces, HaveALineForEachFrame) {
    SignalStore signals;
    signals["stream.TL_21.wire_delay_ms"] = {"ms", {0, 208'333}, {0.0204, 1.2345}};
    signals["stream.TL_21.publish_age_ms"] = {"ms", {0}, {1.5}};

    auto const files = write_latency_traces(signals, folder / "latency");

    ASSERT_TRUE(files);
    EXPECT_THAT(*files, ElementsAre(folder / "latency/TL_21.csv", folder / "latency/TL_21.svtrace"));
    EXPECT_EQ(text_of(files->front()), "time_s,latency_us\n0.000000000,20.400\n0.000208333,1234.500\n");
    EXPECT_EQ(text_of(files->back()), "20\n1235\n");
}

TEST_F(LatencyTraces, OfAStreamOfWhichNothingIsKnownAreNotWritten) {
    SignalStore signals;
    signals["stream.TL_21.wire_delay_ms"] = {"ms", {}, {}};

    auto const files = write_latency_traces(signals, folder);

    ASSERT_TRUE(files);
    EXPECT_TRUE(files->empty());
}

TEST_F(LatencyTraces, ANameOfAStreamLeadsNowhere) {
    SignalStore signals;
    signals["stream.../../up.wire_delay_ms"] = {"ms", {0}, {1}};

    auto const files = write_latency_traces(signals, folder);

    ASSERT_TRUE(files);
    EXPECT_EQ(files->front(), folder / ".._.._up.csv");
}

} // namespace
} // namespace gridspace::launcher
