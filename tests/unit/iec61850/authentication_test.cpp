// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/authentication.hpp"

#include "gateways/iec61850/goose_template.hpp"
#include "gateways/iec61850/sv_template.hpp"

#include <algorithm>
#include <gtest/gtest.h>

namespace gridspace::iec61850 {
namespace {

constexpr std::int64_t kNow = 1'700'000'000'000'000'000, kMs = 1'000'000;

KeyRing ring(CodeAlgorithm algorithm, std::string const& text = "7 000102030405060708090a0b0c0d0e0f") {
    return std::move(*KeyRing::create(code_kind(algorithm), *parse_keys(text, "k", kNow)));
}

Address address() {
    Address out;
    out.destination = *Mac::parse("01:0C:CD:04:00:21");
    out.source = *Mac::parse("02:47:53:00:00:09");
    out.vlan = VlanTag{};
    out.app_id = 0x4021;
    return out;
}

std::vector<std::uint8_t> sampled_values(bool vlan = true) {
    AsduDescription asdu;
    asdu.sv_id = "MU21";
    asdu.sample_octets = 12;
    Address to = address();
    to.vlan = vlan ? to.vlan : std::nullopt;
    auto const made = SvTemplate::create(to, {asdu});
    return {made->frame().begin(), made->frame().end()};
}

std::vector<std::uint8_t> goose() {
    GooseDescription description;
    description.gocb_ref = "IED2LD0/LLN0$GO$Trip";
    description.dat_set = "IED2LD0/LLN0$Trip";
    description.data_set.members.push_back(DataNode::leaf("status", BasicType::boolean));
    auto made = GooseTemplate::create(address(), description);
    Octets const frame = made->frame({});
    return {frame.begin(), frame.end()};
}

struct Sender {
    KeyRing keys;
    FrameSigner signer;
    std::uint64_t counter{0};
    explicit Sender(CodeAlgorithm a, std::string const& text = "7 000102030405060708090a0b0c0d0e0f")
        : keys{ring(a, text)}, signer{a} {}
    std::vector<std::uint8_t> send(Octets frame, std::int64_t at = kNow) {
        Octets const out = signer.sign(frame, keys, at, counter);
        return {out.begin(), out.end()};
    }
};

constexpr std::array kAll{CodeAlgorithm::hmac_sha256_80, CodeAlgorithm::hmac_sha256_128, CodeAlgorithm::hmac_sha256_256,
                          CodeAlgorithm::aes_gmac_64, CodeAlgorithm::aes_gmac_128};

TEST(Authentication, AFrameOfItsOwnSenderIsGenuineWithEveryAlgorithmAndWithoutAVlanTag) {
    for (CodeAlgorithm const algorithm : kAll) {
        for (auto const& frame : {sampled_values(), sampled_values(false), goose()}) {
            Sender sender{algorithm};
            FrameVerifier sut{algorithm, 2000 * kMs};
            auto keys = ring(algorithm);
            auto const sent = sender.send(frame);
            EXPECT_EQ(sent.size(), frame.size() + extension_octets(algorithm));
            EXPECT_EQ(sut.judge(sent, keys, kNow), Authenticity::genuine);
        }
    }
}

TEST(Authentication, WhoDoesNotKnowItReadsTheFrameAsBefore) {
    auto const sampled = sampled_values(), trip = goose();
    Sender sender{CodeAlgorithm::hmac_sha256_128};
    auto const plain = std::make_unique<SvFrame>(), tagged = std::make_unique<SvFrame>();
    auto const sent = sender.send(sampled);
    ASSERT_TRUE(decode_sv(sampled, *plain));
    ASSERT_TRUE(decode_sv(sent, *tagged));
    EXPECT_EQ(tagged->header.length, plain->header.length);
    EXPECT_TRUE(std::ranges::equal(tagged->header.apdu, plain->header.apdu));
    EXPECT_FALSE(tagged->header.simulated());
    GooseFrame message;
    auto const sent_trip = sender.send(trip);
    ASSERT_TRUE(decode_goose(sent_trip, message));
    EXPECT_EQ(message.gocb_ref, "IED2LD0/LLN0$GO$Trip");
    EXPECT_EQ(message.entries, 1U);
}

TEST(Authentication, EveryOctetFromTheEthertypeOnIsCovered) {
    for (CodeAlgorithm const algorithm : kAll) {
        Sender sender{algorithm};
        auto const sent = sender.send(sampled_values());
        for (std::size_t at = 16; at < sent.size(); ++at) {
            for (std::uint8_t const change : std::array<std::uint8_t, 3>{0x01, 0x80, 0xFF}) {
                auto damaged = sent;
                damaged[at] ^= change;
                FrameVerifier sut{algorithm, 0};
                auto keys = ring(algorithm);
                EXPECT_NE(sut.judge(damaged, keys, kNow), Authenticity::genuine) << "octet " << at;
            }
        }
    }
}

TEST(Authentication, AFrameThatEndsEarlyIsRefusedAndPaddingIsNot) {
    Sender sender{CodeAlgorithm::aes_gmac_128};
    auto const sent = sender.send(goose());
    for (std::size_t size = 0; size < sent.size(); ++size) {
        std::vector<std::uint8_t> const cut(sent.begin(), sent.begin() + static_cast<std::ptrdiff_t>(size));
        FrameVerifier sut{CodeAlgorithm::aes_gmac_128, 0};
        auto keys = ring(CodeAlgorithm::aes_gmac_128);
        EXPECT_EQ(sut.judge(cut, keys, kNow), Authenticity::malformed) << size;
    }
    auto padded = sent;
    padded.resize(sent.size() + 20);
    FrameVerifier sut{CodeAlgorithm::aes_gmac_128, 0};
    EXPECT_EQ(sut.judge(padded, sender.keys, kNow), Authenticity::genuine);
}

TEST(Authentication, WithoutACodeOrWithAnotherKeyAFrameIsNotGenuine) {
    auto const algorithm = CodeAlgorithm::hmac_sha256_128;
    FrameVerifier sut{algorithm, 0};
    auto keys = ring(algorithm);
    EXPECT_EQ(sut.judge(sampled_values(), keys, kNow), Authenticity::untagged);
    Sender stranger{algorithm, "7 ff0102030405060708090a0b0c0d0e0f"};
    EXPECT_EQ(sut.judge(stranger.send(sampled_values()), keys, kNow), Authenticity::wrong_code);
    Sender other_id{algorithm, "8 000102030405060708090a0b0c0d0e0f"};
    EXPECT_EQ(sut.judge(other_id.send(sampled_values()), keys, kNow), Authenticity::unknown_key);
    Sender other_algorithm{CodeAlgorithm::aes_gmac_128};
    EXPECT_EQ(sut.judge(other_algorithm.send(sampled_values()), keys, kNow), Authenticity::wrong_code);
    Sender shorter{CodeAlgorithm::hmac_sha256_80};
    EXPECT_EQ(sut.judge(shorter.send(sampled_values()), keys, kNow), Authenticity::malformed);
}

TEST(Authentication, AnAcceptedFrameIsNotAcceptedAgainNorFromAnotherSourceAddress) {
    auto const algorithm = CodeAlgorithm::hmac_sha256_128;
    Sender sender{algorithm};
    FrameVerifier sut{algorithm, 0};
    auto sent = sender.send(sampled_values());
    EXPECT_EQ(sut.judge(sent, sender.keys, kNow), Authenticity::genuine);
    EXPECT_EQ(sut.judge(sent, sender.keys, kNow), Authenticity::replayed);
    sent[11] ^= 1; // the source address, which the code does not cover
    EXPECT_EQ(sut.judge(sent, sender.keys, kNow), Authenticity::replayed);
}

TEST(Authentication, WhatWasOvertakenIsTakenOnceInAnyOrder) {
    auto const algorithm = CodeAlgorithm::hmac_sha256_128;
    Sender sender{algorithm};
    FrameVerifier sut{algorithm, 0};
    std::vector<std::vector<std::uint8_t>> sent;
    for (int k = 0; k < 300; ++k) {
        sent.push_back(sender.send(sampled_values(), kNow + k * 208'333LL));
    }
    for (std::size_t block = 0; block < sent.size(); block += 10) { // each ten backwards
        for (std::size_t i = 0; i < 10; ++i) {
            EXPECT_EQ(sut.judge(sent[block + 9 - i], sender.keys, kNow), Authenticity::genuine);
        }
    }
    for (auto const& frame : sent) {
        EXPECT_EQ(sut.judge(frame, sender.keys, kNow), Authenticity::replayed);
    }
}

TEST(Authentication, ARecordingPlayedToAReceiverThatHasHeardNothingIsTooOld) {
    auto const algorithm = CodeAlgorithm::aes_gmac_64;
    Sender sender{algorithm};
    auto const recorded = sender.send(goose());
    FrameVerifier sut{algorithm, 2000 * kMs};
    EXPECT_EQ(sut.judge(recorded, sender.keys, kNow + 2001 * kMs), Authenticity::out_of_time);
    EXPECT_EQ(sut.judge(recorded, sender.keys, kNow - 2001 * kMs), Authenticity::out_of_time);
    EXPECT_EQ(sut.judge(recorded, sender.keys, kNow + 1999 * kMs), Authenticity::genuine);
}

TEST(Authentication, KeysAreChangedWithoutLosingAFrame) {
    auto const algorithm = CodeAlgorithm::hmac_sha256_128;
    std::string const schedule =
        "1 000102030405060708090a0b0c0d0e0f until=1.2\n2 ff0102030405060708090a0b0c0d0e0f from=1";
    Sender sender{algorithm, schedule};
    FrameVerifier sut{algorithm, 2000 * kMs};
    auto keys = ring(algorithm, schedule);
    for (int ms = 0; ms < 2000; ms += 10) { // what is sent takes a tenth of a second
        EXPECT_EQ(sut.judge(sender.send(goose(), kNow + ms * kMs), keys, kNow + (ms + 100) * kMs),
                  Authenticity::genuine)
            << ms;
    }
    Sender old{algorithm, "1 000102030405060708090a0b0c0d0e0f"};
    EXPECT_EQ(sut.judge(old.send(goose(), kNow + 1300 * kMs), keys, kNow + 1300 * kMs), Authenticity::invalid_key);
}

TEST(Authentication, WithoutAValidKeyNothingIsSigned) {
    Sender sender{CodeAlgorithm::hmac_sha256_128, "1 000102030405060708090a0b0c0d0e0f from=1 until=2"};
    EXPECT_TRUE(sender.send(goose(), kNow).empty());
    EXPECT_FALSE(sender.send(goose(), kNow + 1500 * kMs).empty());
}

TEST(Authentication, TheCounterIsTheTimeAndNeverTheSameTwice) {
    Sender sender{CodeAlgorithm::aes_gmac_128};
    (void)sender.send(goose());
    EXPECT_EQ(sender.counter, static_cast<std::uint64_t>(kNow / 1000));
    (void)sender.send(sampled_values());
    EXPECT_EQ(sender.counter, static_cast<std::uint64_t>(kNow / 1000 + 1));
}

} // namespace
} // namespace gridspace::iec61850
