// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/source_tree.hpp"
#include "monitor/app/api.hpp"
#include "monitor/app/assets.hpp"

#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::monitor {
namespace {

using nlohmann::json;

std::set<std::string> described() {
    std::ifstream stream{source_tree("monitor/app/openapi.json")};
    std::set<std::string> out;
    json const document = json::parse(stream);
    for (auto const& [path, methods] : document.at("paths").items()) {
        for (auto const& [method, operation] : methods.items()) {
            out.insert((method == "get" ? "GET " : "POST ") + path);
        }
    }
    return out;
}

TEST(ApiRoutes, AreAllInTheOpenApiDocumentAndNothingElseIs) {
    std::set<std::string> served{"GET /login", "POST /login", "GET /ws/v1"}; // of the gate and of the push hub
    for (Api::Route const& route : Api::routes()) {
        served.insert(std::string{route.method} + " " + std::string{route.path});
    }
    for (Asset const& asset : assets()) {
        served.insert("GET " + std::string{asset.path});
    }
    std::set<std::string> said = described();
    if (!served.contains("GET /app.js")) { // a build without the dashboard
        said.erase("GET /app.js");
        said.erase("GET /app.css");
    }
    EXPECT_EQ(said, served);
}

class ApiAnswers : public testing::Test {
  protected:
    web::Response ask(std::string method, std::string path, std::map<std::string, std::string> query = {}) {
        web::Request request;
        request.method = std::move(method);
        request.target.path = std::move(path);
        request.target.query = std::move(query);
        return sut_.answer(request);
    }
    LiveRun run_{RunPlan{}};
    Api sut_{run_, [] { return web::ServerCounters{}; }};
};

TEST_F(ApiAnswers, RefuseAStretchThatEndsBeforeItBegins) {
    auto const answer = ask("GET", "/api/v1/signals/query", {{"names", "x"}, {"t0", "5"}, {"t1", "2.5"}});
    EXPECT_EQ(answer.status, 400);
    EXPECT_THAT(answer.body, testing::HasSubstr("t1 (2.5 s) is before t0 (5 s)"));
    EXPECT_EQ(ask("GET", "/api/v1/signals/query", {{"names", "x"}, {"t0", "5"}, {"t1", "5"}}).status, 404); // no signal
}

TEST_F(ApiAnswers, TellWhatIsExpectedAndOfARecordedRunWhatCameOfIt) {
    std::filesystem::path const folder = std::filesystem::path{testing::TempDir()} / "verdict_of_a_run";
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder / "report");
    std::ofstream{folder / "report" / "summary.json"}
        << R"({"exit": 1, "overruns": 3, "expectations": [{"name": "late", "value": 7.5, "unit": "ms", "pass": false, "detail": "at 1 s"}]})";
    RunPlan plan;
    plan.events = folder / "events.ndjson";
    plan.expectations = {{"late", "max of x", "< 3", "ms"}, {"new", "never y", "", ""}};
    LiveRun run{plan};
    Api const sut{run, [] { return web::ServerCounters{}; }};
    json const live = json::parse(sut.verdict());
    EXPECT_EQ(live["judged"], false);
    EXPECT_TRUE(live["expectations"][0]["pass"].is_null());
    EXPECT_TRUE(live["expectations"][0]["standing"].is_null()) << "nobody says it";
    std::ofstream{folder / "so_far.json"}
        << R"({"reached_s": 2.5, "expectations": [{"name": "late", "value": 4, "unit": "ms", "standing": "failed", "detail": ""}]})";
    json const standing = json::parse(sut.verdict());
    EXPECT_EQ(standing["judged"], false) << "the report says the last word";
    EXPECT_EQ(standing["reached_s"], 2.5);
    EXPECT_EQ(standing["expectations"][0]["standing"], "failed");
    EXPECT_EQ(standing["expectations"][0]["value"], 4);
    EXPECT_TRUE(standing["expectations"][0]["pass"].is_null());
    EXPECT_TRUE(standing["expectations"][1]["standing"].is_null());

    run.recorded = true; // what a killed launcher has left behind says nothing of it
    json const recorded = json::parse(sut.verdict());

    EXPECT_EQ(recorded["judged"], true);
    EXPECT_EQ(recorded["overruns"], 3);
    EXPECT_FALSE(recorded.contains("reached_s"));
    EXPECT_EQ(recorded["expectations"][0], json({{"name", "late"},
                                                 {"rule", "max of x"},
                                                 {"accepted", "< 3"},
                                                 {"unit", "ms"},
                                                 {"advisory", false},
                                                 {"value", 7.5},
                                                 {"pass", false},
                                                 {"detail", "at 1 s"},
                                                 {"standing", nullptr}}));
    EXPECT_TRUE(recorded["expectations"][1]["pass"].is_null()) << "nobody has judged it";
    std::ofstream{folder / "report" / "summary.json"} << "{";
    EXPECT_EQ(json::parse(sut.verdict())["judged"], false);
}

