// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/group_membership.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/routable.hpp"
#include "veth.hpp"

#include <chrono>
#include <ctime>
#include <gmock/gmock.h>
#include <linux/capability.h>
#include <netinet/in.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::ethernet {
namespace {

using Buffer = std::vector<std::uint8_t>;

constexpr std::uint16_t kSv = 0x88BA, kGoose = 0x88B8;

/// A frame of 64 octets with a number in it.
Buffer frame(std::uint32_t number, std::uint16_t ethertype = kSv, std::uint16_t app_id = 0x4000, std::size_t tags = 0) {
    Buffer out{0x01, 0x0C, 0xCD, 0x04, 0x00, 0x21, 0x02, 0, 0, 0, 0, 1};
    auto const half = [&](std::uint16_t v) {
        out.push_back(static_cast<std::uint8_t>(v >> 8U));
        out.push_back(static_cast<std::uint8_t>(v));
    };
    for (std::size_t i = 0; i < tags; ++i) {
        half(0x8100);
        half(static_cast<std::uint16_t>(0x8000 + 5 + i));
    }
    half(ethertype);
    half(app_id);
    out.resize(64);
    iec61850::store_be(out.data() + 60, number);
    return out;
}

std::uint32_t number_of(Octets octets) {
    return iec61850::load_be<std::uint32_t>(octets.data() + 60);
}

PortOptions options(std::string interface, bool ring = true) {
    PortOptions out;
    out.interface = std::move(interface);
    out.ring = ring;
    out.filter.ethertypes = {kSv};
    return out;
}

/// Everything that arrives until `count` frames have, or nothing more comes.
std::vector<Buffer> receive(Port& port, std::size_t count, std::vector<std::int64_t>* stamps = nullptr) {
    std::vector<Buffer> out;
    std::vector<ReceivedFrame> batch(32);
    while (out.size() < count) {
        std::size_t const n = port.receive(batch);
        for (std::size_t i = 0; i < n; ++i) {
            out.emplace_back(batch[i].octets.begin(), batch[i].octets.end());
            if (stamps != nullptr) {
                stamps->push_back(batch[i].stamp_ns);
            }
        }
        if (n == 0 && !port.wait(2'000'000'000)) {
            break;
        }
    }
    return out;
}

/// Nothing is on its way: what was sent on a cable is in the other end's queue when send() returns.
std::size_t waiting(Port& port) {
    std::vector<ReceivedFrame> batch(64);
    std::size_t sum = 0, n = 0;
    while ((n = port.receive(batch)) > 0) {
        sum += n;
    }
    return sum;
}

std::int64_t now_ns() {
    timespec t{};
    ::clock_gettime(CLOCK_REALTIME, &t);
    return std::int64_t{t.tv_sec} * 1'000'000'000 + t.tv_nsec;
}

/// Both ways of receiving.
class PortTest : public Veth, public testing::WithParamInterface<bool> {
  protected:
    static Port open(PortOptions o) {
        o.ring = GetParam();
        auto port = Port::open(std::move(o));
        EXPECT_TRUE(port) << describe(port.error());
        EXPECT_TRUE(!o.receive || port->uses_ring() == GetParam());
        return std::move(*port);
    }
};
INSTANTIATE_TEST_SUITE_P(Way, PortTest, testing::Values(true, false),
                         [](auto const& p) { return p.param ? "ring" : "recvmmsg"; });

TEST_P(PortTest, LosesNotOneFrameAtTheStart) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    for (int round = 0; round < 20; ++round) {
        Port sut = open(options("right"));
        for (std::uint32_t i = 0; i < 50; ++i) {
            ASSERT_TRUE(sender.send(frame(i)));
        }
        auto const frames = receive(sut, 50);
        ASSERT_EQ(frames.size(), 50U);
        for (std::uint32_t i = 0; i < 50; ++i) {
            EXPECT_EQ(number_of(frames[i]), i);
        }
        EXPECT_EQ(sut.counters().dropped, 0U);
    }
}

TEST_P(PortTest, GivesFramesAsTheyWereOnTheWireTagsIncluded) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    Port sut = open(options("right"));
    for (std::size_t tags = 0; tags < 3; ++tags) {
        Buffer const sent = frame(7, kSv, 0x4000, tags);
        ASSERT_TRUE(sender.send(sent));
        auto const frames = receive(sut, 1);
        ASSERT_EQ(frames.size(), 1U) << tags << " tags";
        EXPECT_EQ(frames[0], sent) << tags << " tags";
    }
}

