// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/graph/graph_model.hpp"
#include "monitor/graph/graph_text.hpp"
#include "monitor/graph/match.hpp"

#include <gmock/gmock.h>
#include <nlohmann/json.hpp>

namespace gridspace::graph {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;
using testing::Not;

bus::DiscoveredEndpoint endpoint(std::string id, std::string participant, bool writer) {
    bus::DiscoveredEndpoint out;
    out.id = std::move(id);
    out.participant = std::move(participant);
    out.topic = "requests";
    out.type = "ChargingRequest";
    out.writer = writer;
    out.qos.reliable = true;
    return out;
}

/// ev1 writes what mcca reads.
GraphModel pair() {
    GraphModel model;
    model.expect({"ev1", "gridspace-ev", "board1", {}, 0, {}, {}});
    model.participant_found("data", {"p1", {"ev1", 0, "gridspace-ev"}, {"10.10.0.3"}});
    model.participant_found("data", {"p2", {"mcca", 0, "gridspace-mcca"}, {"10.10.0.4"}});
    model.endpoint_found("data", endpoint("w", "p1", true));
    model.endpoint_found("data", endpoint("r", "p2", false));
    return model;
}

Edge const& edge(Snapshot const& graph, std::string const& process) {
    return *std::find_if(graph.edges.begin(), graph.edges.end(), [&](Edge const& e) { return e.process == process; });
}

TEST(Match, HasNothingToSayAboutEqualQos) {
    EXPECT_THAT(mismatch(endpoint("w", "p", true), endpoint("r", "q", false)), IsEmpty());
}

TEST(Match, AllowsAWriterToOfferMoreThanIsAsked) {
    auto writer = endpoint("w", "p", true), reader = endpoint("r", "q", false);
    writer.qos = {true,      bus::Durability::transient_local,
                  1.0,       bus::Liveliness::manual_by_topic,
                  2.0,       false,
                  {"site*"}, bus::PresentationScope::group,
                  true,      true,
                  true,      {bus::Representation::xcdr2}};
    reader.qos = {false,     bus::Durability::volatile_,
                  1.5,       bus::Liveliness::automatic,
                  -1,        false,
                  {"site1"}, bus::PresentationScope::topic,
                  false,     false,
                  false,     {bus::Representation::xcdr1, bus::Representation::xcdr2}};
    EXPECT_THAT(mismatch(writer, reader), IsEmpty());
}

TEST(Match, NamesEveryReasonForWhichTwoDoNotMeet) {
    auto writer = endpoint("w", "p", true), reader = endpoint("r", "q", false);
    writer.qos = {false, bus::Durability::volatile_,
                  -1,    bus::Liveliness::automatic,
                  -1,    false,
                  {"a"}, bus::PresentationScope::instance,
                  false, false,
                  false, {bus::Representation::xcdr2, bus::Representation::xcdr1}}; // a writer uses the first
    reader.qos = {true,  bus::Durability::transient_local,
                  0.5,   bus::Liveliness::manual_by_topic,
                  3,     true,
                  {"b"}, bus::PresentationScope::topic,
                  true,  true,
                  true,  {bus::Representation::xcdr1, bus::Representation::xml}};
    reader.type = "Other";
    EXPECT_THAT(mismatch(writer, reader),
                ElementsAre("type: written is ChargingRequest, read is Other",
                            "reliability: offered is best effort, requested is reliable",
                            "durability: offered is volatile, requested is transient local",
                            "deadline: offered is infinite, requested is 0.5 s",
                            "liveliness: offered is automatic, requested is manual by topic",
                            "liveliness lease: offered is infinite, requested is 3 s",
                            "ownership: offered is shared, requested is exclusive",
                            "destination order: offered is by reception timestamp, requested is by source timestamp",
                            "presentation: offered is access by instance, requested is by topic",
                            "presentation: coherent access is requested and not offered",
                            "presentation: ordered access is requested and not offered",
                            "data representation: written is XCDR2, read is XCDR1 or XML",
                            "partition: written to [a], read from [b]"));
}

TEST(Graph, JoinsWhatTheScenarioSaysWithWhatIsDiscovered) {
    Snapshot const graph = pair().snapshot();
    ASSERT_EQ(graph.processes.size(), 2U);
    EXPECT_EQ(graph.processes[0].host, "board1");
    EXPECT_EQ(graph.processes[1].host, "10.10.0.4"); // nobody said more
    EXPECT_EQ(graph.processes[0].state, ProcessState::alive);
    ASSERT_EQ(graph.topics.size(), 1U);
    EXPECT_EQ(graph.topics[0].writers, 1U);
    EXPECT_TRUE(edge(graph, "ev1").matched);
    EXPECT_THAT(edge(graph, "ev1").problems, IsEmpty());
}

TEST(Graph, SaysWhyAnEdgeIsBroken) {
    GraphModel sut = pair();
    auto reader = endpoint("r", "p2", false);
    reader.qos.durability = bus::Durability::transient_local;
    sut.endpoint_found("data", reader); // it changed its mind
    Snapshot const graph = sut.snapshot();
    EXPECT_FALSE(edge(graph, "mcca").matched);
    EXPECT_THAT(edge(graph, "mcca").problems,
                ElementsAre("gets nothing from ev1: durability: offered is volatile, requested is transient local"));
    EXPECT_THAT(to_dot(graph, false), HasSubstr("color=red"));
    EXPECT_THAT(to_dot(pair().snapshot(), false), Not(HasSubstr("color=red")));
}

TEST(Match, AllowsAWriterALatencyThatTheReaderAllowsToo) {
    auto writer = endpoint("w", "p", true), reader = endpoint("r", "q", false);
    writer.qos.latency_budget_s = 5;
    reader.qos.latency_budget_s = 0.001;
    EXPECT_THAT(mismatch(writer, reader), ElementsAre("latency budget: offered is 5 s, requested is 0.001 s"));
    reader.qos.latency_budget_s = 5;
    EXPECT_THAT(mismatch(writer, reader), IsEmpty());
    reader.qos.latency_budget_s = -1;
    EXPECT_THAT(mismatch(writer, reader), IsEmpty());
}

TEST(Graph, SaysOfATopicWhichWriterWhoeverLooksOnDoesNotHear) {
    GraphModel sut = pair();
    sut.participant_found("data", {"p3", {"monitor", 0, "gridspace-monitor"}, {}});
    sut.look_through("p3");
    auto writer = endpoint("w2", "p2", true);
    writer.qos.representations = {bus::Representation::xcdr2};
    sut.endpoint_found("data", writer);
    EXPECT_THAT(sut.snapshot().topics.at(0).not_heard, IsEmpty()); // it has no reader yet
    sut.endpoint_found("data", endpoint("m", "p3", false));
    Snapshot const graph = sut.snapshot();
    EXPECT_THAT(graph.topics.at(0).not_heard,
                ElementsAre("mcca: data representation: written is XCDR2, read is XCDR1"));
    EXPECT_EQ(from_json(to_json(graph))->topics.at(0).not_heard, graph.topics.at(0).not_heard);
    auto other = endpoint("m2", "p3", false); // a second reader that does hear it
    other.qos.representations = {bus::Representation::xcdr2};
    sut.endpoint_found("data", other);
    EXPECT_THAT(sut.snapshot().topics.at(0).not_heard, IsEmpty());
}

TEST(Graph, DoesNotMatchAcrossNetworks) {
    GraphModel sut = pair();
    sut.endpoint_gone("r");
    sut.endpoint_found("management", endpoint("r", "p2", false));
    Snapshot const graph = sut.snapshot();
    EXPECT_FALSE(edge(graph, "ev1").matched);
    EXPECT_EQ(graph.topics.size(), 2U);
}

TEST(Graph, TellsAKilledProcessFromOneThatSaidGoodbye) {
    GraphModel sut = pair();
    sut.participant_gone("p1", false);
    sut.participant_gone("p2", true);
    Snapshot const graph = sut.snapshot();
    EXPECT_EQ(graph.processes[0].state, ProcessState::lost);
    EXPECT_EQ(graph.processes[1].state, ProcessState::ended);
    EXPECT_THAT(graph.edges, IsEmpty());
}

TEST(Graph, ARestartedProcessIsAliveAgainInItsNextIncarnation) {
    GraphModel sut = pair();
    sut.participant_gone("p1", false);
    sut.participant_found("data", {"p9", {"ev1", 1, "gridspace-ev"}, {"10.10.0.3"}});
    Snapshot const graph = sut.snapshot();
    EXPECT_EQ(graph.processes[0].state, ProcessState::alive);
    EXPECT_EQ(graph.processes[0].incarnation, 1U);
}

TEST(Graph, AProcessThatHasNotBeenSeenIsExpected) {
    GraphModel sut;
    sut.expect({"relay", "gridspace-relay", "board", {}, 0, {}, {}});
    EXPECT_EQ(sut.snapshot().processes.at(0).state, ProcessState::expected);
}

TEST(Graph, EveryChangeIsANewRevisionAndNoChangeIsNone) {
    GraphModel sut = pair();
    auto const before = sut.revision();
    sut.endpoint_gone("nobody");
    sut.participant_gone("nobody", true);
    EXPECT_EQ(sut.revision(), before);
    sut.endpoint_gone("w");
    EXPECT_GT(sut.revision(), before);
}

TEST(GraphText, IsJsonWithHostileNamesIntact) {
    GraphModel sut;
    std::string const hostile = "<script>\"\\\n\xff";
    sut.expect({hostile, "", "", {}, 0, {}, {}});
    auto const json = nlohmann::json::parse(to_json(sut.snapshot()), nullptr, false);
    ASSERT_FALSE(json.is_discarded());
    EXPECT_THAT(to_svg(sut.snapshot(), true), Not(HasSubstr("<script>")));
}

TEST(GraphText, IsReadBackAsItWasKeptInTheRunFolder) {
    GraphModel model = pair();
    auto mismatched = endpoint("r2", "p2", false);
    mismatched.topic = "decisions";
    mismatched.qos = {true, bus::Durability::transient_local, 0.5, bus::Liveliness::manual_by_topic, 3, true, {"b"}};
    model.endpoint_found("data", mismatched);
    model.wire({"mu21", "SMV21", "smv", "process_bus", true});
    model.participant_gone("p1", false);
    std::string const kept = to_json(model.snapshot());
    auto const read = from_json(kept);
    ASSERT_TRUE(read);
    EXPECT_EQ(to_json(*read), kept);
}

TEST(GraphText, OfAnotherKindIsNotAGraph) {
    std::string const kept = to_json(pair().snapshot());
    EXPECT_FALSE(from_json(""));
    EXPECT_FALSE(from_json("[]"));
    EXPECT_FALSE(from_json(kept.substr(0, kept.size() / 2)));
    EXPECT_FALSE(
        from_json(R"({"revision":1,"processes":[{"name":3}],"topics":[],"edges":[],"wires":[],"endpoints":[]})"));
}

TEST(GraphModel, DoesNotBlameAnybodyForAReaderOfTheMonitor) {
    GraphModel model = pair();
    model.participant_found("data", {"p3", {"monitor", 0, "gridspace-monitor"}, {"10.10.0.5"}});
    model.participant_found("data", {"p4", {"stranger", 0, "somebody"}, {"10.10.0.6"}});
    auto writer = endpoint("w2", "p4", true);
    writer.qos.reliable = false;
    model.endpoint_found("data", writer);
    auto reader = endpoint("r2", "p3", false);
    model.endpoint_found("data", reader);
    Snapshot const graph = model.snapshot();
    EXPECT_THAT(edge(graph, "monitor").problems, IsEmpty());
    EXPECT_THAT(edge(graph, "stranger").problems, ElementsAre(HasSubstr("mcca does not get it: reliability")));
}

TEST(GraphModel, OfThousandsOfEndpointsThatDoNotMatchKeepsABoundedNumberOfReasons) {
    GraphModel model;
    for (int i = 0; i < 4000; ++i) {
        bool const writes = i % 2 == 0;
        std::string const id = std::to_string(i);
        model.participant_found("data", {"p" + id, {"process" + id, 0, "x"}, {}});
        auto one = endpoint("e" + id, "p" + id, writes);
        one.qos.reliable = !writes;
        one.qos.deadline_s = writes ? -1 : 1 + i % 200; // kinds without end
        model.endpoint_found("data", one);
    }
    Snapshot const graph = model.snapshot();
    ASSERT_EQ(graph.edges.size(), 4000U);
    for (Edge const& e : graph.edges) {
        EXPECT_FALSE(e.matched);
        EXPECT_LE(e.problems.size(), 64U);
    }
    EXPECT_EQ(edge(graph, "process0").problems.size(), 64U);
}

TEST(GraphModel, KnowsWhoElseBearsTheNameOfAProcess) {
    GraphModel sut = pair();
    bus::Peer const ev1{"ev1", 0, "gridspace-ev"};
    EXPECT_THAT(sut.bearers("data", ev1), ElementsAre("10.10.0.3"));
    sut.participant_found("data", {"p3", {"ev1", 0, ""}, {"10.10.0.99"}});
    sut.participant_found("management", {"p4", ev1, {"10.10.0.3"}});
    EXPECT_THAT(sut.bearers("data", ev1), ElementsAre("10.10.0.3", "10.10.0.99"));
    sut.participant_found("data", {"p5", {"ev1", 1, "gridspace-ev"}, {"10.10.0.3"}});
    EXPECT_THAT(sut.bearers("data", {"ev1", 1, ""}), ElementsAre("10.10.0.3")) << "its next life";
}

TEST(GraphModel, KeepsABoundedNumberOfStrangers) {
    GraphModel sut = pair();
    for (int i = 0; i < 10'000; ++i) {
        std::string const id = "stranger" + std::to_string(i);
        sut.participant_found("data", {id, {id, 0, ""}, {}});
        (void)sut.endpoint_found("data", endpoint("w" + id, id, true));
        if (i < 1000) {
            sut.participant_gone(id, true);
        }
    }
    EXPECT_FALSE(sut.endpoint_found("data", endpoint("one more", "p3", true)));
    EXPECT_TRUE(sut.endpoint_found("data", endpoint("w", "p1", true))) << "it is known";
    Snapshot const graph = sut.snapshot();
    EXPECT_EQ(graph.endpoints.size(), GraphModel::kMaxEndpoints);
    auto const gone = std::ranges::count(graph.processes, ProcessState::ended, &Process::state);
    EXPECT_EQ(static_cast<std::size_t>(gone), GraphModel::kMaxGone);
}

} // namespace
} // namespace gridspace::graph