TEST_F(ApiAnswers, HaveTheDiagramOfAGridThatCanBeSeenAndOfAVeryBigOneWhatItIsMadeOf) {
    for (std::size_t const buses : {std::size_t{2}, std::size_t{2001}}) {
        RunPlan plan;
        plan.frequency_hz = 50;
        for (std::size_t b = 0; b < buses; ++b) {
            plan.buses.push_back({"B" + std::to_string(b), "B", 400, {}, {}});
        }
        plan.relays.push_back({"r", {{"21", {}}}, {}, {}});
        LiveRun run{plan};
        json const sut = json::parse(Api{run, [] { return web::ServerCounters{}; }}.network());
        EXPECT_EQ(sut["buses"].size(), buses);
        EXPECT_EQ(sut["diagram"].get<std::string>().starts_with("<svg"), buses == 2);
        EXPECT_EQ(sut["frequency_hz"], 50);
        EXPECT_EQ(sut["relays"][0]["functions"], json({"21"}));
    }
}

TEST_F(ApiAnswers, MetricsNameATopicOfWhichNothingWasHeard) {
    run_.graph.participant_found("data", {"p1", {"ev1", 0, "gridspace-ev"}, {}});
    bus::DiscoveredEndpoint writer;
    writer.id = "w";
    writer.participant = "p1";
    writer.topic = "requests";
    writer.writer = true;
    run_.graph.endpoint_found("data", writer);
    auto const line = [](int samples) {
        return "gridspace_topic_samples_total{topic=\"requests\",network=\"data\"} " + std::to_string(samples) + "\n";
    };
    EXPECT_THAT(ask("GET", "/metrics").body, testing::HasSubstr(line(0)));
    run_.on_sample("data", "requests", "T", "ev1", std::vector<std::byte>(4), 0);
    std::string const after = ask("GET", "/metrics").body;
    EXPECT_THAT(after, testing::HasSubstr(line(1)));
    EXPECT_THAT(after, testing::Not(testing::HasSubstr(line(0))));
}

TEST_F(ApiAnswers, KnowEveryRouteAndNoOther) {
    for (Api::Route const& route : Api::routes()) {
        if (route.method == "GET" && route.path.find('{') == std::string_view::npos) {
            EXPECT_NE(ask("GET", std::string{route.path}).status, 404) << route.path;
            EXPECT_NE(ask("HEAD", std::string{route.path}).status, 405) << route.path;
            EXPECT_EQ(ask("POST", std::string{route.path}).status, 405) << route.path;
        }
        EXPECT_EQ(ask("GET", std::string{route.path} + "x/y/z").status, 404) << route.path;
    }
    EXPECT_EQ(ask("GET", "/api/v1/control").allow, "POST");
    EXPECT_EQ(ask("POST", "/api/v1/run").allow, "GET, HEAD");
}

TEST_F(ApiAnswers, FindTopicsWhoseNamesHaveSlashes) {
    std::byte const cdr[]{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{7}};
    run_.on_sample("data", "rt/chatter", "Thing", "somebody", cdr, 0);
    EXPECT_EQ(ask("GET", "/api/v1/topics/rt/chatter").status, 200);
    EXPECT_EQ(ask("GET", "/api/v1/topics/rt/chatter/last").status, 200);
    EXPECT_EQ(ask("GET", "/api/v1/topics/rt").status, 404);
}

TEST_F(ApiAnswers, RefuseNumbersThatTheDocumentDoesNotAllow) {
    run_.signals[{"sim", "g"}] =
        std::make_unique<stream::SignalWindow>(std::vector<stream::SignalWindow::Column>{{"bus.B1.v_pu", "p.u."}});
    auto const with = [&](char const* px) {
        return ask("GET", "/api/v1/signals/query", {{"names", "bus.B1.v_pu"}, {"px", px}});
    };
    EXPECT_EQ(with("1").status, 200);
    EXPECT_EQ(with("10000").status, 200);
    for (char const* wrong : {"-1", "0", "10001", "1e9", "2.5", "many", ""}) {
        EXPECT_EQ(with(wrong).status, 400) << wrong;
    }
    EXPECT_THAT(with("-1").body, testing::HasSubstr("1 to 10000"));
    EXPECT_EQ(ask("GET", "/api/v1/events", {{"after", "0"}}).status, 200);
    for (char const* wrong : {"-1", "1.5", "x"}) {
        EXPECT_EQ(ask("GET", "/api/v1/events", {{"after", wrong}}).status, 400) << wrong;
    }
}

TEST_F(ApiAnswers, KnowASwitchThatIsOffFromOneThatIsOn) {
    std::byte const cdr[]{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}, std::byte{7}};
    run_.on_sample("data", "t", "Thing", "somebody", cdr, 0);
    auto const with = [&](std::map<std::string, std::string> query) {
        return ask("GET", "/api/v1/topics/t/last", std::move(query)).body;
    };
    EXPECT_NE(with({{"cdr", "1"}}), with({}));
    for (char const* on : {"", "true"}) {
        EXPECT_EQ(with({{"cdr", on}}), with({{"cdr", "1"}}));
    }
    for (char const* off : {"0", "false"}) {
        EXPECT_EQ(with({{"cdr", off}}), with({}));
    }
    EXPECT_EQ(ask("GET", "/api/v1/topics/t/last", {{"cdr", "perhaps"}}).status, 400);
    EXPECT_EQ(ask("GET", "/api/v1/graph.svg", {{"framework", "2"}}).status, 400);
}

} // namespace
} // namespace gridspace::monitor
