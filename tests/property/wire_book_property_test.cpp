// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Frames, ledgers, evictions and incarnations of several channels in any order: no buffer is lost, in two places, or at
// another channel, and what is announced becomes due once, whatever strangers send.
#include "bus/lockstep/wire_book.hpp"

#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <rapidcheck.h>
#include <set>

namespace gridspace::lockstep {
namespace {

constexpr std::size_t kChannels = 3, kProcesses = 2, kBound = 8;
constexpr std::uint64_t kStranger = 0x020000000099;

/// A frame says on which channel it is; `number` is what is in it. Even numbers come from addresses of the run.
std::vector<std::byte> octets_of(std::size_t channel, std::uint8_t number) {
    std::uint64_t const source = number % 2 == 0 ? (kRunAddressPrefix << 24U) + number : kStranger;
    std::vector<std::byte> out(6);
    for (int shift = 40; shift >= 0; shift -= 8) {
        out.push_back(static_cast<std::byte>(source >> shift));
    }
    for (std::uint8_t const octet :
         {std::uint8_t{0x88}, std::uint8_t{0xba}, static_cast<std::uint8_t>(channel), number}) {
        out.push_back(std::byte{octet});
    }
    return out;
}
std::size_t channel_of(WireFrame const& frame) {
    return static_cast<std::size_t>(frame.octets[14]);
}
std::uint64_t identity(std::size_t channel, std::uint8_t number) {
    return frame_identity(octets_of(channel, number));
}

/// The readers of a process, as bus/wire.cpp has them.
struct Readers {
    WireBook book{kProcesses, {{"a", 0x88ba}, {"a", 0x88b8}, {"b", 0x88ba}}, kBound};
    std::array<std::vector<FrameBuffer>, kChannels> free, due;
    std::array<std::set<WireFrame const*>, kChannels> made;

    void arrive(std::size_t channel, std::uint8_t number) {
        if (free[channel].empty()) {
            free[channel].push_back(std::make_unique<WireFrame>());
            made[channel].insert(free[channel].back().get());
        }
        FrameBuffer frame = std::move(free[channel].back());
        free[channel].pop_back();
        frame->octets = octets_of(channel, number);
        auto arrival = book.arrived(channel, std::move(frame));
        if (arrival.evicted != nullptr) {
            RC_ASSERT(channel_of(*arrival.evicted) == channel);
            free[channel].push_back(std::move(arrival.evicted));
        }
        if (arrival.due != nullptr) {
            RC_ASSERT(arrival.due->octets == octets_of(channel, number));
            due[channel].push_back(std::move(arrival.due));
        }
    }
    void announce(std::size_t process, std::uint32_t incarnation, std::size_t channel, std::uint8_t number) {
        WireBook::Record const record{number, identity(channel, number)};
        book.announced(process, incarnation, channel, {&record, 1}, [&](FrameBuffer frame, std::int64_t) {
            RC_ASSERT(frame->octets == octets_of(channel, number));
            due[channel].push_back(std::move(frame));
        });
    }
    void take(std::size_t channel) {
        std::move(due[channel].begin(), due[channel].end(), std::back_inserter(free[channel]));
        due[channel].clear();
    }
    void every_buffer_is_in_one_place_of_its_channel() const {
        for (std::size_t c = 0; c < kChannels; ++c) {
            std::set<WireFrame const*> seen;
            for (auto const* const place : {&free[c], &due[c]}) {
                for (FrameBuffer const& frame : *place) {
                    RC_ASSERT(made[c].contains(frame.get()));
                    RC_ASSERT(seen.insert(frame.get()).second);
                }
            }
            RC_ASSERT(seen.size() + book.unannounced(c) == made[c].size());
            RC_ASSERT(book.unannounced(c) <= kBound);
        }
    }
};

TEST(WireBookProperty, ABufferIsAlwaysInOnePlaceOfItsChannel) {
    EXPECT_TRUE(rc::check("buffers", [] {
        Readers sut;
        auto const steps = *rc::gen::inRange(0, 200);
        for (int i = 0; i < steps; ++i) {
            auto const channel = *rc::gen::inRange<std::size_t>(0, kChannels);
            auto const number = *rc::gen::inRange<std::uint8_t>(0, 12);
            auto const what = *rc::gen::inRange(0, 10);
            if (what < 6) {
                sut.arrive(channel, number);
            } else if (what < 9) {
                sut.announce(*rc::gen::inRange<std::size_t>(0, kProcesses), *rc::gen::inRange<std::uint32_t>(0, 3),
                             channel, number);
            } else {
                sut.take(channel);
            }
            sut.every_buffer_is_in_one_place_of_its_channel();
        }
    }));
}

TEST(WireBookProperty, WhatIsAnnouncedBecomesDueOnceWhateverStrangersSendBetween) {
    EXPECT_TRUE(rc::check("strangers", [] {
        // Frame and ledger of each number come in either order; a stranger's frames in between.
        constexpr std::uint8_t kFrames = 4; // of the run, even numbers: at most so many wait, less than the bound
        Readers sut;
        std::vector<std::pair<bool, std::uint8_t>> events; // (is a ledger, number)
        for (std::uint8_t n = 0; n < kFrames; ++n) {
            events.emplace_back(false, static_cast<std::uint8_t>(2 * n));
            events.emplace_back(true, static_cast<std::uint8_t>(2 * n));
        }
        for (std::size_t i = events.size(); i > 1; --i) {
            std::swap(events[i - 1], events[*rc::gen::inRange<std::size_t>(0, i)]);
        }
        auto const channel = *rc::gen::inRange<std::size_t>(0, kChannels);
        std::uint64_t strangers = 0;
        for (auto const& [is_ledger, number] : events) {
            auto const flood = *rc::gen::inRange<int>(0, 3 * static_cast<int>(kBound));
            for (int i = 0; i < flood; ++i) {
                sut.arrive(channel, static_cast<std::uint8_t>(2 * (i % 100) + 1));
            }
            strangers += static_cast<std::uint64_t>(flood);
            if (is_ledger) {
                sut.announce(0, 0, channel, number);
            } else {
                sut.arrive(channel, number);
            }
        }
        RC_ASSERT(sut.book.complete(0));
        RC_ASSERT(sut.due[channel].size() == kFrames);
        RC_ASSERT(sut.book.foreign(channel).total() == strangers);
        RC_ASSERT(sut.book.foreign(channel).named().size() <= 1U);
    }));
}

} // namespace
} // namespace gridspace::lockstep
