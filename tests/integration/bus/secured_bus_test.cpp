// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// DDS Security between real participants: who may join, who may say what, and what nobody can say without keys.
#include "bus/discovery.hpp"
#include "bus/machine.hpp"
#include "bus/participant.hpp"
#include "bus/unauthenticated.hpp"
#include "common/source_tree.hpp"
#include "common/unique_fd.hpp"
#include "launcher/security/documents.hpp"
#include "launcher/security/key_folder.hpp"
#include "tests/integration/veth/veth.hpp"
#include "tests/support/rtps_message.hpp"

#include <arpa/inet.h>
#include <atomic>
#include <ctime>
#include <fstream>
#include <gmock/gmock.h>
#include <iterator>
#include <mutex>
#include <sys/socket.h>
#include <thread>
#include <unistd.h>

namespace gridspace::bus {
namespace {

namespace fs = std::filesystem;
using launcher::KeyFolder;
using launcher::Protection;
using testing::HasSubstr;

std::string text_of(fs::path const& file) {
    std::ifstream stream{file};
    return {std::istreambuf_iterator<char>{stream}, {}};
}

template <class Done>
bool wait_until(Done const& done) {
    auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{60};
    while (!done() && std::chrono::steady_clock::now() < hang) {
        std::this_thread::sleep_for(std::chrono::milliseconds{1});
    }
    return done();
}

/// The GUID prefixes of participants, by the order in which they were found.
class Found final : public DiscoveryObserver {
  public:
    void participant_found(DiscoveredParticipant const& p) override {
        std::lock_guard const lock{mutex_};
        ids_.push_back(p.id);
    }
    void participant_gone(std::string const& id, bool) override {
        std::lock_guard const lock{mutex_};
        std::erase(ids_, id);
        ++gone_;
    }
    void endpoint_found(DiscoveredEndpoint const&) override {}
    void endpoint_gone(std::string const&) override {}
    std::vector<std::string> ids() const {
        std::lock_guard const lock{mutex_};
        return ids_;
    }
    /// How many have gone. Who is alive announces itself again at once, so `ids` alone may never show that it was gone.
    int gone() const {
        std::lock_guard const lock{mutex_};
        return gone_;
    }

  private:
    mutable std::mutex mutex_;
    std::vector<std::string> ids_;
    int gone_{0};
};

struct Joining {
    KeyFolder const* keys{nullptr};
    Protection messages{Protection::none}, data{Protection::none};
    bool knows_revoked{true};
    launcher::Rights rights{{"x"}, {"x"}};
};

class SecuredBus : public ethernet::Veth {
  protected:
    void SetUp() override {
        Veth::SetUp();
        if (IsSkipped()) {
            return;
        }
        folder_ = fs::temp_directory_path() / ("gridspace-secured-bus-" + std::to_string(::getpid()));
        fs::remove_all(folder_);
        keys_ = make_keys("keys");
        on_unauthenticated([this](std::string const& text) {
            std::lock_guard const lock{mutex_};
            told_.push_back(text);
        });
    }
    void TearDown() override {
        on_unauthenticated({});
        fs::remove_all(folder_);
        Veth::TearDown();
    }

    static std::int64_t now() { return std::time(nullptr); }
    static crypto::Validity year() { return {now() - 86400, now() + 31'536'000}; }

    std::unique_ptr<KeyFolder> make_keys(std::string const& name) const {
        auto made = KeyFolder::init(folder_ / name, {"a", "b", "c"}, year());
        EXPECT_TRUE(made) << describe(made.error());
        return made ? std::make_unique<KeyFolder>(std::move(*made)) : nullptr;
    }
    std::string told() const {
        std::lock_guard const lock{mutex_};
        std::string out;
        for (std::string const& text : told_) {
            out += text + "\n";
        }
        return out;
    }

