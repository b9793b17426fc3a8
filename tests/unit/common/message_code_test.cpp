// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/crypto/message_code.hpp"

#include <gtest/gtest.h>
#include <string>
#include <vector>

namespace gridspace::crypto {
namespace {

std::vector<std::uint8_t> octets(std::string const& hex) {
    std::vector<std::uint8_t> out;
    for (std::size_t i = 0; i < hex.size(); i += 2) {
        out.push_back(static_cast<std::uint8_t>(std::stoi(hex.substr(i, 2), nullptr, 16)));
    }
    return out;
}

std::vector<std::uint8_t> computed(CodeKind kind, std::vector<std::uint8_t> const& key,
                                   std::vector<std::uint8_t> const& message,
                                   std::vector<std::uint8_t> const& vector = std::vector<std::uint8_t>(12)) {
    auto sut = MessageCode::create(kind, key);
    EXPECT_TRUE(sut.has_value());
    MessageCode::Code code{};
    // Twice: the first must leave nothing behind.
    EXPECT_TRUE(
        sut->compute(octets("00112233"), MessageCode::Vector{std::vector<std::uint8_t>(12, 7).data(), 12}, code));
    EXPECT_TRUE(sut->compute(message, MessageCode::Vector{vector.data(), 12}, code));
    return {code.begin(), code.begin() + (kind == CodeKind::hmac_sha256 ? 32 : 16)};
}

TEST(MessageCode, AgreesWithTheHmacVectorsOfRfc4231) {
    EXPECT_EQ(computed(CodeKind::hmac_sha256, std::vector<std::uint8_t>(20, 0x0b), octets("4869205468657265")),
              octets("b0344c61d8db38535ca8afceaf0bf12b881dc200c9833da726e9376c2e32cff7"));
    EXPECT_EQ(computed(CodeKind::hmac_sha256, std::vector<std::uint8_t>(20, 0xaa), std::vector<std::uint8_t>(50, 0xdd)),
              octets("773ea91e36800e46854db8ebd09181a72959098b3ef8c122d9635514ced565fe"));
    EXPECT_EQ(computed(CodeKind::hmac_sha256, std::vector<std::uint8_t>(131, 0xaa), // longer than a block
                       octets("54657374205573696e67204c6172676572205468616e20426c6f636b2d53697a65204b6579202d2048617368"
                              "204b6579204669727374")),
              octets("60e431591ee0b67f0d8a26aacbf5b77f8e0bc6213728c5140546040f0ee37f54"));
    EXPECT_EQ(computed(CodeKind::hmac_sha256, octets("0102030405060708090a0b0c0d0e0f10111213141516171819"),
                       std::vector<std::uint8_t>(50, 0xcd)),
              octets("82558a389a443c0ea4cc819899f2083a85f0faa3e578f8077a2e3ff46729665b"));
}

TEST(MessageCode, AgreesWithTheGcmVectorsOfNistWhereNothingIsEncrypted) {
    EXPECT_EQ(computed(CodeKind::aes_gmac, std::vector<std::uint8_t>(16), {}),
              octets("58e2fccefa7e3061367f1d57a4e7455a"));
    EXPECT_EQ(computed(CodeKind::aes_gmac, octets("77be63708971c4e240d1cb79e8d77feb"),
                       octets("7a43ec1d9c0a5a78a0b16533a6213cab"), octets("e0e00f19fed7ba0136a797f3")),
              octets("209fcc8d3675ed938e9c7166709dd946"));
}

TEST(MessageCode, RefusesKeysOfALengthThatTheAlgorithmDoesNotHave) {
    for (std::size_t const length : {0U, 15U}) {
        EXPECT_FALSE(MessageCode::create(CodeKind::hmac_sha256, std::vector<std::uint8_t>(length)));
    }
    for (std::size_t const length : {0U, 15U, 17U, 24U, 33U}) {
        auto const sut = MessageCode::create(CodeKind::aes_gmac, std::vector<std::uint8_t>(length));
        ASSERT_FALSE(sut);
        EXPECT_EQ(sut.error().remedy, "expected 16 or 32 octets");
    }
}

TEST(MessageCode, ComparesLengthAndEveryOctet) {
    EXPECT_TRUE(same_octets(octets("0102"), octets("0102")));
    EXPECT_FALSE(same_octets(octets("0102"), octets("0103")));
    EXPECT_FALSE(same_octets(octets("0102"), octets("010203")));
}

} // namespace
} // namespace gridspace::crypto
