// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/api.hpp"

#include <gmock/gmock.h>

namespace gridspace::monitor {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr char const* kToken = "0123456789abcdef0123456789abcdef";

RunPlan plan(std::string mode) {
    RunPlan out;
    out.mode = std::move(mode);
    return out;
}

web::Request request(std::string const& authorization, std::string const& body) {
    web::Request out;
    out.method = "POST";
    out.target.path = "/api/v1/control";
    out.authorization = authorization;
    out.body = body;
    return out;
}

class ApiControl : public testing::Test {
  protected:
    web::Response post(std::string const& body, std::string const& authorization) {
        return sut_.answer(request(authorization, body));
    }
    void allow() {
        sut_.allow_control(kToken, [this](std::string const& action) { done_.push_back(action); });
    }

    LiveRun run_{plan("lockstep")};
    Api sut_{run_, [] { return web::ServerCounters{}; }};
    std::vector<std::string> done_;
    std::string const bearer_ = std::string{"Bearer "} + kToken;
};

TEST_F(ApiControl, IsNotThereUnlessTheRunWasStartedSo) {
    EXPECT_EQ(post(R"({"action":"pause"})", bearer_).status, 403);
    EXPECT_THAT(sut_.run(), HasSubstr(R"("control":false)"));
}

TEST_F(ApiControl, ObeysWhoeverKnowsTheToken) {
    allow();
    EXPECT_THAT(sut_.run(), HasSubstr(R"("control":true)"));
    for (char const* action : {"pause", "step 3", "continue", "stop"}) {
        EXPECT_EQ(post(std::string{R"({"action":")"} + action + R"("})", bearer_).status, 202);
    }
    EXPECT_THAT(done_, ElementsAre("pause", "step 3", "continue", "stop"));
}

TEST_F(ApiControl, TheRunSaysThatItIsPaused) {
    run_.clock.state = "running";
    run_.add_event({0, 1, "launcher", "paused", ""});
    EXPECT_THAT(sut_.run(), HasSubstr(R"("state":"paused")"));
    run_.add_event({0, 1, "launcher", "resumed", ""});
    EXPECT_THAT(sut_.run(), HasSubstr(R"("state":"running")"));
    run_.add_event({0, 1, "launcher", "paused", ""});
    run_.clock.state = "final";
    EXPECT_THAT(sut_.run(), HasSubstr(R"("state":"final")"));
}

TEST_F(ApiControl, RefusesAnybodyElse) {
    allow();
    for (char const* said :
         {"", "Bearer", "Bearer ", "Bearer 0123456789abcdef0123456789abcdee", "Basic 0123456789abcdef0123456789abcdef",
          "bearer 0123456789abcdef0123456789abcdef", "0123456789abcdef0123456789abcdef"}) {
        EXPECT_EQ(post(R"({"action":"stop"})", said).status, 401) << said;
    }
    EXPECT_THAT(done_, IsEmpty());
}

TEST_F(ApiControl, RefusesWhatIsNoAction) {
    allow();
    for (char const* body : {"", "pause", "[]", R"({"action":1})", R"({"action":"explode"})", R"({"action":"step"})",
                             R"({"action":"step 0"})", R"({"action":"step -1"})", R"({"action":"step 1\nstop"})",
                             R"({"action":"pause\n"})"}) {
        EXPECT_EQ(post(body, bearer_).status, 400) << body;
    }
    EXPECT_THAT(done_, IsEmpty());
}

TEST_F(ApiControl, CannotHaltTimeButCanStopARunInRealTime) {
    LiveRun live{plan("realtime")};
    Api sut{live, [] { return web::ServerCounters{}; }};
    sut.allow_control(kToken, [this](std::string const& action) { done_.push_back(action); });
    EXPECT_EQ(sut.answer(request(bearer_, R"({"action":"pause"})")).status, 409);
    EXPECT_EQ(sut.answer(request(bearer_, R"({"action":"stop"})")).status, 202);
    EXPECT_THAT(done_, ElementsAre("stop"));
}

} // namespace
} // namespace gridspace::monitor
