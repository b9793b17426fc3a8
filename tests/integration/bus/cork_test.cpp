// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/participant.hpp"
#include "bus/send_together.hpp"
#include "common/source_tree.hpp"
#include "tests/integration/veth/veth.hpp"

#include <atomic>
#include <map>
#include <mutex>
#include <thread>
#include <vector>

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

TEST_F(Cork, EachDestinationHearsAllOfItsTopicsInTheirOrderAlsoOfMoreThanADatagramTakes) {
    constexpr std::size_t kSamples = 40, kOctets = 600; // 24 kB of each topic
    auto const both = join("both"), one = join("one"), sut = join("sut");
    ASSERT_TRUE(both && one && sut);
    std::mutex mutex;
    std::map<std::string, std::vector<int>> heard;
    auto const listen = [&](Participant& participant, std::string const& topic, std::string const& as) {
        return participant.create_reader(topic, {.type_name = "X"}, [&, as](auto cdr, SampleHeader const&) {
            std::lock_guard const lock{mutex};
            heard[as].push_back(std::to_integer<int>(cdr[4])); // behind the encapsulation
        });
    };
    auto const x_of_both = listen(*both, "x", "x of both"), y_of_both = listen(*both, "y", "y of both"),
               x_of_one = listen(*one, "x", "x of one");
    auto const x = sut->create_writer("x", {.type_name = "X"}), y = sut->create_writer("y", {.type_name = "X"});
    ASSERT_TRUE(x_of_both && y_of_both && x_of_one && x && y);
    ASSERT_TRUE(wait_until([&] {
        return (*x)->matched().size() == 2 && (*y)->matched().size() == 1 && !(*x_of_both)->matched().empty() &&
               !(*y_of_both)->matched().empty() && !(*x_of_one)->matched().empty();
    }));
    std::vector<int> all;
    {
        SendTogether const together;
        for (std::size_t i = 0; i < kSamples; ++i) {
            std::vector<std::byte> sample(kOctets);
            sample[4] = static_cast<std::byte>(i);
            all.push_back(static_cast<int>(i));
            ASSERT_TRUE((*x)->write_cdr(sample, std::nullopt));
            ASSERT_TRUE((*y)->write_cdr(sample, std::nullopt));
        }
    }
    EXPECT_TRUE(wait_until([&] {
        std::lock_guard const lock{mutex};
        return heard["x of both"].size() == kSamples && heard["y of both"].size() == kSamples &&
               heard["x of one"].size() == kSamples;
    }));
    std::lock_guard const lock{mutex};
    EXPECT_EQ(heard["x of both"], all);
    EXPECT_EQ(heard["y of both"], all);
    EXPECT_EQ(heard["x of one"], all);
}

} // namespace
} // namespace gridspace::bus
