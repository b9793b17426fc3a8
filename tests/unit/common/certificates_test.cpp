// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/crypto/certificates.hpp"

#include <gmock/gmock.h>

namespace gridspace::crypto {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;

constexpr Validity kValid{1'700'000'000, 1'800'000'000};

Identity authority(char const* name = "identities") {
    auto made = make_authority(name, kValid);
    EXPECT_TRUE(made) << describe(made.error());
    return made.value_or(Identity{});
}
Identity issued(Identity const& by, char const* name) {
    auto made = issue(by, name, kValid);
    EXPECT_TRUE(made) << describe(made.error());
    return made.value_or(Identity{});
}

TEST(Certificates, SayTheirOwnerAndTheirTime) {
    auto const sut = facts_of(issued(authority(), "relay2").certificate);
    ASSERT_TRUE(sut) << describe(sut.error());
    EXPECT_EQ(sut->subject, "CN=relay2,O=Gridspace");
    EXPECT_EQ(sut->name, "relay2");
    EXPECT_EQ(sut->valid.from_unix_s, kValid.from_unix_s);
    EXPECT_EQ(sut->valid.until_unix_s, kValid.until_unix_s);
}

TEST(Certificates, AreSignedByTheirAuthorityAndByNobodyElse) {
    Identity const own = authority(), other = authority();
    Identity const sut = issued(own, "ev1");
    EXPECT_TRUE(is_signed_by(sut.certificate, own.certificate));
    EXPECT_FALSE(is_signed_by(sut.certificate, other.certificate)); // of the same name
    EXPECT_FALSE(is_signed_by("no certificate", own.certificate));
}

TEST(Certificates, TwoOfOneNameHaveDifferentSerialNumbersAndKeys) {
    Identity const own = authority();
    Identity const first = issued(own, "ev1"), second = issued(own, "ev1");
    EXPECT_NE(facts_of(first.certificate)->serial, facts_of(second.certificate)->serial);
    EXPECT_NE(first.key, second.key);
}

TEST(Certificates, ANameOfMoreThan64CharactersIsRefusedByItsLength) {
    auto const sut = issue(authority(), std::string(65, 'a'), kValid);
    ASSERT_FALSE(sut);
    EXPECT_THAT(sut.error().message, HasSubstr("65 characters"));
    EXPECT_TRUE(issue(authority(), std::string(64, 'a'), kValid));
}

TEST(Certificates, TheListOfRevokedOnesHoldsWhatWasPutIntoItAndIsItsAuthoritys) {
    Identity const own = authority();
    std::string const serial = facts_of(issued(own, "ev1").certificate)->serial;
    auto const list = revocation_list(own, std::vector{serial}, kValid);
    ASSERT_TRUE(list) << describe(list.error());
    EXPECT_THAT(revoked_serials(*list, own.certificate).value(), ElementsAre(serial));
    EXPECT_FALSE(revoked_serials(*list, authority().certificate));
    EXPECT_TRUE(revoked_serials(revocation_list(own, {}, kValid).value(), own.certificate)->empty());
    EXPECT_FALSE(revocation_list(own, std::vector<std::string>{"no number"}, kValid));
}

TEST(Certificates, ADocumentIsReadableAndHasASignatureBehindIt) {
    auto const sut = sign_document(authority("permissions"), "<dds>\n</dds>\n");
    ASSERT_TRUE(sut) << describe(sut.error());
    EXPECT_THAT(*sut, HasSubstr("multipart/signed"));
    EXPECT_THAT(*sut, HasSubstr("<dds>"));
    EXPECT_THAT(*sut, HasSubstr("smime.p7s"));
}

TEST(Certificates, WhatIsNoKeyOrCertificateIsAnErrorAndNoCrash) {
    EXPECT_FALSE(issue({"", ""}, "ev1", kValid));
    EXPECT_FALSE(facts_of("-----BEGIN CERTIFICATE-----\nAAAA\n-----END CERTIFICATE-----\n"));
    EXPECT_FALSE(sign_document({authority().certificate, "no key"}, "text"));
}

} // namespace
} // namespace gridspace::crypto
