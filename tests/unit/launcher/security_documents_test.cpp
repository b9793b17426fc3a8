// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "launcher/security/documents.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <iterator>

namespace gridspace::launcher {
namespace {

using testing::HasSubstr;
using testing::Not;

constexpr crypto::Validity kValid{1'700'000'000, 1'800'000'000};

/// What stands behind `after`, up to the next end of a tag's content.
std::string behind(std::string const& text, std::string const& after) {
    std::size_t const at = text.find(after);
    return at == std::string::npos
               ? ""
               : text.substr(at + after.size(), text.find('<', at + after.size()) - at - after.size());
}

TEST(SecurityDocuments, NobodyWithoutACertificateAndNoTopicWithoutARightByDefault) {
    std::string const sut = governance({}, {4, 5});
    EXPECT_EQ(behind(sut, "<allow_unauthenticated_participants>"), "false");
    EXPECT_EQ(behind(sut, "<enable_join_access_control>"), "true");
    EXPECT_EQ(behind(sut, "<rtps_protection_kind>"), "NONE");
    EXPECT_EQ(behind(sut, "<metadata_protection_kind>"), "ENCRYPT");
    EXPECT_EQ(behind(sut, "<discovery_protection_kind>"), "ENCRYPT");
    EXPECT_THAT(sut, HasSubstr("<id>4</id>\n        <id>5</id>"));
}

TEST(SecurityDocuments, ATopicOfItsOwnStandsBeforeTheRestOfThem) {
    SecuritySettings settings;
    settings.topics = {{"bus_measurements", {Protection::sign, Protection::none}}};
    std::string const sut = governance(settings, {0});
    std::size_t const own = sut.find("<topic_expression>bus_measurements<"), rest = sut.find("<topic_expression>*<");
    ASSERT_NE(own, std::string::npos);
    EXPECT_LT(own, rest);
    EXPECT_EQ(behind(sut.substr(own), "<metadata_protection_kind>"), "SIGN");
    EXPECT_EQ(behind(sut.substr(rest), "<metadata_protection_kind>"), "ENCRYPT");
}

TEST(SecurityDocuments, PermissionsNameWhatIsAllowedAndDenyTheRest) {
    std::string const sut = permissions("CN=ev1,O=Gridspace", {{"requests"}, {"setpoints", "a<b"}}, {0, 1}, kValid);
    EXPECT_EQ(behind(sut, "<subject_name>"), "CN=ev1,O=Gridspace");
    EXPECT_EQ(behind(sut, "<default>"), "DENY");
    EXPECT_EQ(behind(sut, "<not_after>"), "2027-01-15T08:00:00");
    std::size_t const publish = sut.find("<publish>"), subscribe = sut.find("<subscribe>");
    EXPECT_LT(publish, sut.find("<topic>requests</topic>"));
    EXPECT_LT(sut.find("<topic>requests</topic>"), subscribe);
    EXPECT_LT(subscribe, sut.find("<topic>setpoints</topic>"));
    EXPECT_THAT(sut, HasSubstr("<topic>a&lt;b</topic>"));
}

TEST(SecurityDocuments, WhoMayPublishNothingHasNoSuchRule) {
    EXPECT_THAT(permissions("CN=monitor", {{}, {"*"}}, {0}, kValid), Not(HasSubstr("<publish>")));
}

TEST(SecurityDocuments, EachParticipantProfileOfARoleGetsTheKeys) {
    std::ifstream file{source_tree("qos/member.xml")};
    std::string const profiles{std::istreambuf_iterator<char>{file}, {}};
    auto const sut =
        secured_profiles(profiles, {"/k/ca.pem", "/k/pca.pem", "/k/r.crl", "/k/c.pem", "/k/c.key", "/g", "/p"});
    ASSERT_TRUE(sut) << describe(sut.error());
    std::size_t participants = 0, keys = 0;
    for (std::size_t at = 0; (at = sut->find("<participant ", at)) != std::string::npos; ++at) {
        ++participants;
    }
    for (std::size_t at = 0; (at = sut->find("file:///k/c.key", at)) != std::string::npos; ++at) {
        ++keys;
    }
    EXPECT_GE(participants, 2U);
    EXPECT_EQ(keys, participants);
}

TEST(SecurityDocuments, ATextWithoutParticipantsIsRefused) {
    EXPECT_FALSE(secured_profiles("<dds></dds>", {}));
}

} // namespace
} // namespace gridspace::launcher
