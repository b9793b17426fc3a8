// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A capture in real time whose disk hangs: nobody takes what is captured.
#include "common/source_tree.hpp"
#include "recorder/app/frame_capture.hpp"
#include "tests/integration/veth/veth.hpp"

#include <filesystem>
#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

namespace gridspace::recorder {
namespace {

constexpr std::size_t kOctets = 1500, kMax = 32U << 20U;

class FrameCaptureTest : public ethernet::Veth {
  protected:
    void TearDown() override {
        std::filesystem::remove(file_);
        Veth::TearDown();
    }
    std::filesystem::path file_{fmt::format("{}/gridspace-{}.pcapng", testing::TempDir(), ::getpid())};
};

TEST_F(FrameCaptureTest, KeepsSoMuchOfWhatADiskThatHangsDoesNotTakeAndCountsTheRest) {
    bus::NodeConfig alone;
    alone.process = "recorder";
    alone.program = "test";
    alone.qos = source_tree("qos/recorder.xml");
    alone.management = {1, {"127.0.0.1"}};
    alone.clock.mode = bus::ClockMode::realtime;
    alone.clock.simulator = "";
    auto node = bus::Node::create(alone);
    ASSERT_TRUE(node) << describe(node.error());
    CaptureConfig config;
    config.file = file_;
    config.ports.push_back(
        {.name = "right", .description = "", .interface = "right", .host = "", .link = "", .link_out = ""});
    auto sut = FrameCapture::open(**node, config);
    ASSERT_TRUE(sut) << describe(sut.error());
    auto const started = (*node)->start();
    ASSERT_TRUE(started) << describe(started.error());
    auto sender = ethernet::Port::open({.interface = "left", .filter = {}, .receive = false});
    ASSERT_TRUE(sender) << describe(sender.error());

    std::vector<std::uint8_t> frame(kOctets, 0xFF); // a broadcast
    frame[12] = 0x88;
    frame[13] = 0xB5; // experimental
    for (std::size_t i = 0; i < 2 * kMax / kOctets; ++i) {
        while (!sender->send(frame)) {
        }
        if (i % 1024 == 1023) { // the capturing thread keeps up, the disk does not
            ::usleep(1000);
        }
    }
    (*sut)->take_due();
    ASSERT_TRUE((*sut)->write_taken()); // the disk works again: what was kept
    ASSERT_TRUE((*sut)->close());
    EXPECT_GT((*sut)->dropped(), 0U);
    EXPECT_LT(std::filesystem::file_size(file_), kMax + kMax / 8) << "with what the file says about each frame";
}

} // namespace
} // namespace gridspace::recorder
