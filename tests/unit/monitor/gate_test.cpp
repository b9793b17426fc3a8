// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/gate.hpp"

#include "monitor/web/listening.hpp"

#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/stat.h>
#include <unistd.h>

namespace gridspace::web {
namespace {

using testing::AllOf;
using testing::HasSubstr;
using testing::Not;

constexpr char const* kToken = "0123456789abcdef0123456789abcdef";
constexpr char const* kSession = "fedcba9876543210fedcba9876543210";

Request request(std::string method, std::string path) {
    Request out;
    out.method = std::move(method);
    out.target.path = std::move(path);
    return out;
}

class GateTest : public testing::Test {
  protected:
    std::optional<Response> log_in(std::string body) {
        Request out = request("POST", "/login");
        out.body = std::move(body);
        return sut_.check(out);
    }
    Gate sut_{{kToken}, kSession, 8443, true};
};

TEST_F(GateTest, StandsOpenWithoutATokenAndHasNoLoginThen) {
    Gate const sut{{}, kSession, 8080, false};
    EXPECT_TRUE(sut.admits("", ""));
    EXPECT_FALSE(sut.check(request("GET", "/api/v1/run")).has_value());
    EXPECT_FALSE(sut.check(request("GET", "/login")).has_value());
}

TEST_F(GateTest, AdmitsAProgramThatSendsTheToken) {
    EXPECT_TRUE(sut_.admits(std::string{"Bearer "} + kToken, ""));
    Request asked = request("GET", "/metrics");
    asked.authorization = std::string{"Bearer "} + kToken;
    EXPECT_FALSE(sut_.check(asked).has_value());
}

TEST_F(GateTest, AdmitsNobodyElse) {
    for (std::string const said : {"", "Bearer", "Bearer ", "Bearer 0123456789abcdef0123456789abcdee",
                                   "bearer 0123456789abcdef0123456789abcdef", "Basic 0123456789abcdef0123456789abcdef",
                                   "0123456789abcdef0123456789abcdef", "Bearer fedcba9876543210fedcba9876543210"}) {
        EXPECT_FALSE(sut_.admits(said, "")) << said;
    }
    Request asked = request("GET", "/api/v1/run");
    asked.target.query["token"] = kToken; // addresses end in logs and histories
    EXPECT_EQ(sut_.check(asked)->status, 401);
}

TEST_F(GateTest, TakesATokenFromTheAddressOfAWebSocketAndLeavesItToNobody) {
    auto const admits = [&](std::string const& address, std::string const& said = "") {
        auto target = parse_target(address);
        bool const good = sut_.admits_push(said, "", *target);
        EXPECT_FALSE(target->query.contains("token")) << address;
        return good;
    };
    EXPECT_TRUE(admits(std::string{"/?token="} + kToken));
    EXPECT_TRUE(admits(std::string{"/ws/v1?a=b&token="} + kToken));
    EXPECT_TRUE(admits("/?token=wrong", std::string{"Bearer "} + kToken)); // the header says it
    for (std::string const query :
         {"", "?", "?token", "?token=", "?token=0123456789abcdef0123456789abcdee",
          "?Token=0123456789abcdef0123456789abcdef", "?token=fedcba9876543210fedcba9876543210",
          "?token=Bearer+0123456789abcdef0123456789abcdef"}) {
        EXPECT_FALSE(admits("/" + query)) << query;
    }
}

TEST_F(GateTest, AsksABrowserByAPageAndAProgramByJson) {
    Request asked = request("GET", "/");
    asked.accept = "text/html,application/xhtml+xml";
    EXPECT_THAT(sut_.check(asked)->body, HasSubstr("<form"));
    asked.accept = "*/*";
    EXPECT_THAT(sut_.check(asked)->body, HasSubstr(R"("remedy":"Authorization: Bearer TOKEN")"));
}

TEST_F(GateTest, GivesACookieForTheTokenThatDoesNotHoldIt) {
    auto const answer = log_in(std::string{"token="} + kToken);
    ASSERT_TRUE(answer.has_value());
    EXPECT_EQ(answer->status, 303);
    EXPECT_EQ(answer->location, "/");
    EXPECT_THAT(answer->set_cookie, AllOf(HasSubstr("gridspace_8443="), HasSubstr("HttpOnly"), HasSubstr("Secure"),
                                          HasSubstr("SameSite=Strict"), Not(HasSubstr(kToken))));
    EXPECT_TRUE(sut_.admits("", answer->set_cookie.substr(0, answer->set_cookie.find(';'))));
}

TEST_F(GateTest, FindsItsCookieAmongOthersAndTakesNoOther) {
    EXPECT_TRUE(sut_.admits("", std::string{"a=b; gridspace_8443="} + kSession + "; c=d"));
    for (std::string const& jar :
         {std::string{"gridspace_8443="}, std::string{"gridspace_8443"}, std::string{";;;="},
          std::string{"gridspace_8444="} + kSession, std::string{"xgridspace_8443="} + kSession,
          std::string{"gridspace_8443="} + kToken, std::string{"gridspace_8443="} + kSession + "0"}) {
        EXPECT_FALSE(sut_.admits("", jar)) << jar;
    }
}

TEST_F(GateTest, GivesNoCookieForAnythingElse) {
    for (char const* body : {"", "token=", "token=0123456789abcdef0123456789abcdee", "other=x", "token=%zz", "%00"}) {
        auto const answer = log_in(body);
        ASSERT_TRUE(answer.has_value()) << body;
        EXPECT_EQ(answer->status, 401) << body;
        EXPECT_EQ(answer->set_cookie, "") << body;
    }
}

TEST(ReadToken, TakesOnlyALongLineOfAFileThatItsOwnerAloneReads) {
    std::filesystem::path const file =
        std::filesystem::path{testing::TempDir()} / ("token_" + std::to_string(::getpid()));
    auto const write = [&](std::string const& text, mode_t mode) {
        std::ofstream{file} << text;
        ::chmod(file.c_str(), mode);
    };
    write(std::string{kToken} + "\n", 0600);
    EXPECT_EQ(read_token(file), kToken);
    write(std::string{kToken} + "\n", 0640);
    EXPECT_THAT(read_token(file).error().message, HasSubstr("can be read by others (mode 640)"));
    for (char const* bad : {"", "\n", "short\n", "with blanks in its middle\n"}) {
        write(bad, 0600);
        EXPECT_FALSE(read_token(file).has_value()) << bad;
    }
    std::filesystem::remove(file);
    EXPECT_THAT(read_token(file).error().message, HasSubstr("cannot read a token"));
}

TEST(Exposure, AsksForATokenAndTlsBeyondThisMachine) {
    for (char const* here : {"127.0.0.1:0", "127.255.0.1:80"}) {
        EXPECT_TRUE(check_exposure(here, false, false).has_value()) << here;
    }
    for (char const* there : {"0.0.0.0:8443", "192.168.1.5:80", "128.0.0.1:1", "nonsense"}) {
        EXPECT_TRUE(check_exposure(there, true, true).has_value()) << there;
        EXPECT_THAT(check_exposure(there, false, true).error().message, HasSubstr("token_file")) << there;
        EXPECT_THAT(check_exposure(there, true, false).error().message, HasSubstr("tls_cert")) << there;
        EXPECT_THAT(check_exposure(there, false, false).error().message, HasSubstr("and TLS")) << there;
    }
}

} // namespace
} // namespace gridspace::web
