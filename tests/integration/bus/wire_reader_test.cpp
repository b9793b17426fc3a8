// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Frames that wait for somebody who does not fetch them, on a bus of their own.
#include "bus/node.hpp"
#include "bus/wire.hpp"
#include "common/source_tree.hpp"
#include "tests/integration/veth/veth.hpp"

#include <fmt/format.h>
#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

constexpr std::size_t kFrame = 100, kFits = 64;

NodeConfig alone() {
    NodeConfig out;
    out.process = "a";
    out.program = "test";
    out.qos = source_tree("qos/gateway.xml");
    out.management = {1, {"127.0.0.1"}};
    out.clock.mode = ClockMode::realtime;
    out.clock.simulator = "";
    return out;
}

class WireReaderTest : public ethernet::Veth {
  protected:
    void SetUp() override {
        Veth::SetUp();
        if (IsSkipped()) {
            return;
        }
        auto node = Node::create(alone());
        ASSERT_TRUE(node) << describe(node.error());
        node_ = std::move(*node);
        sut_ = std::make_unique<WireReader>(*node_, "", 0);
        sut_->bound(kFits * (kFrame + sizeof(WireFrame)));
        auto const started = node_->start();
        ASSERT_TRUE(started) << describe(started.error());
    }
    void TearDown() override {
        sut_.reset();
        node_.reset();
        Veth::TearDown();
    }
    bool push(std::int64_t arrived_ns = 0, std::size_t octets = kFrame) {
        return sut_->push(std::vector<std::byte>(octets), 7, 3, arrived_ns);
    }

    std::unique_ptr<Node> node_;
    std::unique_ptr<WireReader> sut_;
};

TEST_F(WireReaderTest, HandsOnWhenAFrameCame) {
    ASSERT_TRUE(push(11));
    auto const frames = sut_->take();
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(frames[0]->kernel_ns, 7);
    EXPECT_EQ(frames[0]->port, 3U);
    EXPECT_EQ(frames[0]->arrived_ns, 11);
}

TEST_F(WireReaderTest, BeyondItsBoundTheNewestAreDroppedAndCountedAndRoomIsUsedAgain) {
    std::size_t kept = 0;
    for (std::size_t i = 0; i < 10 * kFits; ++i) {
        kept += push(static_cast<std::int64_t>(i)) ? 1 : 0;
    }
    EXPECT_EQ(kept, kFits);
    EXPECT_EQ(sut_->dropped(), 9 * kFits);
    auto const frames = sut_->take();
    ASSERT_EQ(frames.size(), kFits);
    EXPECT_EQ(frames.back()->arrived_ns, static_cast<std::int64_t>(kFits - 1));
    EXPECT_FALSE(push()) << "what was taken is still in use";
    EXPECT_TRUE(sut_->take().empty());
    EXPECT_TRUE(push());
    EXPECT_EQ(sut_->dropped(), 9 * kFits + 1);
}

TEST_F(WireReaderTest, ManySmallFramesCountForTheMemoryThatTheyTake) {
    std::size_t kept = 0;
    while (push(0, 1)) {
        ++kept;
        ASSERT_LT(kept, kFits * kFrame);
    }
    EXPECT_GT(kept, kFits);
}

} // namespace
} // namespace gridspace::bus
