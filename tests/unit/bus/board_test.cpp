// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/board/board.hpp"

#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace gridspace::bus {
namespace {

using std::chrono::milliseconds;
using std::chrono::seconds;

class BoardTest : public ::testing::Test {
  protected:
    UniqueFd memory{std::move(*Board::create(3))};
    std::unique_ptr<Board> join(std::string const& self) {
        return std::move(*Board::join(UniqueFd{::dup(memory.get())}, {"mu", "relay", "sim"}, self));
    }
    std::unique_ptr<Board> sim{join("sim")}, relay{join("relay")};

    static std::vector<std::byte> text(std::size_t size, std::uint64_t seed) {
        std::vector<std::byte> out(size);
        for (std::size_t i = 0; i < size; ++i) {
            out[i] = static_cast<std::byte>(seed * 31 + i);
        }
        return out;
    }
};

TEST_F(BoardTest, WhatIsSaidIsHeardOnceInItsOrderHoweverOftenTheRingComesRound) {
    std::uint64_t heard = 0;
    for (std::uint64_t said = 0; said < 400; ++said) {
        auto const message = text(1 + said * 97 % 9000, said);
        ASSERT_TRUE(sim->post(message, static_cast<std::int64_t>(said) * 7, said));
        if (said % 3 != 0) {
            continue;
        }
        ASSERT_TRUE(relay->read(relay->place_of("sim"), [&](Board::Message const& m) {
            EXPECT_EQ(m.number, heard);
            EXPECT_EQ(m.time_ns, static_cast<std::int64_t>(heard) * 7);
            auto const expected = text(1 + heard * 97 % 9000, heard);
            EXPECT_TRUE(std::equal(m.octets.begin(), m.octets.end(), expected.begin(), expected.end()));
            ++heard;
        }));
    }
    EXPECT_GT(heard, 390U);
    EXPECT_TRUE(relay->read(relay->place_of("mu"), [](auto const&) { ADD_FAILURE() << "it has said nothing"; }));
}

TEST_F(BoardTest, WhoDoesNotListenIsToldThatHeHasMissedSomething) {
    for (std::size_t said = 0; said < 2 * Board::kRing; said += 8000) {
        ASSERT_TRUE(sim->post(text(8000, said), 0, said));
    }
    EXPECT_FALSE(relay->read(relay->place_of("sim"), [](auto const&) {}));
    relay->skip(relay->place_of("sim"));
    EXPECT_TRUE(relay->read(relay->place_of("sim"), [](auto const&) { ADD_FAILURE() << "that was before"; }));
}

TEST_F(BoardTest, AMessageThatIsTooLongIsRefused) {
    EXPECT_TRUE(sim->post(text(Board::kLongest, 1), 0, 0));
    EXPECT_FALSE(sim->post(text(Board::kLongest + 1, 1), 0, 0));
}

TEST_F(BoardTest, TheLastThingThatIsWaitedForWakesAndNoneBefore) {
    std::size_t const place = relay->self();
    sim->expect(place, 3);
    std::uint32_t const before = relay->bell();
    sim->ring(place);
    sim->ring(place);
    EXPECT_EQ(relay->bell(), before);
    std::thread last{[&] { sim->ring(place); }};
    relay->wait(before, seconds{20});
    last.join();
    EXPECT_NE(relay->bell(), before);
    sim->ring(place); // one too many: nothing waits for it
    EXPECT_EQ(relay->bell(), before + 1);
}

TEST_F(BoardTest, ABellThatWasRungBeforeTheWaitIsNotMissedAndOneThatNobodyRingsIsNotWaitedForLong) {
    std::uint32_t const before = relay->bell();
    sim->wake(relay->self());
    relay->wait(before, seconds{20});
    relay->wait(relay->bell(), milliseconds{1});
}

TEST_F(BoardTest, WhoIsKilledWhileHeSpeaksHoldsNobodyUp) {
    for (int round = 0; round < 20; ++round) {
        pid_t const child = ::fork();
        if (child == 0) {
            for (std::uint64_t said = 0;; ++said) {
                (void)sim->post(text(3000, said), 0, said);
                sim->wake(relay->self());
            }
        }
        std::uint64_t last = 0;
        for (bool heard = false; !heard;) {
            std::uint32_t const bell = relay->bell();
            relay->skip(relay->place_of("sim"));
            relay->wait(bell, milliseconds{50});
            (void)relay->read(relay->place_of("sim"), [&](Board::Message const& m) {
                auto const expected = text(3000, m.number);
                EXPECT_TRUE(std::equal(m.octets.begin(), m.octets.end(), expected.begin(), expected.end()));
                heard = true;
                last = m.number;
            });
        }
        ::kill(child, SIGKILL);
        ::waitpid(child, nullptr, 0);
        relay->skip(relay->place_of("sim"));
        auto const next = join("sim"); // the next incarnation goes on behind what is complete
        ASSERT_TRUE(next->post(text(10, 5), 1, last + 1));
        int messages = 0;
        ASSERT_TRUE(relay->read(relay->place_of("sim"),
                                [&](Board::Message const& m) { messages += m.time_ns == 1 ? 1 : 100; }));
        EXPECT_EQ(messages, 1);
    }
}

TEST_F(BoardTest, MemoryOfAnotherRunIsRefused) {
    auto const other = Board::create(2);
    EXPECT_FALSE(Board::join(UniqueFd{::dup(other->get())}, {"mu", "relay", "sim"}, "sim"));
    EXPECT_FALSE(Board::join(UniqueFd{::dup(memory.get())}, {"mu", "relay", "sim"}, "stranger"));
    EXPECT_FALSE(Board::join(UniqueFd{::open("/dev/null", O_RDONLY | O_CLOEXEC)}, {"sim"}, "sim"));
}

} // namespace
} // namespace gridspace::bus
