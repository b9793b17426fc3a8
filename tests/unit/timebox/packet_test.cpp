// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/random.hpp"
#include "common/unique_fd.hpp"
#include "timebox/packet_socket.hpp"

#include <gmock/gmock.h>
#include <linux/if_ether.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

constexpr std::array<std::uint8_t, 6> kOwn{2, 0x47, 0x53, 2, 0, 4};

std::vector<std::uint8_t> octets_of(std::initializer_list<int> head, std::size_t size = 60) {
    std::vector<std::uint8_t> out(head.begin(), head.end());
    out.resize(size);
    return out;
}

/// What the kernel does with a frame behind a filter: the octets that it keeps; 0: it drops it. Nothing: it refuses the
/// filter.
std::optional<std::size_t> kernel(std::vector<sock_filter> program, std::vector<std::uint8_t> const& frame) {
    std::array<int, 2> ends{};
    EXPECT_EQ(::socketpair(AF_UNIX, SOCK_DGRAM, 0, ends.data()), 0);
    UniqueFd const from{ends[0]}, to{ends[1]};
    sock_fprog const filter{static_cast<unsigned short>(program.size()), program.data()};
    if (::setsockopt(to.get(), SOL_SOCKET, SO_ATTACH_FILTER, &filter, sizeof filter) != 0) {
        return std::nullopt;
    }
    (void)!::send(from.get(), frame.data(), frame.size(), MSG_DONTWAIT);
    std::array<std::uint8_t, 2048> buffer{};
    ssize_t const size = ::recv(to.get(), buffer.data(), buffer.size(), MSG_DONTWAIT);
    return static_cast<std::size_t>(std::max<ssize_t>(size, 0));
}

sock_filter random_statement(Random& random, std::size_t left) {
    auto const pick = [&](std::initializer_list<int> of) {
        return static_cast<std::uint16_t>(*(of.begin() + static_cast<std::ptrdiff_t>(random.below(of.size()))));
    };
    auto const k = static_cast<std::uint32_t>(random.chance(0.8) ? random.below(70) : random.next());
    auto const jump = [&] { return static_cast<std::uint8_t>(random.below(std::min<std::size_t>(left, 4) + 1)); };
    switch (random.below(7)) {
    case 0:
        return {static_cast<std::uint16_t>(BPF_LD | pick({BPF_W, BPF_H, BPF_B}) | pick({BPF_ABS, BPF_IND})), 0, 0, k};
    case 1:
        return {pick({BPF_LD | BPF_IMM, BPF_LD | BPF_W | BPF_LEN, BPF_LDX | BPF_IMM, BPF_LDX | BPF_W | BPF_LEN,
                      BPF_LDX | BPF_B | BPF_MSH, BPF_MISC | BPF_TAX, BPF_MISC | 0x80}),
                0, 0, k};
    case 2: // a word of memory must have been written first
        return {pick({BPF_ST, BPF_STX}), 0, 0, k % 20};
    case 3:
    case 4:
        return {static_cast<std::uint16_t>(
                    BPF_ALU | pick({BPF_ADD, BPF_SUB, BPF_MUL, BPF_DIV, BPF_MOD, BPF_OR, BPF_AND, BPF_XOR, BPF_NEG}) |
                    pick({BPF_K, BPF_X})),
                0, 0, k};
    case 5:
        return {
            static_cast<std::uint16_t>(BPF_JMP | pick({BPF_JEQ, BPF_JGT, BPF_JGE, BPF_JSET}) | pick({BPF_K, BPF_X})),
            jump(), jump(), k};
    default:
        return {pick({BPF_RET | BPF_K, BPF_RET | 0x10}), 0, 0, k};
    }
}

TEST(PacketFilter, KeepsOfAFrameWhatTheKernelKeeps) {
    Random random{1};
    int compared = 0, kept = 0;
    for (int round = 0; round < 4000; ++round) {
        std::vector<sock_filter> program;
        std::size_t const size = 1 + random.below(12);
        for (std::size_t i = 0; i + 1 < size; ++i) {
            program.push_back(random_statement(random, size - i - 2));
        }
        program.push_back({static_cast<std::uint16_t>(BPF_RET | (random.chance(0.5) ? 0x10 : BPF_K)), 0, 0, 60});
        std::vector<std::uint8_t> frame(20 + random.below(80));
        std::generate(frame.begin(), frame.end(), [&] { return static_cast<std::uint8_t>(random.next()); });
        auto const expected = kernel(program, frame);
        auto const sut = PacketFilter::make(program);
        if (!expected || !sut) { // ours refuses more: what would have to be known of the kernel
            EXPECT_TRUE(expected || !sut) << "the kernel refuses program " << round;
            continue;
        }
        FilterInput input;
        input.octets = frame;
        ASSERT_EQ(std::min<std::size_t>(sut->run(input), frame.size()), *expected) << "program " << round;
        ++compared;
        kept += *expected > 0 ? 1 : 0;
    }
    EXPECT_GT(compared, 2000);
    EXPECT_GT(kept, 500);
}

