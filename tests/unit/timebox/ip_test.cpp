// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/random.hpp"
#include "timebox/ip/ip_stack.hpp"
#include "timebox/ip/tcp_end.hpp"
#include "timebox/ip/udp_end.hpp"

#include <cerrno>
#include <gmock/gmock.h>
#include <set>

namespace gridspace::timebox {
namespace {

constexpr std::uint32_t kOwn = 0x0A140001, kOther = 0x0A140002, kNobody = 0x0A140009, kLoop = 0x7F000001;
constexpr std::int64_t kMs = 1'000'000;

IpLink link_of_two() {
    IpLink out;
    out.address = kOwn;
    out.mac = {2, 0x47, 0x53, 0x81, 0, 1};
    out.neighbours[kOther] = {2, 0x47, 0x53, 0x81, 0, 2};
    return out;
}

std::vector<std::uint8_t> pattern(std::size_t size) {
    std::vector<std::uint8_t> out(size);
    for (std::size_t i = 0; i < size; ++i) {
        out[i] = static_cast<std::uint8_t>(i * 31 + i / 251);
    }
    return out;
}

/// A stack whose neighbour is itself: what it sends comes back with both addresses exchanged, which no checksum
/// notices. So both ends of a connection are here, and the cable between them is ours.
class Mirror : public ::testing::Test {
  protected:
    struct Cable {
        std::int64_t delay_ns{1 * kMs};
        double loss{0}, twice{0}, late{0};
    };

    void send(std::span<std::uint8_t const> frame) {
        ++sent;
        std::vector<std::uint8_t> back{frame.begin(), frame.end()};
        std::swap_ranges(back.begin(), back.begin() + 6, back.begin() + 6);
        std::swap_ranges(back.begin() + 26, back.begin() + 30, back.begin() + 30);
        times.insert(now_ns);
        if (random.chance(cable.loss)) {
            return;
        }
        for (int copies = random.chance(cable.twice) ? 2 : 1; copies > 0; --copies) {
            std::int64_t const extra = random.chance(cable.late) ? 3 * cable.delay_ns : 0;
            coming.emplace(now_ns + cable.delay_ns + extra, back);
        }
    }

    /// The next thing that happens; false: not before `until_ns`.
    bool step(std::int64_t until_ns) {
        std::int64_t next_ns = sut->next_ns();
        bool const frame = !coming.empty() && coming.begin()->first <= next_ns;
        next_ns = frame ? coming.begin()->first : next_ns;
        if (next_ns > until_ns) {
            now_ns = until_ns;
            sut->elapse_to(now_ns);
            return false;
        }
        now_ns = next_ns;
        sut->elapse_to(now_ns);
        if (frame) {
            auto const octets = coming.extract(coming.begin()).mapped();
            sut->receive(octets);
        }
        return true;
    }