TEST_P(PortTest, DropsInTheKernelWhatIsNotAskedForAlsoBehindATag) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    PortOptions o = options("right");
    o.filter.ethertypes = {kSv, kGoose};
    o.filter.app_ids = {0x4001, 0x4002};
    o.filter.destinations = {*Mac::parse("01:0C:CD:01:00:01"), *Mac::parse("01:0C:CD:04:00:21"),
                             *Mac::parse("01:0C:CD:04:00:22")};
    Port sut = open(o);
    for (std::size_t tags = 0; tags < 3; ++tags) {
        sender.send(frame(0, 0x0800, 0x4001, tags));
        sender.send(frame(1, kSv, 0x4000, tags));
        sender.send(frame(2, kSv, 0x4001, tags));
        sender.send(frame(3, kGoose, 0x4002, tags));
        sender.send(frame(4, 0x88B9, 0x4002, tags));
        Buffer other = frame(5, kSv, 0x4001, tags);
        other[5] = 0x23;
        sender.send(other);
        Buffer another = frame(6, kSv, 0x4001, tags);
        another[1] = 0x0D;
        sender.send(another);
        auto const frames = receive(sut, 2);
        ASSERT_EQ(frames.size(), 2U) << tags << " tags";
        EXPECT_EQ(number_of(frames[0]), 2U);
        EXPECT_EQ(number_of(frames[1]), 3U);
        EXPECT_EQ(waiting(sut), 0U);
    }
    EXPECT_EQ(sut.counters().filtered, 0U) << "the kernel decided";
}

/// An empty datagram of UDP over IPv4, with `options` words behind the header's twenty octets.
Buffer datagram(std::uint16_t port, std::size_t options, std::size_t tags) {
    iec61850::RoutableAddress address;
    address.destination = *Mac::parse("01:00:5E:01:01:01");
    address.ip_destination = {239, 1, 1, 1};
    Buffer out = iec61850::udp_frame(address, Buffer{0xA1, 0, 0, 0});
    out.insert(out.begin() + 14 + 20, 4 * options, std::uint8_t{0});
    out[14] = static_cast<std::uint8_t>(0x45 + options);
    iec61850::store_be(out.data() + 14 + 2, static_cast<std::uint16_t>(out.size() - 14));
    iec61850::store_be(out.data() + 14 + 20 + 4 * options + 2, port);
    for (std::size_t tag = 0; tag < tags; ++tag) {
        Buffer const octets{0x81, 0, 0x80, 5};
        out.insert(out.begin() + 12, octets.begin(), octets.end());
    }
    return out;
}

TEST_P(PortTest, TakesStreamsOverUdpBesideThoseOfEthernetAndNoOtherIp) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    PortOptions o = options("right");
    o.filter.ethertypes = {kSv};
    o.filter.app_ids = {0x4001};
    o.filter.routable = true;
    Port sut = open(o);
    std::vector<Buffer> wanted, others{frame(0, kGoose, 0x4001), frame(0, kSv, 0x4002)};
    for (std::size_t tags = 0; tags < 3; ++tags) {
        for (std::size_t const options : {0U, 1U, 10U}) {
            wanted.push_back(datagram(iec61850::kRoutablePort, options, tags));
            others.push_back(datagram(53, options, tags));
            Buffer tcp = datagram(iec61850::kRoutablePort, options, tags);
            tcp[14 + 4 * tags + 9] = 6;
            others.push_back(tcp);
        }
        wanted.push_back(frame(0, kSv, 0x4001, tags));
    }
    for (Buffer const& other : others) {
        EXPECT_FALSE(o.filter.matches(other));
        sender.send(other);
    }
    for (Buffer const& one : wanted) {
        EXPECT_TRUE(o.filter.matches(one));
        sender.send(one);
    }
    EXPECT_EQ(receive(sut, wanted.size()), wanted);
    EXPECT_EQ(waiting(sut), 0U);
    EXPECT_EQ(sut.counters().filtered, 0U) << "the kernel decided";
}

TEST_P(PortTest, DoesNotHearItselfAndHearsTheLoopbackOnce) {
    Port left = open(options("left"));
    ASSERT_TRUE(left.send(frame(1)));
    EXPECT_EQ(waiting(left), 0U);
    Port loop = open(options("lo"));
    ASSERT_TRUE(loop.send(frame(2)));
    EXPECT_EQ(receive(loop, 1).size(), 1U);
    EXPECT_EQ(waiting(loop), 0U);
    PortOptions o = options("left");
    o.include_outgoing = true;
    Port recorder = open(o);
    ASSERT_TRUE(left.send(frame(3)));
    EXPECT_EQ(waiting(recorder), 1U) << "unless it is asked to";
}

