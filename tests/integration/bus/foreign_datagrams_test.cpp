// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Datagrams of a stranger at the ports of a real participant.
#include "bus/participant.hpp"
#include "common/source_tree.hpp"
#include "common/unique_fd.hpp"
#include "tests/integration/veth/veth.hpp"
#include "tests/support/rtps_message.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace gridspace::bus {
namespace {

using namespace test;
using testing::HasSubstr;

class ForeignDatagrams : public ethernet::Veth {
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
        ++joined_;
        socket_ = UniqueFd{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
        ASSERT_TRUE(socket_);
    }
    void TearDown() override {
        sut_.reset();
        Veth::TearDown();
    }
    /// To the participant's unicast port for discovery in domain 0 (DDSI-RTPS 2.2, 9.6.1.1); Fast DDS numbers the
    /// participants of a process on and on.
    void send(Bytes const& datagram) const {
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(static_cast<std::uint16_t>(7410 + 2 * (joined_ - 1)));
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        ASSERT_EQ(
            ::sendto(socket_.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&to), sizeof to),
            static_cast<ssize_t>(datagram.size()));
    }
    void wait_until_known(std::string const& process) const {
        auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{60};
        while (!sut_->hears({process, 0, ""}) && std::chrono::steady_clock::now() < hang) {
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        EXPECT_TRUE(sut_->hears({process, 0, ""})) << "refused: " << sut_->refused_datagrams();
    }

    static inline int joined_ = 0;
    std::unique_ptr<Participant> sut_;
    UniqueFd socket_;
};

TEST_F(ForeignDatagrams, TheDatagramThatEndedProcessesIsCountedAndNothingElse) {
    send(deadly_datagram());
    send(message({announcement(7)}, 7)); // the participant lives, and reads on
    wait_until_known("stranger");
    EXPECT_EQ(sut_->refused_datagrams(), "1 (a submessage that nobody sends here)");
}

TEST_F(ForeignDatagrams, DamagedMessagesOfEveryKindAreSurvived) {
    Bytes const whole = message({announcement(7), submessage(0x09, Bytes(8)), submessage(0x0e, guid_prefix(3)),
                                 data(0, 0x102, {0, 1, 0, 0, 1, 2, 3, 4}), kStatistics},
                                7);
    for (std::size_t i = 0; i < whole.size(); ++i) {
        for (int const octet : {0, 1, 0x7f, 0x80, 0xff}) {
            Bytes damaged = whole;
            damaged[i] = static_cast<std::uint8_t>(octet);
            send(damaged);
        }
        send({whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(i)});
    }
    send(message({announcement(8, {}, "last")}, 8)); // by another name: who is damaged may be known long before
    wait_until_known("last");
    EXPECT_THAT(sut_->refused_datagrams(), HasSubstr("a damaged parameter list"));
}

/// Resident memory of this process, octets.
std::size_t resident() {
    std::size_t all = 0, pages = 0;
    std::ifstream{"/proc/self/statm"} >> all >> pages;
    return pages * static_cast<std::size_t>(::sysconf(_SC_PAGESIZE));
}

/// More than in every test run: GRIDSPACE_DATAGRAMS=100000000 build/release/tests/bus_foreign_datagrams
TEST_F(ForeignDatagrams, InventedParticipantsHaveABoundAndTakeNoMoreMemoryWithTime) {
    char const* const more = std::getenv("GRIDSPACE_DATAGRAMS");
    Bytes const mark = guid_prefix(0);
    Bytes const invented = message({announcement(0)}, 0);
    auto const invent = [&](std::uint64_t number) {
        Bytes one = invented;
        for (auto at = one.begin(); (at = std::search(at, one.end(), mark.begin(), mark.end())) != one.end(); ++at) {
            for (int i = 0; i < 5; ++i) {
                *(at + 2 + i) = static_cast<std::uint8_t>(number >> (8 * i));
            }
        }
        send(one);
    };
    std::uint64_t number = 0;
    while (sut_->refused_datagrams().empty() && number < 1'000'000) {
        invent(number++);
    }
    EXPECT_THAT(sut_->refused_datagrams(), HasSubstr("one participant too many"));
    std::size_t const before = resident();
    for (std::uint64_t const end = number + (more == nullptr ? 100'000 : std::strtoull(more, nullptr, 10));
         number < end;) {
        invent(number++);
    }
    EXPECT_LT(resident(), before + (32U << 20U)) << "of " << before;
    RecordProperty("resident_before", std::to_string(before));
    RecordProperty("resident_after", std::to_string(resident()));
}

TEST_F(ForeignDatagrams, ASampleInFragmentsComesAsItWasSent) {
    auto other = Participant::create({"b", 0, "test", 0, source_tree("qos/member.xml"), "management", {"127.0.0.1"}});
    ASSERT_TRUE(other) << describe(other.error());
    ++joined_;
    std::vector<std::byte> sent(1'000'000);
    for (std::size_t i = 4; i < sent.size(); ++i) {
        sent[i] = static_cast<std::byte>(i * 7 / 5);
    }
    std::mutex mutex;
    std::vector<std::vector<std::byte>> heard;
    auto const reader = sut_->create_reader("x", {.type_name = "X"}, [&](auto cdr, SampleHeader const&) {
        std::lock_guard const lock{mutex};
        heard.emplace_back(cdr.begin(), cdr.end());
    });
    auto const writer = (*other)->create_writer("x", {.type_name = "X"});
    ASSERT_TRUE(reader && writer);
    auto const wait_until = [](auto const& done) {
        auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{60};
        while (!done() && std::chrono::steady_clock::now() < hang) {
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        return done();
    };
    ASSERT_TRUE(wait_until([&] { return !(*reader)->matched().empty() && !(*writer)->matched().empty(); }));
    for (std::size_t count = 1; count <= 5; ++count) {
        ASSERT_TRUE((*writer)->write_cdr(sent, std::nullopt));
        EXPECT_TRUE(wait_until([&] {
            std::lock_guard const lock{mutex};
            return heard.size() == count && heard.back() == sent;
        })) << count;
    }
    EXPECT_TRUE((*writer)->wait_acknowledged(std::chrono::seconds{10}));
    EXPECT_EQ(sut_->refused_datagrams(), "");
}

} // namespace
} // namespace gridspace::bus
