// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/security/key_folder.hpp"

#include <filesystem>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using testing::HasSubstr;

constexpr crypto::Validity kValid{1'700'000'000, 1'800'000'000};
constexpr std::int64_t kNow = 1'750'000'000;

class Keys : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = fs::temp_directory_path() / ("gridspace-keys-" + std::to_string(::getpid()));
        fs::remove_all(folder_);
        auto made = KeyFolder::init(folder_, {"relay", "ev_agent"}, kValid);
        ASSERT_TRUE(made) << describe(made.error());
    }
    void TearDown() override { fs::remove_all(folder_); }
    KeyFolder sut() const {
        auto opened = KeyFolder::open(folder_);
        EXPECT_TRUE(opened) << describe(opened.error());
        return *opened;
    }
    std::string why_not(std::vector<std::string> const& names, std::int64_t now = kNow) const {
        auto const found = sut().find(names, now);
        return found ? "found" : describe(found.error());
    }
    fs::path folder_;
};

TEST_F(Keys, SecretsAreTheirOwnersAlone) {
    std::size_t secrets = 0;
    for (auto const& entry : fs::recursive_directory_iterator{folder_}) {
        if (entry.path().extension() == ".key") {
            struct stat about{};
            ASSERT_EQ(::stat(entry.path().c_str(), &about), 0);
            EXPECT_EQ(about.st_mode & 0777U, 0600U) << entry.path();
            ++secrets;
        }
    }
    EXPECT_EQ(secrets, 4U);
    EXPECT_EQ(fs::status(folder_).permissions() & fs::perms::all, fs::perms::owner_all);
}

TEST_F(Keys, AProcessTakesItsOwnIdentityBeforeThatOfItsRole) {
    EXPECT_EQ(sut().find({"relay2", "relay"}, kNow)->name, "relay");
    ASSERT_TRUE(sut().issue("relay2", kValid));
    auto const found = sut().find({"relay2", "relay"}, kNow);
    EXPECT_EQ(found->name, "relay2");
    EXPECT_EQ(found->facts.subject, "CN=relay2,O=Gridspace");
}

TEST_F(Keys, ItIsSaidWhatIsWrongWithAnIdentity) {
    EXPECT_THAT(why_not({"mcca", "member"}), HasSubstr("no identity for 'mcca', nor for 'member'"));
    EXPECT_THAT(why_not({"relay"}, kValid.until_unix_s + 1), HasSubstr("expired at 2027-01-15"));
    EXPECT_THAT(why_not({"relay"}, kValid.from_unix_s - 1), HasSubstr("not valid before"));
    ASSERT_TRUE(sut().revoke("relay", kValid));
    EXPECT_THAT(why_not({"relay"}), HasSubstr("is revoked"));
    EXPECT_EQ(why_not({"ev_agent"}), "found");
    ASSERT_TRUE(sut().issue("relay", kValid)); // a new certificate has a new number
    EXPECT_EQ(why_not({"relay"}), "found");
}

TEST_F(Keys, AuthoritiesOutliveIdentitiesAndNoIdentityOutlivesThem) {
    std::int64_t const later = kValid.until_unix_s + 1;
    ASSERT_TRUE(sut().issue("relay", {kValid.from_unix_s, later + 1000}));
    EXPECT_EQ(why_not({"relay"}, later), "found");
    EXPECT_THAT(why_not({"ev_agent"}, later), HasSubstr("expired at 2027-01-15"));
    std::int64_t const end = kValid.from_unix_s + kTwentyYears;
    auto const refused = sut().issue("relay", {kValid.from_unix_s, end + 1});
    ASSERT_FALSE(refused);
    EXPECT_THAT(describe(refused.error()), HasSubstr("would outlive the authority"));
    ASSERT_TRUE(sut().issue("relay", {kValid.from_unix_s, end}));
    EXPECT_THAT(why_not({"relay"}, end + 1), HasSubstr("the authority 'identities' of"));
}

TEST_F(Keys, AnIdentityOfAnotherAuthorityIsRefused) {
    fs::path const other = folder_.string() + "-other";
    fs::remove_all(other);
    ASSERT_TRUE(KeyFolder::init(other, {"relay"}, kValid));
    fs::copy_file(other / "identities/relay.pem", folder_ / "identities/relay.pem",
                  fs::copy_options::overwrite_existing);
    fs::remove_all(other);
    EXPECT_THAT(why_not({"relay"}), HasSubstr("not signed by the authority"));
}

TEST_F(Keys, SecretsThatLieOpenAreRefusedByTheirName) {
    fs::permissions(folder_ / "identities/relay.key", fs::perms::group_read, fs::perm_options::add);
    EXPECT_THAT(why_not({"relay"}), HasSubstr("relay.key: others may read or write it (mode 0640)"));
    fs::permissions(folder_ / "permissions_ca.key", fs::perms::others_read, fs::perm_options::add);
    auto const opened = KeyFolder::open(folder_);
    ASSERT_FALSE(opened);
    EXPECT_THAT(opened.error().message, HasSubstr("permissions_ca.key: others may read"));
}

TEST_F(Keys, AFolderIsNeverOverwritten) {
    auto const again = KeyFolder::init(folder_, {}, kValid);
    ASSERT_FALSE(again);
    EXPECT_THAT(again.error().message, HasSubstr("is not an empty folder"));
}

TEST_F(Keys, ANameThatWouldLeaveTheFolderIsRefused) {
    for (char const* name : {"", "../relay", "a/b", ".hidden", "a b"}) {
        EXPECT_FALSE(sut().issue(name, kValid)) << name;
    }
}

} // namespace
} // namespace gridspace::launcher