TEST_P(PortTest, StampsFramesWhenTheKernelReceivesThem) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    Port sut = open(options("right"));
    std::int64_t const before = now_ns();
    for (std::uint32_t i = 0; i < 10; ++i) {
        sender.send(frame(i));
    }
    std::vector<std::int64_t> stamps;
    ASSERT_EQ(receive(sut, 10, &stamps).size(), 10U);
    std::int64_t const after = now_ns();
    EXPECT_TRUE(std::is_sorted(stamps.begin(), stamps.end()));
    EXPECT_GE(stamps.front(), before);
    EXPECT_LE(stamps.back(), after);
}

TEST_P(PortTest, CountsWhatItCouldNotFetchInTime) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    PortOptions o = options("right");
    o.ring_frames = 256;
    o.receive_buffer = 64U << 10U;
    Port sut = open(o);
    std::vector<Buffer> const frames(1000, frame(1));
    std::vector<Octets> const views(frames.begin(), frames.end());
    ASSERT_EQ(sender.send(views), 1000U);
    std::size_t const fetched = waiting(sut);
    EXPECT_LT(fetched, 1000U);
    EXPECT_EQ(fetched + sut.counters().dropped, 1000U);
    EXPECT_EQ(sut.counters().received, fetched);
    EXPECT_EQ(sut.counters().dropped + fetched, 1000U) << "asking twice changes nothing";
}

