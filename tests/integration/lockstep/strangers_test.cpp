// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A simulator and its member on a bus of their own, beside somebody who does not keep the protocol.
#include "bus/clock_server.hpp"
#include "bus/node.hpp"
#include "bus/raw_access.hpp"
#include "common/source_tree.hpp"
#include "tests/integration/veth/veth.hpp"

#include <clock.h>
#include <cstdio>
#include <cstdlib>
#include <ev_charging.h>
#include <fmt/format.h>
#include <future>
#include <gmock/gmock.h>
#include <map>
#include <optional>
#include <set>
#include <thread>
#include <unistd.h>

namespace gridspace::bus {
namespace {

using testing::HasSubstr;

NodeConfig config(std::string const& process, std::vector<std::string> members = {"a"}) {
    NodeConfig out;
    out.process = process;
    out.program = "test";
    out.qos = source_tree(process == "sim" ? "qos/simulator.xml" : "qos/member.xml");
    out.management = {1, {"127.0.0.1"}};
    out.clock.mode = ClockMode::lockstep;
    out.clock.quantum_s = out.clock.tick_s = Rational{1, 1000};
    out.clock.member_timeout_s = 10;
    out.clock.start_timeout_s = 20;
    out.clock.members = std::move(members);
    return out;
}

std::string said(Result<void> const& result) {
    return result ? "nothing" : describe(result.error());
}

/// 300 ticks. `writer`: the process that the scenario says writes `requests`; it is waited for unless it is `absent`.
Result<void> simulate(std::string const& writer, std::string const& absent, int domain) {
    NodeConfig configuration = config("sim");
    configuration.management.domain = domain;
    if (!writer.empty()) {
        configuration.expected_writers["requests"][writer] = 1;
    }
    configuration.absent = {absent};
    auto node = Node::create(configuration);
    if (!node) {
        return std::unexpected{node.error()};
    }
    auto const requests = (*node)->reader<ChargingRequest>("requests");
    ClockServer clock{**node, {{"a", {}, {}, true}}};
    auto done = clock.start();
    constexpr std::int64_t kTicks = 300;
    for (std::int64_t k = 0; done && k <= kTicks; ++k) {
        done = clock.tick(SimTime{k}, k == kTicks);
    }
    return done;
}

/// A process of its own: what a process sends is held back until it has acknowledged, for all its participants.
class Simulator {
  public:
    explicit Simulator(std::string const& writer = "-", std::string const& absent = "-", int domain = 1)
        : output_{::popen(
              fmt::format("exec /proc/{}/exe --simulate {} {} {}", ::getpid(), writer, absent, domain).c_str(), "r")} {}
    ~Simulator() { (void)said(); }
    Simulator(Simulator const&) = delete;
    Simulator& operator=(Simulator const&) = delete;
    /// What it says at its end: what went wrong, or "nothing".
    std::string said() {
        while (output_ != nullptr) {
            char text[512];
            if (std::fgets(text, sizeof text, output_) == nullptr) {
                ::pclose(output_);
                output_ = nullptr;
            } else {
                said_ += text;
            }
        }
        return said_;
    }