TEST(PacketFilter, RefusesWhatItDoesNotKnow) {
    sock_filter const all{BPF_RET | BPF_K, 0, 0, 0xFFFF};
    auto const random_number = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_RANDOM);
    EXPECT_FALSE(PacketFilter::make({{BPF_LD | BPF_W | BPF_ABS, 0, 0, random_number}, all}));
    EXPECT_FALSE(PacketFilter::make({{BPF_JMP | BPF_JA, 0, 0, 5}, all}));
    EXPECT_FALSE(PacketFilter::make({}));
    EXPECT_TRUE(PacketFilter::make({all}));
}

TEST(PacketFilter, SeesTheTagThatTheKernelHasTakenOut) {
    auto const present = static_cast<std::uint32_t>(SKF_AD_OFF + SKF_AD_VLAN_TAG_PRESENT);
    auto const sut = PacketFilter::make({{BPF_LD | BPF_W | BPF_ABS, 0, 0, present}, {BPF_RET | 0x10, 0, 0, 0}});
    ASSERT_TRUE(sut);
    FilterInput input;
    EXPECT_EQ(sut->run(input), 0U);
    input.vlan_tci = 0x8000;
    EXPECT_EQ(sut->run(input), 1U);
}

TEST(PacketFrame, HasItsTagBesideIt) {
    auto const sut = packet_frame(
        7, octets_of({1, 0x0C, 0xCD, 4, 0, 0x21, 2, 2, 2, 2, 2, 2, 0x81, 0, 0x80, 5, 0x88, 0xBA, 0x40}), kOwn, false);
    EXPECT_EQ(sut.vlan_tci, 0x8005);
    EXPECT_EQ(sut.vlan_protocol, ETH_P_8021Q);
    EXPECT_EQ(sut.protocol, 0x88BA);
    EXPECT_EQ(sut.octets.size(), 56U);
    EXPECT_EQ(sut.octets[14], 0x40);
    EXPECT_EQ(sut.type, PACKET_MULTICAST);
    auto const plain = octets_of({2, 0x47, 0x53, 2, 0, 4, 2, 2, 2, 2, 2, 2, 0x88, 0xB8});
    EXPECT_EQ(packet_frame(7, plain, kOwn, false).vlan_tci, std::nullopt);
    EXPECT_EQ(packet_frame(7, plain, kOwn, false).type, PACKET_HOST);
    EXPECT_EQ(packet_frame(7, plain, {}, false).type, PACKET_OTHERHOST);
    EXPECT_EQ(packet_frame(7, plain, kOwn, true).type, PACKET_OUTGOING);
}

TEST(PacketSocket, TakesTheFramesOfItsProtocolAndInterfaceAndWhatLeavesOnlyWhenItListensToAll) {
    PacketSocket sut;
    auto const frame = [](bool outgoing) {
        return packet_frame(0, octets_of({2, 0, 0, 0, 0, 1, 2, 0, 0, 0, 0, 2, 0x88, 0xB8}), kOwn, outgoing);
    };
    EXPECT_FALSE(sut.wants(frame(false), 3)) << "it is not bound";
    sut.protocol = 0x88B8;
    EXPECT_TRUE(sut.wants(frame(false), 3));
    EXPECT_FALSE(sut.wants(frame(true), 3));
    sut.interface = 4;
    EXPECT_FALSE(sut.wants(frame(false), 3));
    sut.interface = 3;
    sut.protocol = ETH_P_ALL;
    EXPECT_TRUE(sut.wants(frame(true), 3));
    sut.ignores_outgoing = true;
    EXPECT_FALSE(sut.wants(frame(true), 3));
}

TEST(PacketSocket, LosesWhatDoesNotFitIntoItsBuffer) {
    PacketSocket sut;
    sut.room = 2000;
    auto const frame = packet_frame(0, octets_of({2}, 100), kOwn, false);
    EXPECT_TRUE(sut.push(frame));
    EXPECT_TRUE(sut.push(frame));
    EXPECT_FALSE(sut.push(frame));
    (void)sut.pop();
    EXPECT_TRUE(sut.push(frame));
}

} // namespace
} // namespace gridspace::timebox
