// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What must hold of the ledger and the barrier whatever the network does with the order of things.
#include "bus/lockstep/barrier.hpp"
#include "bus/lockstep/ledger_book.hpp"

#include <algorithm>
#include <gtest/gtest.h>
#include <rapidcheck.h>

namespace gridspace::lockstep {
namespace {

using Arrival = LedgerBook::Arrival;

/// DDS keeps the order within a writer, not across writers: any interleaving of the writers' sequences.
std::vector<std::uint32_t> interleaving(std::vector<std::uint32_t> const& lengths) {
    std::vector<std::uint32_t> order;
    for (std::uint32_t writer = 0; writer < lengths.size(); ++writer) {
        order.insert(order.end(), lengths[writer], writer);
    }
    for (std::size_t i = order.size(); i > 1; --i) {
        std::swap(order[i - 1], order[*rc::gen::inRange<std::size_t>(0, i)]);
    }
    return order;
}

bool holds(std::string const& what, std::function<void()> const& property) {
    return rc::check(what, property);
}

TEST(LedgerProperty, IsCompleteExactlyWhenAllThatWasAnnouncedHasArrived) {
    EXPECT_TRUE(holds("complete <=> arrived", [] {
        auto const lengths = *rc::gen::container<std::vector<std::uint32_t>>(*rc::gen::inRange<std::size_t>(1, 4),
                                                                             rc::gen::inRange<std::uint32_t>(0, 6));
        std::uint64_t total = 0;
        for (std::uint32_t const n : lengths) {
            total += n;
        }
        auto const order = interleaving(lengths);
        std::size_t const announced_at = *rc::gen::inRange<std::size_t>(0, order.size() + 1);
        LedgerBook sut{{"a", "b"}, {"t"}};
        std::vector<std::uint64_t> sequence(lengths.size(), 0);
        std::uint64_t arrived = 0;
        for (std::size_t i = 0; i <= order.size(); ++i) {
            if (i == announced_at) {
                sut.announced(0, 0, "t", total);
            }
            bool const expected = i < announced_at || arrived == total; // nothing announced yet, or everything here
            RC_ASSERT(sut.complete(0) == expected);
            RC_ASSERT(sut.missing(0).empty() == expected);
            RC_ASSERT(sut.complete(1));
            if (i < order.size()) {
                RC_ASSERT(sut.arrived(0, 0, 0, order[i], ++sequence[order[i]]) == Arrival::expected);
                ++arrived;
            }
        }
    }));
}

TEST(LedgerProperty, RepeatedSamplesNeverCountTwice) {
    EXPECT_TRUE(holds("repeats", [] {
        LedgerBook sut{{"a"}, {"t"}};
        auto const n = *rc::gen::inRange<std::uint64_t>(1, 20);
        sut.announced(0, 0, "t", n);
        for (std::uint64_t s = 1; s <= n; ++s) {
            RC_ASSERT(!sut.complete(0));
            RC_ASSERT(sut.arrived(0, 0, 0, 0, s) == Arrival::expected);
            RC_ASSERT(sut.arrived(0, 0, 0, 0, *rc::gen::inRange<std::uint64_t>(1, s + 1)) == Arrival::repeated);
        }
        RC_ASSERT(sut.complete(0));
    }));
}

TEST(LedgerProperty, ALostSampleIsAlwaysNoticed) {
    EXPECT_TRUE(holds("gaps", [] {
        LedgerBook sut{{"a"}, {"t"}};
        auto const n = *rc::gen::inRange<std::uint64_t>(2, 20);
        auto const lost = *rc::gen::inRange<std::uint64_t>(1, n + 1);
        sut.announced(0, 0, "t", n);
        bool gap = false;
        for (std::uint64_t s = 1; s <= n; ++s) {
            gap = (s != lost && sut.arrived(0, 0, 0, 0, s) == Arrival::gap) || gap;
        }
        RC_ASSERT(gap == (lost < n)); // a lost last one shows as missing instead
        RC_ASSERT(!sut.complete(0));
        RC_ASSERT(!sut.missing(0).empty());
    }));
}

TEST(LedgerProperty, ANewIncarnationStartsFromNothingAndTheOldOneIsOver) {
    EXPECT_TRUE(holds("incarnations", [] {
        LedgerBook sut{{"a"}, {"t"}};
        auto const before = *rc::gen::inRange<std::uint64_t>(1, 10), now = *rc::gen::inRange<std::uint64_t>(1, 10);
        sut.announced(0, 0, "t", before + 5);
        for (std::uint64_t s = 1; s <= before; ++s) {
            sut.arrived(0, 0, 0, 0, s);
        }
        sut.announced(0, 1, "t", now);
        for (std::uint64_t s = 1; s <= now; ++s) {
            RC_ASSERT(!sut.complete(0));
            RC_ASSERT(sut.arrived(0, 0, 0, 0, before + s) == Arrival::repeated); // late samples of the dead
            sut.announced(0, 0, "t", 1000);
            RC_ASSERT(sut.arrived(0, 1, 0, 1, s) == Arrival::expected);
        }
        RC_ASSERT(sut.complete(0));
    }));
}

TEST(BarrierProperty, OpensWhenAndOnlyWhenEverybodyAwaitedHasAcknowledgedInAnyOrder) {
    EXPECT_TRUE(holds("barrier", [] {
        auto const size = *rc::gen::inRange<std::size_t>(1, 12);
        std::vector<Barrier::Member> members;
        for (std::size_t i = 0; i < size; ++i) {
            Barrier::Member member{"m" + std::to_string(i), {}};
            for (std::size_t up = 0; up < i; ++up) { // earlier ones only: no circles
                if (*rc::gen::inRange(0, 4) == 0) {
                    member.triggered_by.push_back("m" + std::to_string(up));
                }
            }
            members.push_back(std::move(member));
        }
        std::uint64_t const lag = *rc::gen::inRange<std::uint64_t>(1, 8);
        Barrier sut{members, lag};
        std::vector<std::int64_t> last(size, -1);
        std::vector<std::uint64_t> wanted(size, 0);
        for (std::uint64_t tick = 0; tick < 30; ++tick) {
            sut.open(tick, tick == 0);
            std::vector<std::size_t> awaited = sut.missing();
            for (std::size_t i = 0; i < size; ++i) {
                bool const is_awaited = std::find(awaited.begin(), awaited.end(), i) != awaited.end();
                if (wanted[i] <= tick || static_cast<std::int64_t>(tick) - last[i] >= static_cast<std::int64_t>(lag)) {
                    RC_ASSERT(is_awaited); // who asked, and who was silent for too long
                }
            }
            RC_ASSERT(sut.anybody_awaited() == !awaited.empty());
            for (std::size_t left = awaited.size(); left > 0; --left) {
                RC_ASSERT(!sut.complete());
                std::size_t const pick = *rc::gen::inRange<std::size_t>(0, left);
                std::size_t const member = awaited[pick];
                awaited.erase(awaited.begin() + static_cast<std::ptrdiff_t>(pick));
                wanted[member] = tick + *rc::gen::inRange<std::uint64_t>(1, 12);
                last[member] = static_cast<std::int64_t>(tick);
                (void)sut.on_ack(member, tick, wanted[member]);
                (void)sut.on_ack(member, tick, wanted[member]); // said twice, counted once
            }
            RC_ASSERT(sut.complete());
            RC_ASSERT(sut.missing().empty());
        }
    }));
}

} // namespace
} // namespace gridspace::lockstep
