// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/participant.hpp"
#include "bus/send_together.hpp"
#include "common/source_tree.hpp"
#include "tests/integration/veth/veth.hpp"

#include <atomic>
#include <thread>

namespace gridspace::bus {
namespace {

class Cork : public ethernet::Veth {
  protected:
    static std::unique_ptr<Participant> join(std::string const& name) {
        auto joined =
            Participant::create({name, 0, "test", 0, source_tree("qos/member.xml"), "management", {"127.0.0.1"}});
        EXPECT_TRUE(joined);
        return joined ? std::move(*joined) : nullptr;
    }
    template <class Done>
    static bool wait_until(Done const& done) {
        auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{60};
        while (!done() && std::chrono::steady_clock::now() < hang) {
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        return done();
    }
};

TEST_F(Cork, WhatLeavesTogetherOutlivesItsWriterAndGoesBeforeTheFarewell) {
    auto const listener = join("listener");
    auto sut = join("sut");
    ASSERT_TRUE(listener && sut);
    std::atomic<int> heard{0};
    std::atomic<bool> clean{false};
    listener->on_departure([&](std::uint32_t, bool said_goodbye) { clean = said_goodbye; });
    auto const reader = listener->create_reader("x", {.type_name = "X"}, [&](auto, SampleHeader const&) { ++heard; });
    auto writer = sut->create_writer("x", {.type_name = "X"});
    ASSERT_TRUE(reader && writer);
    ASSERT_TRUE(wait_until([&] { return !(*reader)->matched().empty() && !(*writer)->matched().empty(); }));
    {
        SendTogether const together;
        ASSERT_TRUE((*writer)->write_cdr(std::vector<std::byte>(8), std::nullopt));
        writer->reset(); // what is held does not need it any more
    }
    sut.reset();
    EXPECT_TRUE(wait_until([&] { return heard == 1 && clean; }));
}

} // namespace
} // namespace gridspace::bus