  private:
    std::FILE* output_;
    std::string said_;
};

/// A member's whole life.
using Work = std::function<void(Node&, Tick const&, Writer<ChargingRequest>&)>;
Result<void> take_part(NodeConfig const& configuration, Work const& work = {}) {
    auto node = Node::create(configuration);
    if (!node) {
        return std::unexpected{node.error()};
    }
    auto const requests = (*node)->writer<ChargingRequest>("requests");
    if (auto ok = (*node)->start(); !ok) {
        return ok;
    }
    while (true) {
        auto const tick = (*node)->next();
        if (!tick) {
            return std::unexpected{tick.error()};
        }
        if (!*tick) {
            return {};
        }
        if (work) {
            work(**node, **tick, **requests);
        }
        if (auto ok = (*node)->done(**tick, (*tick)->number + 1); !ok) {
            return ok;
        }
    }
}

class Strangers : public ethernet::Veth {};

TEST_F(Strangers, WhoSendsAClockOrAnAcknowledgementInAnotherNameIsNotHeard) {
    auto stranger = Participant::create({"stranger", 0, "test", 1, config("x").qos, "management", {"127.0.0.1"}});
    ASSERT_TRUE(stranger);
    EndpointQos like;
    like.reliable = true;
    like.durability = Durability::transient_local;
    auto const clocks = create_writer_like(**stranger, "simulation_clock", codec_of<SimClock>(), like);
    auto const acknowledgements = create_writer_like(**stranger, "clock_ack", codec_of<ClockAck>(), like);
    ASSERT_TRUE(clocks && acknowledgements);
    Simulator sim;
    std::uint64_t foreign = 0;
    auto const heard = [&] { return !(*clocks)->matched().empty() && !(*acknowledgements)->matched().empty(); };
    auto const member = take_part(config("a"), [&](Node& node, Tick const& tick, auto&) {
        while (!heard()) { // the run waits for this process, and this process for nobody but the two
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        SimClock clock;
        clock.tick(3);
        clock.state(CLOCK_FINAL);
        (*clocks)->write(&clock, std::nullopt);
        ClockAck ack;
        ack.member("a");
        ack.tick(70);
        (*acknowledgements)->write(&ack, std::nullopt);
        foreign = node.counters().foreign_samples;
        for (auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{5};
             tick.final && foreign <= 3 && std::chrono::steady_clock::now() < hang;) { // they may be on their way yet
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
            foreign = node.counters().foreign_samples;
        }
    });
    EXPECT_TRUE(member) << said(member);
    EXPECT_EQ(sim.said(), "nothing");
    EXPECT_GT(foreign, 3U) << "they did come";
}

/// Somebody who takes the name of a process while the run is under way.
struct Impostor {
    explicit Impostor(std::string const& name)
        : participant{*Participant::create({name, 0, "test", 1, config("x").qos, "management", {"127.0.0.1"}})} {
        EndpointQos like;
        like.reliable = true;
        like.durability = Durability::transient_local;
        clocks = *create_writer_like(*participant, "simulation_clock", codec_of<SimClock>(), like);
        acknowledgements = *create_writer_like(*participant, "clock_ack", codec_of<ClockAck>(), like);
        states = *create_writer_like(*participant, "member_status", codec_of<MemberStatus>(), like);
        for (auto const* writer : {clocks.get(), acknowledgements.get(), states.get()}) {
            while (writer->matched().empty()) {
                std::this_thread::sleep_for(std::chrono::milliseconds{1});
            }
        }
    }
    std::unique_ptr<Participant> participant;
    std::unique_ptr<RawWriter> clocks, acknowledgements, states;
};

TEST_F(Strangers, WhoTakesTheNameOfAProcessDuringTheRunIsNotObeyedAndMayLeave) {
    Simulator sim;
    std::optional<Impostor> simulator, member;
    std::map<std::string, std::uint64_t> impostors;
    auto const ended = take_part(config("a"), [&](Node& node, Tick const& tick, auto&) {
        // On a thread of its own: what this one sends is held back until the acknowledgement.
        if (tick.number == 3) {
            std::async(std::launch::async, [&] {
                simulator.emplace("sim");
                member.emplace("a");
                SimClock clock;
                clock.tick(3);
                clock.state(CLOCK_ABORTED);
                simulator->clocks->write(&clock, std::nullopt);
                ClockAck ack;
                ack.member("a");
                ack.tick(299);
                ack.next_tick_needed(300);
                member->acknowledgements->write(&ack, std::nullopt);
                MemberStatus status;
                status.process("a");
                status.incarnation(7);
                status.state(MEMBER_FAILED);
                member->states->write(&status, std::nullopt);
                while ((impostors = node.impostor_samples()).empty()) {
                    std::this_thread::sleep_for(std::chrono::milliseconds{1});
                }
                simulator.reset();
                member.reset();
            }).get();
        }
    });
    EXPECT_TRUE(ended) << said(ended);
    EXPECT_EQ(sim.said(), "nothing");
    EXPECT_THAT(impostors, testing::ElementsAre(testing::Pair("sim", 1U)));
}

TEST_F(Strangers, AConfigurationOfAnotherStepTickOrEpochIsRefused) {
    auto const with = [](auto&& change) {
        NodeConfig out = config("a");
        change(out.clock);
        return out;
    };
    std::vector<std::unique_ptr<Simulator>> waiting; // for the member that left; together, each on a domain of its own
    for (auto&& [configuration, expected] : std::vector<std::pair<NodeConfig, std::string>>{
             {with([](ClockConfig& c) { c.quantum_s = c.tick_s = Rational{1, 500}; }),
              "counts in steps of 1/1000 s, and this process in 1/500 s"},
             {with([](ClockConfig& c) { c.tick_s = Rational{1, 500}; }),
              "is at 0.001 s in tick 1, and a tick of this process is 1/500 s"},
             {with([](ClockConfig& c) { c.epoch_unix_s = 3600; }),
              "has another epoch than this process, by -3600 s"}}) {
        configuration.management.domain = static_cast<int>(waiting.size()) + 1;
        waiting.push_back(std::make_unique<Simulator>("-", "-", configuration.management.domain));
        EXPECT_THAT(said(take_part(configuration)), HasSubstr(expected));
    }
    for (auto const& sim : waiting) {
        EXPECT_NE(sim->said(), "nothing");
    }
}

TEST_F(Strangers, ASecondProcessOfTheSameNameIsRefused) {
    auto const one = Node::create(config("a")), other = Node::create(config("a"));
    ASSERT_TRUE(one && other);
    auto first = std::async(std::launch::async, [&] { return (*one)->start(); });
    // Whoever is refused is still on the bus, so that both are.
    EXPECT_THAT(said((*other)->start()), HasSubstr("another 'a' is already on this bus"));
    EXPECT_THAT(said(first.get()), HasSubstr("another 'a' is already on this bus"));
}

TEST_F(Strangers, WhatIsWrittenAfterItsAcknowledgementEndsTheRunByName) {
    NodeConfig member = config("a");
    member.expected_readers["requests"]["sim"] = 1;
    Simulator sim{"a"};
    auto node = Node::create(member);
    ASSERT_TRUE(node);
    auto const requests = (*node)->writer<ChargingRequest>("requests");
    ASSERT_TRUE((*node)->start());
    for (int k = 0; k < 3; ++k) {
        auto const tick = (*node)->next();
        ASSERT_TRUE(tick && *tick);
        (*requests)->write(ChargingRequest{}, (*tick)->time);
        ASSERT_TRUE((*node)->done(**tick, (*tick)->number + 1));
        if (k == 2) {
            (*requests)->write(ChargingRequest{}, (*tick)->time);
        }
    }
    EXPECT_THAT(sim.said(),
                HasSubstr("a sample of 'requests' from a came for 0.002 s, which a had acknowledged without it"));
}

TEST_F(Strangers, AWriterThatTheScenarioDoesNotNameEndsTheRunByName) {
    NodeConfig member = config("a");
    member.expected_readers["requests"]["sim"] = 1;
    Simulator sim{"somebody", "somebody"};
    (void)take_part(member,
                    [](auto&, Tick const& tick, auto& requests) { requests.write(ChargingRequest{}, tick.time); });
    EXPECT_THAT(sim.said(), HasSubstr("a writes 'requests', which the scenario does not say"));
}

TEST_F(Strangers, InRealTimeHaveTheirOwnNamesInWhatIsTakenAndNothingElseIs) {
    NodeConfig configuration = config("recorder", {});
    configuration.clock.mode = ClockMode::realtime;
    configuration.clock.simulator.clear();
    auto node = Node::create(configuration);
    ASSERT_TRUE(node);
    auto const requests = (*node)->reader<ChargingRequest>("requests");
    ASSERT_TRUE(requests && (*node)->start());
    std::vector<std::unique_ptr<Participant>> others;
    std::vector<std::unique_ptr<RawWriter>> writers;
    EndpointQos like;
    like.reliable = true;
    for (char const* name : {"site_b", "site_c", "site_b"}) {
        others.push_back(*Participant::create({name, 0, "test", 1, config("x").qos, "management", {"127.0.0.1"}}));
        writers.push_back(*create_writer_like(*others.back(), "requests", codec_of<ChargingRequest>(), like));
        while (writers.back()->matched().empty()) {
            std::this_thread::sleep_for(std::chrono::milliseconds{1});
        }
        writers.back()->write_cdr(std::vector{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}}, std::nullopt);
        ChargingRequest const request;
        writers.back()->write(&request, std::nullopt);
    }
    std::multiset<std::string> said;
    for (auto const hang = std::chrono::steady_clock::now() + std::chrono::seconds{60};
         said.size() < 3 && std::chrono::steady_clock::now() < hang;) {
        ASSERT_TRUE((*node)->next(std::chrono::steady_clock::now() + std::chrono::milliseconds{50}));
        for (auto const& received : (*requests)->take()) {
            said.insert((*node)->process_name(received.origin));
        }
    }
    EXPECT_THAT(said, testing::ElementsAre("site_b", "site_b", "site_c"));
}

} // namespace
} // namespace gridspace::bus

int main(int argc, char** argv) {
    using namespace gridspace::bus;
    if (argc == 5 && std::string_view{argv[1]} == "--simulate") {
        auto const name = [](std::string const& text) { return text == "-" ? std::string{} : text; };
        std::fputs(said(simulate(name(argv[2]), name(argv[3]), std::atoi(argv[4]))).c_str(), stdout);
        return 0;
    }
    testing::InitGoogleTest(&argc, argv);
    return RUN_ALL_TESTS();
}