    Result<std::unique_ptr<Participant>> join(std::string const& name, Joining how = {},
                                              DiscoveryObserver* observer = nullptr) {
        KeyFolder const& keys = how.keys != nullptr ? *how.keys : *keys_;
        fs::path const own = folder_ / ("of_" + name + std::to_string(joined_));
        fs::create_directories(own);
        launcher::SecuritySettings settings;
        settings.messages = how.messages;
        settings.all.data = how.data;
        auto const facts = crypto::facts_of(text_of(keys.folder() / "identities" / (name + ".pem")));
        std::ofstream{own / "governance.p7s"}
            << crypto::sign_document(keys.permissions_authority(), launcher::governance(settings, {0})).value();
        std::ofstream{own / "permissions.p7s"}
            << crypto::sign_document(keys.permissions_authority(),
                                     launcher::permissions(facts->subject, how.rights, {0}, year()))
                   .value();
        launcher::SecurityFiles const files{keys.file("identity_ca.pem"),
                                            keys.file("permissions_ca.pem"),
                                            how.knows_revoked ? keys.file("revoked.crl") : fs::path{},
                                            keys.folder() / "identities" / (name + ".pem"),
                                            keys.folder() / "identities" / (name + ".key"),
                                            own / "governance.p7s",
                                            own / "permissions.p7s"};
        std::ofstream{own / "qos.xml"}
            << launcher::secured_profiles(text_of(source_tree("qos/member.xml")), files).value();
        ++joined_;
        return Participant::create({name, 0, "test", 0, own / "qos.xml", "management", {"127.0.0.1"}}, observer);
    }
    Result<std::unique_ptr<Participant>> join_without_keys(std::string const& name) {
        ++joined_;
        return Participant::create({name, 0, "test", 0, source_tree("qos/member.xml"), "management", {"127.0.0.1"}});
    }

    static inline int joined_ = 0; ///< Fast DDS numbers the participants of a process on and on
    fs::path folder_;
    std::unique_ptr<KeyFolder> keys_;
    mutable std::mutex mutex_;
    std::vector<std::string> told_;
};

/// A writer and a reader of a topic that nobody else has, and whether what one says comes to the other.
class Talk {
  public:
    Talk(Participant& from, Participant& to, std::string const& topic = "x")
        : reader_{to.create_reader(topic, {.type_name = "X"}, [this](auto, SampleHeader const&) { ++heard_; })},
          writer_{from.create_writer(topic, {.type_name = "X"})} {}
    [[nodiscard]] bool made() const { return reader_.has_value() && writer_.has_value(); }
    [[nodiscard]] bool works(std::size_t octets = 8) {
        int const before = heard_;
        return wait_until([&] { return !(*reader_)->matched().empty() && !(*writer_)->matched().empty(); }) &&
               say(octets) && wait_until([&] { return heard_ > before; });
    }
    bool say(std::size_t octets = 8) { return (*writer_)->write_cdr(std::vector<std::byte>(octets), std::nullopt); }
    [[nodiscard]] int heard() const { return heard_; }

