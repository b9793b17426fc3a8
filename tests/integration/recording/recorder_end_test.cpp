// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// The end of a recording in real time: nobody waits for the recorder, and it waits for those who have not left yet.
#include "bus/codec.hpp"
#include "bus/participant.hpp"
#include "common/source_tree.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "tests/integration/veth/veth.hpp"
#include "tests/support/temporary_folder.hpp"

#include <chrono>
#include <clock.h>
#include <cstdio>
#include <ev_charging.h>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <gmock/gmock.h>
#include <thread>

namespace gridspace {
namespace {

using namespace std::chrono_literals;
using Clock = std::chrono::steady_clock;
using testing::HasSubstr;

[[nodiscard]] bool comes(std::function<bool()> const& what) {
    auto const deadline = Clock::now() + 60s;
    bool there = what();
    for (; !there && Clock::now() < deadline; there = what()) {
        std::this_thread::sleep_for(5ms);
    }
    return there;
}

/// gridspace-recorder alone, which expects `requests` of ev1 and the clock of sim; both are this test.
class RecorderEnd : public ethernet::Veth {
  protected:
    void SetUp() override {
        Veth::SetUp();
        if (IsSkipped()) {
            return;
        }
        std::filesystem::path const file = folder_.path() / "recorder.yaml";
        std::ofstream{file} << fmt::format(
            R"({{"process": "recorder", "program": "gridspace-recorder",
                 "bus": {{"qos": "{0}qos/recorder.xml", "management": {{"domain": 1, "addresses": ["127.0.0.1"]}},
                          "clock": {{"mode": "realtime", "quantum_s": 1, "tick_s": 1, "epoch": "2019-12-01T09:00:00Z",
                                     "simulator": "sim", "members": ["ev1"], "start_timeout_s": 0}},
                          "expected_writers": {{"requests": {{"endpoints": {{"ev1": 1}}}}}}}},
                 "settings": {{"file": "{1}", "topics": {{"requests": {{"type": "ChargingRequest"}}}}}}}})",
            source_tree(""), recording_.string());
        output_ = ::popen(
            fmt::format("exec {} --config {} 2>&1", build_tree("bin/gridspace-recorder"), file.string()).c_str(), "r");
        join(sim_, "sim", "simulator");
        join(ev1_, "ev1", "member");
        clock_ = std::move(*sim_->create_writer("simulation_clock", bus::codec_of<SimClock>()));
        requests_ = std::move(*ev1_->create_writer("requests", bus::codec_of<ChargingRequest>()));
        ASSERT_TRUE(comes([&] { return is_heard(*clock_) && is_heard(*requests_); }));
    }
    void TearDown() override {
        (void)said();
        requests_.reset();
        clock_.reset();
        ev1_.reset();
        sim_.reset();
        Veth::TearDown();
    }
    static void join(std::unique_ptr<bus::Participant>& out, char const* process, char const* role) {
        auto joined = bus::Participant::create(
            {process, 0, "test", 1, source_tree(fmt::format("qos/{}.xml", role)), "management", {"127.0.0.1"}});
        ASSERT_TRUE(joined) << describe(joined.error());
        out = std::move(*joined);
    }
    static bool is_heard(bus::RawWriter const& writer) { return !writer.matched().empty(); }
    void tick(std::uint64_t number, ClockState state) {
        SimClock clock;
        clock.tick(number);
        clock.quanta(static_cast<std::int64_t>(number));
        clock.time_ns(static_cast<std::int64_t>(number) * 1'000'000'000);
        clock.quantum_num(1);
        clock.quantum_den(1);
        clock.state(state);
        clock_->write(&clock, std::nullopt);
    }
    bool request(std::int64_t time_s) {
        ChargingRequest sample;
        sample.ev("ev1");
        sample.time_ns(time_s * 1'000'000'000);
        return requests_->write(&sample, std::nullopt) && requests_->wait_acknowledged(10s);
    }
    /// What the recorder has said, when it has ended.
    std::string said() {
        while (output_ != nullptr) {
            char text[512];
            if (std::fgets(text, sizeof text, output_) == nullptr) {
                exit_ = ::pclose(output_);
                output_ = nullptr;
            } else {
                said_ += text;
            }
        }
        return said_;
    }
    [[nodiscard]] int recorded() const {
        int count = 0;
        auto const read = mcap::read_messages(recording_, [&](mcap::Message const& m) {
            count += m.channel.topic == "requests" ? 1 : 0;
            return true;
        });
        EXPECT_TRUE(read && read->complete);
        return count;
    }

    TemporaryFolder folder_;
    std::filesystem::path recording_{folder_.path() / "data.mcap"};
    std::FILE* output_{nullptr};
    std::string said_;
    int exit_{-1};
    std::unique_ptr<bus::Participant> sim_, ev1_;
    std::unique_ptr<bus::RawWriter> clock_, requests_;
};

TEST_F(RecorderEnd, WhatAMemberSaysBeforeItLeavesIsRecordedHoweverLate) {
    tick(0, CLOCK_RUNNING);
    ASSERT_TRUE(request(0));
    tick(1, CLOCK_FINAL);
    clock_.reset(); // the simulator leaves first
    sim_.reset();
    auto const end = Clock::now();
    int sent = 1;
    for (; Clock::now() - end < 1500ms; std::this_thread::sleep_for(50ms)) { // a device that is slow to end
        bool const is_there = is_heard(*requests_);
        EXPECT_TRUE(is_there || Clock::now() - end > 4s) << "the recorder left before " << sent;
        if (!is_there) {
            break;
        }
        sent += request(1) ? 1 : 0;
    }
    requests_.reset();
    ev1_.reset();
    EXPECT_THAT(said(), testing::Not(HasSubstr("still there")));
    EXPECT_EQ(exit_, 0) << said_;
    EXPECT_EQ(recorded(), sent);
}

TEST_F(RecorderEnd, WhoDoesNotLeaveIsNamed) {
    tick(0, CLOCK_RUNNING);
    ASSERT_TRUE(request(0));
    tick(1, CLOCK_FINAL);
    clock_.reset();
    sim_.reset();
    EXPECT_THAT(said(), HasSubstr("ev1 is still there five seconds after the end"));
    EXPECT_EQ(exit_, 0) << said_;
    EXPECT_EQ(recorded(), 1);
}

} // namespace
} // namespace gridspace