    struct Pair {
        std::unique_ptr<TcpListener> listener;
        std::unique_ptr<TcpEnd> client{std::make_unique<TcpEnd>()}, server;
    };
    Pair connect(std::uint32_t to, std::uint16_t port) {
        Pair out;
        TcpEnd bound;
        EXPECT_EQ(bound.bind({0, port}, true), 0);
        EXPECT_EQ(TcpListener::listen(bound, out.listener), 0);
        EXPECT_EQ(out.client->connect({to, port}), 0);
        sut->settle();
        while (out.listener->accepted().empty() && step(now_ns + 100'000 * kMs)) {
        }
        if (!out.listener->accepted().empty()) {
            out.server = std::move(out.listener->accepted().front());
            out.listener->accepted().pop_front();
        }
        return out;
    }

    std::vector<std::uint8_t> carry(TcpEnd& from, TcpEnd& to, std::vector<std::uint8_t> const& octets,
                                    std::int64_t patience_ns) {
        std::vector<std::uint8_t> out;
        std::size_t taken = 0;
        for (std::int64_t const end_ns = now_ns + patience_ns; out.size() < octets.size();) {
            std::size_t const sent_now = from.send(std::span{octets}.subspan(taken));
            taken += sent_now;
            sut->settle();
            std::size_t const came = to.received().size();
            out.insert(out.end(), to.received().begin(), to.received().end());
            to.take(came);
            sut->settle();
            if (sent_now + came == 0 && !step(end_ns)) {
                break;
            }
        }
        return out;
    }

    Cable cable;
    Random random{11, "cable"};
    std::multimap<std::int64_t, std::vector<std::uint8_t>> coming;
    std::set<std::int64_t> times;
    std::int64_t now_ns{0};
    int sent{0};
    std::unique_ptr<IpStack> sut{std::make_unique<IpStack>(link_of_two(), 7, [this](std::span<std::uint8_t const> f) {
        send(f);
        return std::string{};
    })};
    UdpEnds udp;
};

TEST_F(Mirror, ADatagramArrivesWithItsSenderAndIsAnswered) {
    auto const server = udp.make(), client = udp.make();
    ASSERT_EQ(server->bind({0, 5000}, false), 0);
    ASSERT_EQ(client->send(pattern(100), IpEndpoint{kOther, 5000}), 0);
    ASSERT_TRUE(step(10 * kMs));
    ASSERT_EQ(server->queue().size(), 1U);
    Datagram const got = server->pop();
    EXPECT_EQ(got.octets, pattern(100));
    EXPECT_EQ(got.from.address, kOther);
    EXPECT_EQ(got.from.port, client->local().port);
    EXPECT_EQ(now_ns, cable.delay_ns);
    ASSERT_EQ(server->send(pattern(1), got.from), 0);
    ASSERT_TRUE(step(10 * kMs));
    EXPECT_EQ(client->queue().size(), 1U);
}

TEST_F(Mirror, ALongDatagramComesInPiecesAndIsWhole) {
    auto const server = udp.make(), client = udp.make();
    ASSERT_EQ(server->bind({0, 5000}, false), 0);
    ASSERT_EQ(client->send(pattern(8000), IpEndpoint{kOther, 5000}), 0);
    while (step(10 * kMs)) {
    }
    ASSERT_EQ(server->queue().size(), 1U);
    EXPECT_EQ(server->pop().octets, pattern(8000));
    EXPECT_EQ(sent, 6); // of 1480 octets each
}

TEST_F(Mirror, WhoIsConnectedHearsThatNobodyListens) {
    auto const client = udp.make();
    ASSERT_EQ(client->connect({kLoop, 9}), 0);
    ASSERT_EQ(client->send(pattern(4), std::nullopt), 0);
    sut->settle();
    EXPECT_EQ(client->take_error(), ECONNREFUSED);
    EXPECT_EQ(client->take_error(), 0);
}

TEST_F(Mirror, AGroupIsHeardByAllWhoAreBoundToItsPort) {
    constexpr std::uint32_t kGroup = 0xEFFF0001;
    auto const one = udp.make(), two = udp.make(), client = udp.make();
    ASSERT_EQ(one->bind({0, 5000}, true), 0);
    ASSERT_EQ(two->bind({0, 5000}, true), 0);
    ASSERT_EQ(client->send(pattern(3), IpEndpoint{kGroup, 5000}), 0);
    sut->settle();
    EXPECT_TRUE(one->queue().empty()); // nobody has joined
    sut->join(kGroup);
    ASSERT_EQ(client->send(pattern(3), IpEndpoint{kGroup, 5000}), 0);
    sut->settle();
    EXPECT_EQ(one->queue().size(), 1U);
    EXPECT_EQ(two->queue().size(), 1U);
}

TEST_F(Mirror, ItIsThereForItself) {
    for (std::uint32_t const address : {kLoop, kOwn}) {
        int const before = sent;
        Pair const ends = connect(address, 1883);
        ASSERT_NE(ends.server, nullptr);
        EXPECT_EQ(carry(*ends.client, *ends.server, pattern(200'000), 0), pattern(200'000));
        EXPECT_EQ(now_ns, 0);
        EXPECT_EQ(sent, before) << "nothing of it is on the wire";
    }
}

TEST_F(Mirror, AHandshakeTakesTheTimeOfItsFrames) {
    Pair const ends = connect(kOther, 1883);
    ASSERT_NE(ends.server, nullptr);
    EXPECT_TRUE(ends.client->is_connected());
    EXPECT_EQ(now_ns, 3 * cable.delay_ns); // SYN, SYN and ACK, ACK
    EXPECT_EQ(ends.client->remote(), (IpEndpoint{kOther, 1883}));
    EXPECT_EQ(ends.server->remote(), (IpEndpoint{kOther, ends.client->local().port}));
}

TEST_F(Mirror, NobodyListensIsToldAtOnceAndNobodyThereAfterAWhile) {
    TcpEnd refused, silent;
    ASSERT_EQ(refused.connect({kOther, 99}), 0);
    while (refused.error() == 0 && step(10 * kMs)) {
    }
    EXPECT_EQ(refused.error(), ECONNREFUSED);
    EXPECT_EQ(now_ns, 2 * cable.delay_ns);
    EXPECT_FALSE(sut->reaches(kNobody));
    cable.loss = 1;
    ASSERT_EQ(silent.connect({kOther, 99}), 0);
    while (silent.error() == 0 && step(100'000 * kMs)) {
    }
    EXPECT_EQ(silent.error(), ETIMEDOUT);
}

TEST_F(Mirror, AStreamIsWholeOverACableThatLosesDoublesAndOvertakes) {
    for (std::uint64_t const seed : {1U, 2U, 3U, 4U, 5U, 6U}) {
        random = Random{seed, "cable"};
        cable.loss = 0;
        cable.delay_ns = 1 * kMs;
        Pair ends = connect(kOther, static_cast<std::uint16_t>(2000 + seed));
        ASSERT_NE(ends.server, nullptr);
        cable.loss = 0.05;
        cable.twice = 0.05;
        cable.late = 0.05;
        EXPECT_EQ(carry(*ends.client, *ends.server, pattern(100'000), 600'000 * kMs), pattern(100'000)) << seed;
        EXPECT_EQ(carry(*ends.server, *ends.client, pattern(50'000), 600'000 * kMs), pattern(50'000)) << seed;
        ends.client->finish();
        while (!ends.server->peer_has_finished() && step(now_ns + 600'000 * kMs)) {
        }
        EXPECT_TRUE(ends.server->peer_has_finished()) << seed;
        ends.server->finish();
        ends.server->let_go_when_finished();
        while (!ends.client->peer_has_finished() && step(now_ns + 600'000 * kMs)) {
        }
        EXPECT_TRUE(ends.client->peer_has_finished()) << seed;
        ends.client->let_go_when_finished();
        EXPECT_TRUE(ends.client->has_ended());
        cable = {};
    }
}

TEST_F(Mirror, WhoReadsNothingClosesTheWindowAndLosesNothing) {
    Pair const ends = connect(kOther, 1883);
    ASSERT_NE(ends.server, nullptr);
    std::vector<std::uint8_t> const octets = pattern(500'000);
    std::size_t taken = 0;
    for (int i = 0; i < 200; ++i) {
        taken += ends.client->send(std::span{octets}.subspan(taken));
        (void)step(now_ns + 1000 * kMs);
    }
    EXPECT_LT(taken, 300'000U);
    EXPECT_EQ(ends.client->room(), 0U);
    std::vector<std::uint8_t> out;
    for (int i = 0; i < 5000 && out.size() < octets.size(); ++i) {
        out.insert(out.end(), ends.server->received().begin(), ends.server->received().end());
        ends.server->take(ends.server->received().size());
        taken += ends.client->send(std::span{octets}.subspan(taken));
        (void)step(now_ns + 1000 * kMs);
    }
    EXPECT_EQ(out, octets);
}

TEST_F(Mirror, AResetIsHeardByTheOtherEnd) {
    Pair const ends = connect(kOther, 1883);
    ASSERT_NE(ends.server, nullptr);
    ends.server->reset();
    while (ends.client->error() == 0 && step(now_ns + 10 * kMs)) {
    }
    EXPECT_EQ(ends.client->error(), ECONNRESET);
}

TEST_F(Mirror, APortThatIsTakenIsRefusedAndOneThatIsGivenBackIsNot) {
    auto first = udp.make();
    auto const second = udp.make();
    ASSERT_EQ(first->bind({0, 5000}, false), 0);
    EXPECT_EQ(second->bind({0, 5000}, false), EADDRINUSE);
    first.reset();
    EXPECT_EQ(second->bind({0, 5000}, false), 0);
}

} // namespace
} // namespace gridspace::timebox