  private:
    std::atomic<int> heard_{0};
    Result<std::unique_ptr<RawReader>> reader_;
    Result<std::unique_ptr<RawWriter>> writer_;
};

TEST_F(SecuredBus, MembersHearEachOtherHoweverTheirMessagesAreProtected) {
    for (Protection const messages : {Protection::none, Protection::sign, Protection::encrypt}) {
        auto const a = join("a", {.messages = messages}), b = join("b", {.messages = messages});
        ASSERT_TRUE(a && b) << describe(a ? b.error() : a.error());
        Talk sut{**a, **b};
        ASSERT_TRUE(sut.made());
        EXPECT_TRUE(sut.works()) << launcher::to_string(messages);
        ASSERT_EQ((*b)->here().size(), 1U);
        EXPECT_EQ((*b)->peer((*b)->here().front()).machine, this_machine());
        EXPECT_EQ((*a)->refused_datagrams(), "");
        EXPECT_EQ((*b)->refused_datagrams(), "");
    }
    EXPECT_EQ(told(), "");
}

TEST_F(SecuredBus, SamplesOfAnyLengthPassHoweverTheyAreProtected) {
    for (Protection const data : {Protection::none, Protection::sign, Protection::encrypt}) {
        auto const a = join("a", {.data = data}), b = join("b", {.data = data});
        ASSERT_TRUE(a && b) << describe(a ? b.error() : a.error());
        Talk sut{**a, **b};
        ASSERT_TRUE(sut.made());
        for (std::size_t const octets : {8U, 9U, 10U, 11U, 2000U, 100'001U}) { // the last one in fragments
            EXPECT_TRUE(sut.works(octets)) << launcher::to_string(data) << ", " << octets;
        }
    }
}

TEST_F(SecuredBus, WhoHasNoKeysHearsAndSaysNothingAndIsTold) {
    Joining const member{.rights = {{"x", "in", "out"}, {"x", "in", "out"}}};
    auto const a = join("a", member), b = join("b", member), outsider = join_without_keys("outsider");
    ASSERT_TRUE(a && b && outsider);
    Talk from_outside{**outsider, **b, "in"}, to_outside{**a, **outsider, "out"}, sut{**a, **b};
    ASSERT_TRUE(from_outside.made() && to_outside.made() && sut.made());
    EXPECT_TRUE(wait_until([&] { return told().find("'outsider'") != std::string::npos; })) << told();
    EXPECT_TRUE(from_outside.say() && to_outside.say());
    EXPECT_TRUE(sut.works());
    EXPECT_EQ(from_outside.heard(), 0);
    EXPECT_EQ(to_outside.heard(), 0);
    EXPECT_FALSE((*a)->hears({"outsider", 0, ""}));
    EXPECT_FALSE((*b)->hears({"outsider", 0, ""}));
    EXPECT_TRUE((*b)->hears({"a", 0, ""}));
}

TEST_F(SecuredBus, ATopicWithoutARightIsRefusedToItsWriterAndItsReader) {
    auto const a = join("a", {.rights = {{"x"}, {}}});
    ASSERT_TRUE(a) << describe(a.error());
    EXPECT_TRUE((*a)->create_writer("x", {.type_name = "X"}));
    auto const writer = (*a)->create_writer("y", {.type_name = "X"});
    ASSERT_FALSE(writer);
    EXPECT_THAT(describe(writer.error()), HasSubstr("'a' has no right to publish it"));
    auto const reader = (*a)->create_reader("x", {.type_name = "X"}, [](auto, SampleHeader const&) {});
    ASSERT_FALSE(reader);
    EXPECT_THAT(describe(reader.error()), HasSubstr("'a' has no right to subscribe to it"));
}

TEST_F(SecuredBus, KeysOfAnotherAuthorityAreNoKeys) {
    auto const others = make_keys("others");
    auto const b = join("b"), rogue = join("c", {.keys = others.get()});
    ASSERT_TRUE(b && rogue) << describe(b ? rogue.error() : b.error());
    EXPECT_TRUE(wait_until([&] { return told().find("'c'") != std::string::npos; })) << told();
    EXPECT_FALSE((*b)->hears({"c", 0, ""}));
}

TEST_F(SecuredBus, ARevokedCertificateIsRefusedByWhoKnowsTheList) {
    ASSERT_TRUE(keys_->revoke("c", year()));
    auto const own = join("c");
    EXPECT_FALSE(own) << "it knows the list itself";
    auto const b = join("b"), revoked = join("c", {.knows_revoked = false});
    ASSERT_TRUE(b && revoked) << describe(b ? revoked.error() : b.error());
    EXPECT_TRUE(wait_until([&] { return told().find("'c'") != std::string::npos; })) << told();
    EXPECT_FALSE((*b)->hears({"c", 0, ""}));
    auto const a = join("a"); // the negative control
    ASSERT_TRUE(a);
    EXPECT_TRUE(wait_until([&] { return (*b)->hears({"a", 0, ""}); }));
}

TEST_F(SecuredBus, ACertificateThatRunsOutIsRefusedByWhoComesLater) {
    std::int64_t const until = now() + 2;
    ASSERT_TRUE(keys_->issue("c", {now() - 86400, until}));
    auto const expiring = join("c");
    ASSERT_TRUE(expiring) << describe(expiring.error());
    ASSERT_TRUE(wait_until([&] { return now() > until; }));
    auto const b = join("b");
    ASSERT_TRUE(b);
    EXPECT_TRUE(wait_until([&] { return told().find("'c'") != std::string::npos; })) << told();
    EXPECT_FALSE((*b)->hears({"c", 0, ""}));
    auto const again = join("c");
    ASSERT_FALSE(again);
    EXPECT_THAT(describe(again.error()), HasSubstr("DDS Security lets 'c' not join"));
}

/// What CVE-2023-50257 is about: the library believes a farewell in plain text.
TEST_F(SecuredBus, AFarewellInSomebodysNameWithoutKeysEndsNothing) {
    using namespace test;
    for (bool const secured : {true, false}) {
        Found found;
        int const port = 7410 + 2 * joined_;
        auto const b =
            secured ? join("b", {}, &found)
                    : (++joined_,
                       Participant::create(
                           {"b", 0, "test", 0, source_tree("qos/member.xml"), "management", {"127.0.0.1"}}, &found));
        ASSERT_TRUE(b);
        auto const a = secured ? join("a") : join_without_keys("a");
        ASSERT_TRUE(a);
        ASSERT_TRUE(wait_until([&] { return (*b)->hears({"a", 0, ""}); }));
        Bytes victim;
        for (std::string const& id : found.ids()) {
            for (std::size_t i = 0; victim.size() < 12 && i + 1 < id.size(); i += 2) {
                victim.push_back(static_cast<std::uint8_t>(std::strtoul(id.substr(i, 2).c_str(), nullptr, 16)));
            }
        }
        ASSERT_EQ(victim.size(), 12U);
        Bytes const guid = joined({victim, entity(0x1c1)});
        Bytes const gone = submessage(0x15,
                                      joined({{0, 0, 16, 0},
                                              entity(kParticipantReader),
                                              entity(kParticipantWriter),
                                              number(1 << 16),
                                              parameter(0x0070, guid),
                                              parameter(0x0071, {0, 0, 0, 3}),
                                              kSentinel,
                                              {0, 3, 0, 0},
                                              parameter(0x0050, guid),
                                              kSentinel}),
                                      0x0b); // inline QoS and a key
        Bytes const farewell = joined({{'R', 'T', 'P', 'S', 2, 2, 1, 15}, victim, gone});
        UniqueFd const socket{::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0)};
        sockaddr_in to{};
        to.sin_family = AF_INET;
        to.sin_port = htons(static_cast<std::uint16_t>(port));
        to.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        Bytes const word = joined({{'R', 'T', 'P', 'S', 2, 2, 1, 15}, victim, data(0, 0x102, {0, 1, 0, 0})});
        for (Bytes const& datagram : {farewell, word}) { // the second one is counted, and then the first one was seen
            ASSERT_EQ(::sendto(socket.get(), datagram.data(), datagram.size(), 0, reinterpret_cast<sockaddr*>(&to),
                               sizeof to),
                      static_cast<ssize_t>(datagram.size()));
        }
        if (secured) {
            EXPECT_TRUE(wait_until([&] { return !(*b)->refused_datagrams().empty(); }));
            EXPECT_THAT((*b)->refused_datagrams(), HasSubstr("without the protection of this bus"));
            EXPECT_EQ(found.gone(), 0);
        } else {
            EXPECT_TRUE(wait_until([&] { return found.gone() > 0; })); // the negative control
        }
    }
}

} // namespace
} // namespace gridspace::bus
