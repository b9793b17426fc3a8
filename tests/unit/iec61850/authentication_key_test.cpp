// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/authentication_key.hpp"

#include <gtest/gtest.h>

namespace gridspace::iec61850 {
namespace {

constexpr std::int64_t kStart = 1'700'000'000'000'000'000;
constexpr char const* kSecret = "000102030405060708090a0b0c0d0e0f";

Result<std::vector<KeyEntry>> parse(std::string const& text) {
    return parse_keys(text, "a.keys", kStart);
}

TEST(KeyFile, HoldsIdsSecretsAndTimesOfBothKinds) {
    auto const sut = parse(std::string{"# first\n\n1 "} + kSecret + " until=10.5 # old\r\n2\t" + kSecret +
                           " from=2026-11-24T05:00:00Z");
    ASSERT_TRUE(sut) << sut.error().message;
    ASSERT_EQ(sut->size(), 2U);
    EXPECT_EQ((*sut)[0].id, 1U);
    EXPECT_EQ((*sut)[0].secret[15], 15);
    EXPECT_EQ((*sut)[0].until_ns, kStart + 10'500'000'000);
    EXPECT_EQ((*sut)[1].from_ns, 1795496400'000'000'000);
}

TEST(KeyFile, MistakesNameTheLineAndNeverTheSecret) {
    for (auto const& [line, what] : std::vector<std::pair<std::string, std::string>>{
             {std::string{"0 "} + kSecret, "key id"},
             {std::string{"x "} + kSecret, "key id"},
             {"1", "secret"},
             {"1 0011", "secret"},
             {std::string{"1 "} + kSecret + "0", "secret"},
             {"1 zz0102030405060708090a0b0c0d0e0f", "secret"},
             {std::string{"1 "} + kSecret + " from=soon", "from=TIME"},
             {std::string{"1 "} + kSecret + " from=2026-02-30T00:00:00Z", "from=TIME"},
             {std::string{"1 "} + kSecret + " whenever", "from=TIME"},
             {std::string{"1 "} + kSecret + " from=2 until=1", "ends before"},
             {std::string{"9 "} + kSecret, "twice"}}) {
        auto const sut = parse(std::string{"9 "} + kSecret + "\n" + line);
        ASSERT_FALSE(sut) << line;
        EXPECT_TRUE(sut.error().message.starts_with("a.keys:2: ")) << sut.error().message;
        EXPECT_NE(sut.error().message.find(what), std::string::npos) << sut.error().message;
        EXPECT_EQ(sut.error().message.find("0102030405"), std::string::npos) << sut.error().message;
    }
    EXPECT_FALSE(parse("# nothing\n"));
}

TEST(KeyFile, SecondsOfSimulatedTimeNeedAKnownStart) {
    EXPECT_FALSE(parse_keys(std::string{"1 "} + kSecret + " from=1", "a.keys", std::nullopt));
    EXPECT_TRUE(parse_keys(std::string{"1 "} + kSecret + " from=2026-11-24T05:00:00Z", "a.keys", std::nullopt));
}

TEST(KeyRing, SendsWithTheNewestValidKeyAndTakesBothWhileTheyOverlap) {
    auto const entries = parse(std::string{"2 "} + kSecret + " from=10\n1 " + kSecret + " until=12");
    auto sut = KeyRing::create(crypto::CodeKind::hmac_sha256, *entries);
    ASSERT_TRUE(sut);
    auto const at = [](double s) { return kStart + static_cast<std::int64_t>(s * 1e9); };
    EXPECT_EQ(sut->to_send_with(at(9.999))->id, 1U);
    EXPECT_EQ(sut->to_send_with(at(10))->id, 2U);
    EXPECT_TRUE(sut->find(1)->valid(at(11)));
    EXPECT_FALSE(sut->find(1)->valid(at(12)));
    EXPECT_FALSE(sut->find(2)->valid(at(9)));
    EXPECT_EQ(sut->next_change_ns(at(0)), at(10));
    EXPECT_EQ(sut->find(3), nullptr);
}

TEST(KeyRing, NamesTheKeyThatDoesNotSuitTheAlgorithm) {
    auto const entries = parse(std::string{"77 "} + kSecret + "0011");
    EXPECT_TRUE(KeyRing::create(crypto::CodeKind::hmac_sha256, *entries));
    auto const sut = KeyRing::create(crypto::CodeKind::aes_gmac, *entries);
    ASSERT_FALSE(sut);
    EXPECT_EQ(sut.error().message, "key 77: a key of 18 octets for AES-GMAC");
}

} // namespace
} // namespace gridspace::iec61850
