// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The clock path of a tick takes nothing from the heap once everybody has been heard: decoding clock and
// acknowledgements, ledgers, the gate, the barrier. A program of its own: it counts allocations.
#include "bus/codec.hpp"
#include "bus/lockstep/barrier.hpp"
#include "bus/lockstep/tick_gate.hpp"
#include "tests/support/allocations.hpp"

#include <clock.h>
#include <gtest/gtest.h>

namespace gridspace::bus {
namespace {

constexpr int kMembers = 4;

/// A simulator with four members in two layers: the ledger of every tick, as it goes over the wire.
class ClockPath {
  public:
    ClockPath()
        : book_{{"ev1", "ev2", "ev3", "mcca", "sim"}, {"bus_measurements", "requests"}},
          gate_{{"mcca", "sim", {"ev1", "ev2", "ev3", "mcca"}, {"ev1", "ev2", "ev3"}}, book_},
          barrier_{{{"ev1", {}}, {"ev2", {}}, {"ev3", {}}, {"mcca", {"ev1", "ev2", "ev3"}}}, 16} {
        for (int i = 0; i < kMembers; ++i) {
            acks_[i].member(std::array{"ev1", "ev2", "ev3", "mcca"}[static_cast<std::size_t>(i)]);
            acks_[i].ledger().resize(1);
            acks_[i].ledger()[0].topic("requests");
        }
        clock_.ledger().resize(1);
        clock_.ledger()[0].topic("bus_measurements");
    }

    /// True when everything went as it should.
    bool tick(std::uint64_t k) {
        barrier_.open(k, false);
        clock_.tick(k);
        clock_.awaited() = barrier_.awaited_bits();
        clock_.ledger()[0].sent(2 * (k + 1));
        bool good = pass(clock_, heard_clock_);
        book_.announced(book_.process_index("sim"), 0, heard_clock_.ledger()[0].topic().c_str(),
                        heard_clock_.ledger()[0].sent());
        gate_.on_clock(heard_clock_.tick(), heard_clock_.awaited(), false);
        good = good && !gate_.granted(); // nothing has arrived yet
        for (std::uint32_t writer = 0; writer < 2; ++writer) {
            book_.arrived(book_.process_index("sim"), 0, 0, writer, k + 1);
        }
        for (std::uint32_t i = 0; i < kMembers; ++i) {
            if (i == kMembers - 1) { // the one in the second layer works when the others are done
                good = good && gate_.granted().has_value();
                gate_.done();
            }
            ClockAck& ack = acks_[i];
            ack.tick(k);
            ack.next_tick_needed(k + 1);
            ack.ledger()[0].sent(k + 1);
            good = good && pass(ack, heard_ack_);
            std::size_t const process = book_.process_index(heard_ack_.member().c_str());
            if (i < kMembers - 1) {
                book_.announced(process, 0, heard_ack_.ledger()[0].topic().c_str(), heard_ack_.ledger()[0].sent());
                auto const now = static_cast<std::int64_t>(k);
                book_.arrived(process, 0, 1, 10 + i, k + 1, now);
                good = good && book_.acknowledged(process, 0, now).empty();
            }
            gate_.on_ack(process, heard_ack_.tick());
            (void)barrier_.on_ack(barrier_.member_index(heard_ack_.member().c_str()), heard_ack_.tick(),
                                  heard_ack_.next_tick_needed());
        }
        return good && barrier_.complete();
    }

  private:
    /// Over the wire: encoded, and decoded into a sample that is used again and again.
    template <class T>
    bool pass(T const& sent, T& heard) {
        std::size_t const size = codec_of<T>().encode(&sent, wire_);
        return size > 0 && codec_of<T>().decode(std::span{wire_}.first(size), &heard);
    }

    lockstep::LedgerBook book_;
    lockstep::TickGate gate_;
    lockstep::Barrier barrier_;
    SimClock clock_, heard_clock_;
    ClockAck acks_[kMembers], heard_ack_;
    std::array<std::byte, 65536> wire_{};
};

TEST(ClockPath, TakesNothingFromTheHeapOnceEverybodyHasBeenHeard) {
    ClockPath sut;
    for (std::uint64_t k = 0; k < 100; ++k) {
        ASSERT_TRUE(sut.tick(k)) << k;
    }
    std::size_t const before = allocations();
    bool good = true;
    for (std::uint64_t k = 100; k < 10'000; ++k) {
        good = sut.tick(k) && good;
    }
    std::size_t const after = allocations();
    EXPECT_TRUE(good);
    EXPECT_EQ(after, before);
}

TEST(ClockPath, TheCounterCounts) { // the negative control
    std::size_t const before = allocations();
    auto const* volatile kept = new ClockAck;
    EXPECT_GT(allocations(), before);
    delete kept;
}

} // namespace
} // namespace gridspace::bus
