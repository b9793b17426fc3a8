// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A real participant with readers and a writer, and a stranger that has announced matching ones: whatever it says of
// its samples and of ours, damaged in any way, ends nobody. More than in every test run:
//   GRIDSPACE_DATAGRAMS=10000000 GRIDSPACE_SEED=7 build/release/tests/bus_mutated_datagrams
#include "bus/participant.hpp"
#include "common/source_tree.hpp"
#include "common/unique_fd.hpp"
#include "tests/integration/veth/veth.hpp"
#include "tests/support/rtps_message.hpp"

#include <arpa/inet.h>
#include <cstdlib>
#include <gmock/gmock.h>
#include <random>
#include <sys/socket.h>
#include <thread>

namespace gridspace::bus {
namespace {

using namespace test;

constexpr std::uint8_t kStranger = 7;
constexpr std::uint32_t kKeyedWriter = 0x00000102, kPlainWriter = 0x00000203, kItsReader = 0x00000304;

std::uint64_t setting(char const* name, std::uint64_t otherwise) {
    char const* const text = std::getenv(name);
    return text == nullptr ? otherwise : std::strtoull(text, nullptr, 10);
}

class MutatedDatagrams : public ethernet::Veth {
  protected:
    void SetUp() override {
        Veth::SetUp();
        if (IsSkipped()) {
            return;
        }
        auto joined =
            Participant::create({"a", 0, "test", 0, source_tree("qos/member.xml"), "management", {"127.0.0.1"}});
        ASSERT_TRUE(joined) << describe(joined.error());
        sut_ = std::move(*joined);
        auto const heard = [this](std::span<std::byte const>, SampleHeader const&) { ++heard_; };
        keyed_ = *sut_->create_reader("keyed", {.type_name = "Keyed", .keyed = true}, heard);
        plain_ = *sut_->create_reader("plain", {.type_name = "Plain"}, heard);
        big_ = *sut_->create_writer("big", {.type_name = "Plain"});
        socket_ = UniqueFd{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
        ASSERT_TRUE(socket_);
        ask_until([&] {
            send(message({announcement(kStranger, parameter(0x0058, little(0x3f, 4)))}, kStranger), kDiscovery);
            send(message({endpoint(kStranger, kKeyedWriter, "keyed", "Keyed", 1),
                          endpoint(kStranger, kPlainWriter, "plain", "Plain", 2),
                          endpoint(kStranger, kItsReader, "big", "Plain", 1)},
                         kStranger),
                 kDiscovery);
            return !keyed_->matched().empty() && !plain_->matched().empty() && !big_->matched().empty();
        });
    }
    void TearDown() override {
        big_.reset();
        keyed_.reset();
        plain_.reset();
        sut_.reset();
        Veth::TearDown();
    }

    static constexpr std::uint16_t kDiscovery = 7410, kUser = 7411; // DDSI-RTPS 2.2, 9.6.1.1, domain 0
    void send(Bytes const& datagram, std::uint16_t port) const {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(port);
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ASSERT_EQ(
            ::sendto(socket_.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to),
            static_cast<ssize_t>(datagram.size()));
    }
    template <class Done>
    static void ask_until(Done const& done) {
        auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{60};
        while (!done()) {
            ASSERT_LT(std::chrono::steady_clock::now(), hang);
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
    }
    /// Both sockets have been read up to here: each is sent something that is counted.
    void wait_until_read() {
        send({'m', 'a', 'r', 'k'}, kDiscovery);
        send({'m', 'a', 'r', 'k'}, kUser);
        marks_ += 2;
        ask_until([&] {
            std::string const text = sut_->refused_datagrams();
            std::size_t const end = text.find(" (not RTPS 2)");
            std::size_t const begin = text.rfind(' ', end == std::string::npos ? end : end - 1);
            return end != std::string::npos &&
                   std::strtoull(text.c_str() + (begin == std::string::npos ? 0 : begin + 1), nullptr, 10) >= marks_;
        });
    }

    std::uint32_t below(std::uint32_t bound) { return static_cast<std::uint32_t>(random_() % bound); }
    template <class T>
    T one_of(std::initializer_list<T> const& what) {
        return what.begin()[below(static_cast<std::uint32_t>(what.size()))];
    }

    std::unique_ptr<Participant> sut_;
    std::unique_ptr<RawReader> keyed_, plain_;
    std::unique_ptr<RawWriter> big_;
    std::atomic<std::uint64_t> heard_{0};
    UniqueFd socket_;
    std::uint64_t marks_{0};
    std::mt19937_64 random_{setting("GRIDSPACE_SEED", 1)};
};

TEST_F(MutatedDatagrams, OfSamplesFragmentsAndTheirBookkeepingAreSurvived) {
    std::vector<std::byte> const large(200'000, std::byte{1});
    std::int64_t next = 1; // of the stranger's samples
    auto const number_near = [&] { return number(std::max<std::int64_t>(0, next + below(6) - 3)); };
    auto const set = [&](Bytes const& base) {
        std::uint32_t const bits = one_of({1U, 4U, 32U, 33U, 256U});
        Bytes out = joined({base, little(bits, 4)});
        for (std::uint32_t i = 0; i < (bits + 31) / 32; ++i) {
            append(out, little(random_(), 4));
        }
        return out;
    };
    std::int64_t written = 0;      // by our writer
    auto const any_of_ours = [&] { // mostly that writer
        return entity(below(2) == 0 ? 0x00000303 : (1 + below(5)) << 8 | one_of({2U, 3U, 4U, 7U}));
    };
    auto const number_of_ours = [&] { return number(std::max<std::int64_t>(0, written + 1 - below(6))); };
    auto const any_submessage = [&]() -> Bytes {
        Bytes const writer = entity(one_of({kKeyedWriter, kPlainWriter})), reader = entity(0);
        Bytes const qos = joined(
            {parameter(one_of<std::uint16_t>({0x70, 0x71}), Bytes(16, one_of<std::uint8_t>({0, 1, 9}))), kSentinel});
        bool const with_qos = below(2) == 0;
        std::uint8_t const flags = with_qos ? 3 : 1;
        switch (below(9)) {
        case 0:
        case 1: {
            next += below(2);
            return submessage(0x15,
                              joined({{0, 0, 16, 0},
                                      reader,
                                      writer,
                                      number_near(),
                                      with_qos ? qos : Bytes{},
                                      {0, 1, 0, 0},
                                      Bytes(4 * below(40))}),
                              static_cast<std::uint8_t>(flags | one_of<std::uint8_t>({4, 4, 8, 0})));
        }
        case 2:
        case 3: {
            std::uint32_t const size = one_of({8U, 1344U}), whole = size * (1 + below(5)) - below(8);
            std::uint32_t const first = 1 + below(4), count = one_of({1U, 2U});
            return submessage(0x16,
                              joined({{0, 0, 28, 0},
                                      reader,
                                      writer,
                                      number_near(),
                                      little(first, 4),
                                      little(count, 2),
                                      little(size, 2),
                                      little(whole, 4),
                                      with_qos ? qos : Bytes{},
                                      {0, 1, 0, 0},
                                      Bytes(size * count - 4)}),
                              flags);
        }
        case 4:
            return submessage(0x07, joined({reader, writer, number_near(), number_near(), little(random_(), 4)}),
                              one_of<std::uint8_t>({1, 3, 5}));
        case 5:
            return submessage(0x08, joined({reader, writer, number_near(), set(number_near())}));
        case 6:
            return submessage(0x13, joined({reader, writer, number_near(), little(below(9), 4), little(random_(), 4)}));
        case 7:
            return submessage(0x12, joined({entity(kItsReader), any_of_ours(), number_of_ours(),
                                            set(little(below(300), 4)), little(random_(), 4)}));
        default:
            return submessage(0x06,
                              joined({entity(kItsReader), any_of_ours(), set(number_of_ours()), little(random_(), 4)}),
                              one_of<std::uint8_t>({1, 3}));
        }
    };
    std::uint64_t const datagrams = setting("GRIDSPACE_DATAGRAMS", 20'000);
    for (std::uint64_t i = 0; i < datagrams; ++i) {
        Bytes datagram = message({}, kStranger);
        for (std::uint32_t k = 0, count = 1 + below(4); k < count; ++k) {
            append(datagram, below(8) == 0 ? submessage(0x09, Bytes(8, 1)) : any_submessage());
        }
        for (std::uint32_t k = 0, count = one_of({0U, 0U, 1U, 3U}); k < count; ++k) {
            std::uint32_t const at = 20 + below(static_cast<std::uint32_t>(datagram.size()) - 20);
            datagram[at] = one_of<std::uint8_t>({0, 1, 0x7f, 0xff, static_cast<std::uint8_t>(random_())});
        }
        send(datagram, below(4) == 0 ? kDiscovery : kUser);
        if (i % 200 == 0) {
            written += big_->write_cdr(large, std::nullopt) ? 1 : 0; // in fragments
            wait_until_read();
        }
    }
    wait_until_read();
    EXPECT_GT(heard_, 0U) << "all of them were kept away: the test tests nothing";
}

} // namespace
} // namespace gridspace::bus
