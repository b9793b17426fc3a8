// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/monitor_client.hpp"

#include "common/unique_fd.hpp"
#include "launcher/run/domain_lock.hpp"
#include "tests/support/temporary_folder.hpp"

#include <arpa/inet.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <gmock/gmock.h>
#include <netinet/in.h>
#include <sys/file.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <thread>

namespace gridspace::launcher {
namespace {

using namespace std::chrono_literals;
using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

/// What a client says of somebody who answers `text` and then says nothing more, or ends the connection.
std::string ask(std::string const& text, bool ends, std::chrono::milliseconds patience = kMonitorPatience) {
    UniqueFd const ear{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    sockaddr_in address{};
    socklen_t size = sizeof address;
    address.sin_family = AF_INET;
    address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
    EXPECT_EQ(::bind(ear.get(), reinterpret_cast<sockaddr*>(&address), size), 0);
    EXPECT_EQ(::listen(ear.get(), 1), 0);
    ::getsockname(ear.get(), reinterpret_cast<sockaddr*>(&address), &size);
    std::thread server{[&] {
        UniqueFd const fd{::accept(ear.get(), nullptr, nullptr)};
        char request[1024];
        EXPECT_GT(::recv(fd.get(), request, sizeof request, 0), 0);
        EXPECT_EQ(::send(fd.get(), text.data(), text.size(), MSG_NOSIGNAL), static_cast<ssize_t>(text.size()));
        while (!ends && ::recv(fd.get(), request, sizeof request, 0) > 0) { // until the client has had enough
        }
    }};
    auto const answer =
        ask_monitor({fmt::format("127.0.0.1:{}", ntohs(address.sin_port)), {}, {}}, "/api/v1/topics", patience);
    server.join();
    return answer ? "answer: " + *answer : describe(answer.error());
}

TEST(MonitorClient, AnAnswerIsThereWhenItIsWhole) {
    EXPECT_EQ(ask("HTTP/1.1 200 OK\r\nContent-Length: 2\r\n\r\n{}", true), "answer: {}");
    EXPECT_EQ(ask("HTTP/1.1 200 OK\r\n\r\n{}", true), "answer: {}") << "whoever does not say how long it is";
    EXPECT_EQ(ask("HTTP/1.1 200 OK\r\ncontent-length: 2\r\n\r\n{}", true), "answer: {}");
}

TEST(MonitorClient, AMonitorThatIsSilentIsNotTakenForSomebodyElse) {
    EXPECT_THAT(ask("", false, 200ms),
                AllOf(HasSubstr("has not answered within 0.2 s"), Not(HasSubstr("not a monitor"))));
    EXPECT_THAT(ask("HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n{", false, 5s),
                HasSubstr("has not answered within 5 s: 40 octets of its answer came"));
}

TEST(MonitorClient, AnAnswerThatWasCutIsCalledThat) {
    EXPECT_THAT(ask("HTTP/1.1 200 OK\r\nContent-Length: 10\r\n\r\n{", true), HasSubstr("was cut after 40 octets"));
    EXPECT_THAT(ask("HTTP/1.1 200", true), HasSubstr("was cut after 12 octets"));
    EXPECT_THAT(ask("", true), HasSubstr("has ended the connection without an answer"));
}

TEST(MonitorClient, SomebodyElseIsNamedAsSuch) {
    EXPECT_THAT(ask("SSH-2.0-OpenSSH_9.2\r\n", true), HasSubstr("is not a monitor"));
}

/// What is said of the monitor of a run whose note is this text.
struct MonitorNote : testing::Test {
    [[nodiscard]] std::string said() const {
        auto const address = monitor_address(folder.path());
        return address ? address->url() : describe(address.error());
    }
    void write(std::string const& text, mode_t mode) const {
        std::ofstream{file} << text;
        ::chmod(file.c_str(), mode);
    }
    TemporaryFolder const folder;
    std::filesystem::path const file{folder.path() / "monitor.address"};
};

TEST_F(MonitorNote, OfARunThatIsUnderWayIsBelieved) {
    auto const run = note_monitor(folder.path(), {"127.0.0.1:8080", {}, {}});
    ASSERT_TRUE(run);
    EXPECT_EQ(said(), "http://127.0.0.1:8080");
}

TEST_F(MonitorNote, OfARunThatIsOverIsNot) {
    ASSERT_TRUE(note_monitor(folder.path(), {"127.0.0.1:8080", {}, {}})); // and let go
    EXPECT_THAT(said(), HasSubstr("is over"));
}

TEST_F(MonitorNote, ThatSomebodySentInAFolderIsNotObeyed) {
    write("http://192.0.2.1:80\n\n/home/me/.ssh/id_ed25519\n", 0600);
    EXPECT_THAT(said(), HasSubstr("is over")) << "nobody has locked it";
    write("http://192.0.2.1:80\n\n/home/me/.ssh/id_ed25519\n", 0644);
    EXPECT_THAT(said(), HasSubstr("is not what a run of yours wrote")) << "anybody may have locked it";
    EXPECT_THAT(said(), HasSubstr("give the address"));
}

TEST_F(MonitorNote, ThatIsALinkIsNotFollowed) {
    TemporaryFolder const elsewhere;
    auto const run = note_monitor(elsewhere.path(), {"127.0.0.1:8080", {}, {}});
    ASSERT_TRUE(run);
    std::filesystem::create_symlink(elsewhere.path() / "monitor.address", file);
    EXPECT_THAT(said(), HasSubstr("has no monitor"));
}

TEST_F(MonitorNote, ThatIsEmptyOrCutIsDamaged) {
    for (char const* text : {"", "\n\n\n", "127.0.0.1\n\n\n", "http://127.0.0.1:80"}) {
        write(text, 0600);
        UniqueFd const lock{::open(file.c_str(), O_RDONLY | O_CLOEXEC)};
        ASSERT_EQ(::flock(lock.get(), LOCK_EX), 0);
        EXPECT_THAT(said(), HasSubstr("is damaged")) << text;
    }
}

TEST(DomainLock, PairsAreHandedOutOnceAndComeBack) {
    TemporaryFolder const folder;
    auto first = DomainLock::take(folder.path());
    ASSERT_TRUE(first);
    auto const second = DomainLock::take(folder.path());
    ASSERT_TRUE(second);
    EXPECT_EQ(second->first(), first->first() + 2);
    first = fail(ExitCode::ok, "");
    auto const again = DomainLock::take(folder.path());
    ASSERT_TRUE(again);
    EXPECT_EQ(again->first(), second->first() - 2);
}

TEST(DomainLock, ALinkInTheFolderIsPassedOverAndWhatItNamesIsLeftAlone) {
    TemporaryFolder const folder;
    auto const victim = folder.path() / "victim";
    std::ofstream{victim} << "x";
    std::filesystem::permissions(victim, std::filesystem::perms::owner_read);
    std::filesystem::create_symlink(victim, folder.path() / "2");
    std::filesystem::create_symlink(folder.path() / "nothing", folder.path() / "4");
    std::filesystem::create_directory(folder.path() / "6");
    auto const lock = DomainLock::take(folder.path());
    ASSERT_TRUE(lock);
    EXPECT_EQ(lock->first(), 8);
    EXPECT_EQ(std::filesystem::status(victim).permissions(), std::filesystem::perms::owner_read);
    EXPECT_FALSE(std::filesystem::exists(folder.path() / "nothing"));
}

TEST(DomainLock, AFolderThatCannotBeWrittenIsNamedAndAFullOneToo) {
    TemporaryFolder const folder;
    std::ofstream{folder.path() / "file"} << "x";
    auto const refused = DomainLock::take(folder.path() / "file");
    ASSERT_FALSE(refused);
    EXPECT_THAT(describe(refused.error()), AllOf(HasSubstr((folder.path() / "file/2").string()),
                                                 HasSubstr("Not a directory"), Not(HasSubstr("at once"))));
    std::vector<DomainLock> all;
    auto one = DomainLock::take(folder.path());
    for (; one; one = DomainLock::take(folder.path())) {
        all.push_back(std::move(*one));
    }
    EXPECT_EQ(all.size(), 49U);
    EXPECT_THAT(describe(one.error()), HasSubstr("no pair of DDS domains is free"));
}

} // namespace
} // namespace gridspace::launcher