TEST_P(PortTest, AFloodByOthersTakesNoRoomFromFramesOfTheRun) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    PortOptions o = options("right");
    o.ring_frames = 256;
    o.receive_buffer = 1U << 20U;
    o.own_sources = {0x02, 0x47, 0x53};
    Port sut = open(o);
    Buffer own = frame(1, kSv, 0x4000, 1), other = frame(2);
    std::copy_n(o.own_sources->begin(), 3, own.begin() + 6);
    constexpr std::size_t kFlood = 10'000, kOwn = 100;
    for (std::size_t i = 0; i < kFlood; ++i) { // and nobody fetches
        ASSERT_TRUE(sender.send(Octets{other}));
        if (i % (kFlood / kOwn) == 0) {
            ASSERT_TRUE(sender.send(Octets{own}));
        }
    }
    ASSERT_TRUE(sut.wait(1'000'000'000));
    std::vector<ReceivedFrame> batch(64);
    std::size_t owns = 0, others = 0;
    for (std::size_t n = 0; (n = sut.receive(batch)) > 0;) {
        for (std::size_t i = 0; i < n; ++i) {
            bool const is_own = number_of(batch[i].octets) == 1;
            EXPECT_TRUE(!is_own || others == 0) << "its own come first";
            ++(is_own ? owns : others);
        }
    }
    EXPECT_EQ(owns, kOwn);
    EXPECT_GT(others, 0U);
    EXPECT_EQ(others + sut.counters().others_dropped, kFlood);
    EXPECT_EQ(sut.counters().dropped, 0U);
    ASSERT_TRUE(sender.send(Octets{other})) << "who has no frames of the run waiting is woken by others, too";
    EXPECT_TRUE(sut.wait(1'000'000'000));
    EXPECT_EQ(sut.receive(batch), 1U);
}

TEST_P(PortTest, IsNotDisturbedByAStormOfForeignFrames) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    PortOptions o = options("right");
    o.filter.app_ids = {0x4001};
    Port sut = open(o);
    constexpr std::size_t kForeign = 100'000, kEvery = 100;
    std::vector<Buffer> storm(kEvery, frame(0, kSv, 0x5555));
    std::vector<Octets> batch;
    std::uint32_t ours = 0, expected = 0;
    std::vector<ReceivedFrame> received(64);
    Buffer own;
    for (std::size_t sent = 0; sent < kForeign; sent += kEvery) {
        batch.assign(storm.begin(), storm.end());
        own = frame(ours++, kSv, 0x4001);
        batch.push_back(own);
        ASSERT_EQ(sender.send(batch), kEvery + 1);
        for (std::size_t n = sut.receive(received), i = 0; i < n; ++i) {
            EXPECT_EQ(number_of(received[i].octets), expected++);
        }
    }
    ASSERT_TRUE(sender.send(frame(ours++, kSv, 0x4001)));
    ASSERT_TRUE(sut.wait(1'000'000'000));
    EXPECT_EQ(sut.foreign(), kForeign) << "what waits to be fetched is not foreign";
    for (Buffer const& rest : receive(sut, ours - expected)) {
        EXPECT_EQ(number_of(rest), expected++);
    }
    EXPECT_EQ(expected, kForeign / kEvery + 1);
    EXPECT_EQ(sut.counters().dropped, 0U);
    EXPECT_EQ(sut.foreign(), kForeign) << "kept away, and counted";
}

TEST_P(PortTest, SurvivesALinkThatGoesDownAndComesBack) {
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    Port sut = open(options("right"));
    EXPECT_EQ(sut.maintain(), LinkState::up);
    ip("link set left down");
    for (int i = 0; i < 5000 && sut.maintain() != LinkState::down; ++i) {
        ::usleep(1000); // the kernel tells of a lost carrier up to a second later
    }
    EXPECT_EQ(sut.maintain(), LinkState::down);
    EXPECT_FALSE(sender.send(frame(1)));
    EXPECT_EQ(sender.counters().send_failed, 1U);
    EXPECT_EQ(sender.counters().send_error, ENETDOWN);
    EXPECT_EQ(waiting(sut), 0U);
    ip("link set right down");
    EXPECT_FALSE(sut.wait(1));
    EXPECT_EQ(waiting(sut), 0U);
    ip("link set right up");
    ip("link set left up");
    wait_until_frames_pass("left", "right");
    for (int i = 0; i < 5000 && sut.maintain() != LinkState::up; ++i) {
        ::usleep(1000);
    }
    ASSERT_EQ(sut.maintain(), LinkState::up);
    ASSERT_TRUE(sender.send(frame(2)));
    auto const frames = receive(sut, 1);
    ASSERT_EQ(frames.size(), 1U);
    EXPECT_EQ(number_of(frames[0]), 2U);
}

TEST_P(PortTest, ComesBackWithAnInterfaceThatWasRemoved) {
    Port sut = open(options("right"));
    ip("link del left");
    EXPECT_EQ(sut.maintain(), LinkState::missing);
    EXPECT_EQ(sut.fd(), -1);
    EXPECT_EQ(waiting(sut), 0U);
    EXPECT_FALSE(sut.wait(1));
    EXPECT_FALSE(sut.send(frame(1)));
    EXPECT_EQ(sut.maintain(), LinkState::missing);
    SetUp();
    EXPECT_NE(sut.maintain(), LinkState::missing);
    EXPECT_EQ(sut.counters().reconnects, 1U);
    std::uint64_t const foreign = sut.foreign();
    Port sender = open({.interface = "left", .filter = {}, .receive = false});
    ASSERT_TRUE(sender.send(frame(2)));
    EXPECT_EQ(receive(sut, 1).size(), 1U);
    ASSERT_TRUE(sender.send(frame(3, kGoose)));
    EXPECT_EQ(sut.foreign(), foreign + 1) << "counts go on behind a new interface of the name";
}

TEST_P(PortTest, LetsGoOfAnInterfaceThatIsCalledSomethingElseNow) {
    Port sut = open(options("right"));
    ip("link set right down");
    ip("link set right name renamed");
    EXPECT_EQ(sut.maintain(), LinkState::renamed);
    EXPECT_EQ(sut.fd(), -1);
    ip("link set renamed name right");
    ip("link set right up");
    EXPECT_NE(sut.maintain(), LinkState::missing);
    EXPECT_GE(sut.fd(), 0);
}

using PortErrors = Veth;

TEST_F(PortErrors, NamesAnInterfaceThatDoesNotExist) {
    for (std::size_t const length : {0U, 3U, 15U, 16U, 17U, 4096U}) {
        auto const port = Port::open(options(std::string(length, 'x')));
        ASSERT_FALSE(port) << length;
        EXPECT_EQ(port.error().code, ExitCode::environment);
        EXPECT_THAT(port.error().message, testing::HasSubstr("there is no network interface"));
        EXPECT_THAT(port.error().remedy, testing::HasSubstr("left"));
    }
}

TEST_F(PortErrors, KnowsAVirtualCableFromAnythingElse) {
    EXPECT_EQ(interface_kind("left"), "veth");
    ip("link add bridge type bridge");
    EXPECT_EQ(interface_kind("bridge"), "bridge");
    EXPECT_EQ(interface_kind("lo"), "");
    EXPECT_EQ(interface_kind("absent"), "");
    EXPECT_EQ(interface_kind(std::string(4096, 'x')), "");
}

TEST_F(PortErrors, NamesTheCapabilityAndTheCommandThatGrantsIt) {
    int result[2];
    ASSERT_EQ(::pipe(result), 0);
    pid_t const pid = ::fork();
    if (pid == 0) { // the parent keeps its capabilities
        __user_cap_header_struct header{_LINUX_CAPABILITY_VERSION_3, 0};
        __user_cap_data_struct none[2]{};
        ::syscall(SYS_capset, &header, none);
        auto const port = Port::open(options("left"));
        std::string const text = port ? "opened" : describe(port.error());
        [[maybe_unused]] auto const written = ::write(result[1], text.data(), text.size());
        ::_exit(0);
    }
    ::close(result[1]);
    char text[1024]{};
    [[maybe_unused]] auto const size = ::read(result[0], text, sizeof text - 1);
    ::waitpid(pid, nullptr, 0);
    ::close(result[0]);
    EXPECT_THAT(text, testing::AllOf(testing::HasSubstr("CAP_NET_RAW"), testing::HasSubstr("setcap cap_net_raw+ep /"),
                                     testing::HasSubstr("on a board as its service or as root")));
}

TEST_F(PortErrors, DecidesTheSameInUserSpaceAsInTheKernel) {
    FrameFilter sut;
    sut.ethertypes = {kSv};
    sut.app_ids = {0x4001};
    for (std::size_t tags = 0; tags < 3; ++tags) {
        EXPECT_TRUE(sut.matches(frame(0, kSv, 0x4001, tags)));
        EXPECT_FALSE(sut.matches(frame(0, kSv, 0x4002, tags)));
        EXPECT_FALSE(sut.matches(frame(0, kGoose, 0x4001, tags)));
    }
    for (std::size_t size = 0; size < 64; ++size) {
        Buffer cut = frame(0, kSv, 0x4001, 1);
        cut.resize(size);
        EXPECT_EQ(sut.matches(cut), size >= 20) << size;
    }
    sut.destinations.assign(100, *Mac::parse("01:0C:CD:04:00:22"));
    EXPECT_FALSE(sut.kernel_decides()) << "too many for the jumps of its language";
    EXPECT_FALSE(sut.matches(frame(0, kSv, 0x4001)));
    sut.destinations.push_back(*Mac::parse("01:0C:CD:04:00:21"));
    EXPECT_TRUE(sut.matches(frame(0, kSv, 0x4001)));
    Port sender = *Port::open({.interface = "left", .filter = {}, .receive = false});
    PortOptions o = options("right");
    o.filter = sut;
    Port port = *Port::open(o);
    sender.send(frame(1, kSv, 0x4001));
    sender.send(frame(2, kSv, 0x4002));
    EXPECT_EQ(receive(port, 1).size(), 1U);
    EXPECT_EQ(waiting(port), 0U);
}

TEST_F(PortErrors, TheKernelTakesADatagramOfOursAsItsOwnWhereAGroupIsJoined) { // with its checksums
    GroupMembership groups;
    iec61850::Ipv4 const group{239, 192, 0, 2};
    groups.join("right", group);
    UniqueFd const socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
    sockaddr_in at{};
    at.sin_family = AF_INET;
    at.sin_port = htons(iec61850::kRoutablePort);
    std::memcpy(&at.sin_addr, group.data(), group.size());
    timeval const patience{5, 0};
    ::setsockopt(socket.get(), SOL_SOCKET, SO_RCVTIMEO, &patience, sizeof patience);
    ASSERT_EQ(::bind(socket.get(), reinterpret_cast<sockaddr const*>(&at), sizeof at), 0) << std::strerror(errno);
    iec61850::RoutableAddress address;
    address.ip_destination = group;
    address.ip_source = {10, 0, 0, 1};
    address.destination = address.group();
    Buffer const payload{1, 0x40, 0xA1, 0, 7};
    Port sender = *Port::open({.interface = "left", .filter = {}, .receive = false});
    Buffer damaged = iec61850::udp_frame(address, payload);
    damaged.back() = 8;
    ASSERT_TRUE(sender.send(damaged));
    ASSERT_TRUE(sender.send(iec61850::udp_frame(address, payload)));
    Buffer received(100);
    auto const size = ::recv(socket.get(), received.data(), received.size(), 0);
    ASSERT_GT(size, 0) << std::strerror(errno);
    received.resize(static_cast<std::size_t>(size));
    EXPECT_EQ(received, payload) << "and not the one whose checksum is wrong";
}

} // namespace
} // namespace gridspace::ethernet
