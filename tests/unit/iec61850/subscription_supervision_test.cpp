// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/quality.hpp"
#include "gateways/iec61850/subscription_supervision.hpp"
#include "gateways/iec61850/sv_template.hpp"

#include <gtest/gtest.h>

namespace gridspace::iec61850 {
namespace {

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kUtc = 1'575'158'400LL * 1'000'000'000;

GooseDescription trip(std::uint32_t conf_rev = 1) {
    GooseDescription out = one_boolean();
    out.conf_rev = conf_rev;
    out.data_set = {{DataNode::leaf("trip", BasicType::boolean), DataNode::leaf("q", BasicType::quality)}};
    return out;
}

GooseSubscription subscription() {
    GooseDescription const d = trip();
    GooseSubscription out;
    out.gocb_ref = d.gocb_ref;
    out.dat_set = d.dat_set;
    out.data_set = d.data_set;
    return out;
}

/// A publisher whose every message is given to the subscription.
class GooseBench {
  public:
    explicit GooseBench(std::uint32_t conf_rev = 1, GooseDescription const& description = trip(),
                        bool simulated = false)
        : publisher_{*GooseTemplate::create(sv_address(), description),
                     conf_rev,
                     {.timing = {1 * kMs, 10 * kMs, 2, 3, 30}, .simulation = simulated}} {}

    void start(std::int64_t now) { publisher_.start(now, kUtc + now); }
    void quality(std::uint32_t q, std::int64_t now) {
        publisher_.set(1, Value::quality(q));
        publisher_.commit(now, kUtc + now);
    }
    void run(GooseSupervision& sut, std::int64_t until) {
        while (publisher_.due() && *publisher_.due() <= until) {
            std::int64_t const now = *publisher_.due();
            GooseFrame frame;
            ASSERT_TRUE(decode_goose(publisher_.take(now), frame));
            sut.receive(frame, now, kUtc + now);
        }
    }

  private:
    GoosePublisher publisher_;
};

TEST(GooseSupervision, IsAliveWhileMessagesComeAndLostWhenTheirTimeRunsOut) {
    GooseSupervision sut{subscription()};
    EXPECT_FALSE(sut.state().alive);
    GooseBench bench;
    bench.start(0);
    bench.run(sut, 50 * kMs);
    SupervisionState expected;
    expected.alive = true;
    expected.conf_rev = expected.counter = 1;
    EXPECT_EQ(sut.state(), expected);
    EXPECT_FALSE(sut.expire(*sut.deadline() - 1));
    EXPECT_TRUE(sut.expire(*sut.deadline()));
    EXPECT_FALSE(sut.state().alive);
}

TEST(GooseSupervision, TellsAnotherConfRevFromAnotherDataSet) {
    GooseSupervision other_revision{subscription()};
    GooseBench second{2, trip(2)};
    second.start(0);
    second.run(other_revision, 20 * kMs);
    EXPECT_EQ(other_revision.state().problem, SubscriptionProblem::conf_rev);
    EXPECT_EQ(other_revision.state().conf_rev, 2U);
    EXPECT_TRUE(other_revision.state().needs_commissioning);
    EXPECT_FALSE(other_revision.state().alive);

    GooseSupervision other_set{subscription()};
    GooseDescription longer = trip();
    longer.data_set.members.push_back(DataNode::leaf("more", BasicType::int32));
    GooseBench bench{1, longer};
    bench.start(0);
    bench.run(other_set, 20 * kMs);
    EXPECT_EQ(other_set.state().problem, SubscriptionProblem::data_set);
    EXPECT_TRUE(other_set.state().needs_commissioning);
}

TEST(GooseSupervision, APublisherThatNeedsCommissioningSaysSo) {
    GooseSupervision sut{subscription()};
    GooseBench bench{0, trip(0)}; // confRev 0: ndsCom
    bench.start(0);
    bench.run(sut, 5 * kMs);
    EXPECT_EQ(sut.state().problem, SubscriptionProblem::commissioning);
    EXPECT_TRUE(sut.state().needs_commissioning);
}

TEST(GooseSupervision, ATestSetBesideTheDeviceIsSeenAndChangesNothing) {
    GooseSupervision sut{subscription()};
    GooseBench device, test_set{1, trip(), true};
    device.start(0);
    device.run(sut, 20 * kMs);
    test_set.start(21 * kMs);
    test_set.run(sut, 21 * kMs);
    EXPECT_EQ(sut.state().problem, SubscriptionProblem::simulation);
    EXPECT_FALSE(sut.state().simulated);
    EXPECT_FALSE(sut.state().needs_commissioning);
    EXPECT_TRUE(sut.state().alive);
    device.run(sut, 60 * kMs);
    EXPECT_EQ(sut.state().problem, SubscriptionProblem::simulation) << "it does not flicker between two messages";
    device.run(sut, 200 * kMs);
    EXPECT_EQ(sut.state().problem, SubscriptionProblem::none);
}

TEST(GooseSupervision, TakesSimulatedMessagesWhereTheyAreAskedForAndSaysSo) {
    GooseSubscription wanted = subscription();
    wanted.simulation = true;
    GooseSupervision sut{wanted};
    GooseBench test_set{1, trip(), true};
    test_set.start(0);
    test_set.run(sut, 20 * kMs);
    EXPECT_TRUE(sut.state().alive);
    EXPECT_TRUE(sut.state().simulated);
    EXPECT_TRUE(sut.expire(*sut.deadline()));
    EXPECT_FALSE(sut.state().simulated);
}

TEST(GooseSupervision, ShowsTheQualityOfTheMembersAndTheNumberOfTheState) {
    GooseSupervision sut{subscription()};
    GooseBench bench;
    bench.start(0);
    bench.run(sut, 20 * kMs);
    bench.quality(quality::kTest | quality::kInvalid, 21 * kMs);
    bench.run(sut, 21 * kMs);
    EXPECT_EQ(sut.state().quality, quality::kTest | quality::kInvalid);
    EXPECT_EQ(sut.state().counter, 2U);
}

TEST(GooseSupervision, WhatIsOfAnotherControlBlockIsNothing) {
    GooseSubscription other = subscription();
    other.gocb_ref = "OTHERLD0/LLN0$GO$gcb";
    GooseSupervision sut{other};
    GooseBench bench{2};
    bench.start(0);
    bench.run(sut, 20 * kMs);
    EXPECT_EQ(sut.state(), SupervisionState{});
}

/// A merging unit of one current with quality, and its subscriber.
class SvBench {
  public:
    SvBench() : frame_{*SvTemplate::create(sv_address(), {description()})}, sut{wanted(), set()} {}

    bool send(std::uint16_t count, std::uint32_t q = 0, std::uint32_t conf_rev = 1, std::uint8_t synch = kGlobalClock,
              bool simulated = false) {
        frame_.set_smp_cnt(0, count);
        frame_.set_conf_rev(0, conf_rev);
        frame_.set_smp_synch(0, synch);
        frame_.set_simulated(simulated);
        SvLayout{set()}.write(1, Value::quality(q), frame_.sample(0));
        SvFrame decoded;
        EXPECT_TRUE(decode_sv(frame_.frame(), decoded));
        now_ += 1'000'000'000 / 4800;
        return sut.receive(decoded.header, decoded.view()[0], now_);
    }
    void run(std::uint16_t from, std::uint16_t until) {
        for (std::uint16_t n = from; n < until; ++n) {
            send(n);
        }
    }

  private:
    static DataSet set() { return {{DataNode::leaf("i", BasicType::int32), DataNode::leaf("q", BasicType::quality)}}; }
    static AsduDescription description() {
        AsduDescription out;
        out.sv_id = "MU01";
        out.conf_rev = 1;
        out.sample_octets = SvLayout{set()}.sample_octets();
        return out;
    }
    static SvSubscription wanted() {
        SvSubscription out;
        out.sv_id = "MU01";
        out.sample_octets = SvLayout{set()}.sample_octets();
        return out;
    }
    SvTemplate frame_;
    std::int64_t now_{0};

  public:
    SvSupervision sut;
};

TEST(SvSupervision, ChangesOnlyWhenSomethingIsOtherwise) {
    SvBench b;
    EXPECT_TRUE(b.send(0));
    EXPECT_FALSE(b.send(1));
    EXPECT_TRUE(b.send(2, quality::kInvalid));
    EXPECT_EQ(b.sut.state().quality, quality::kInvalid);
    EXPECT_TRUE(b.send(3, 0, 1, kNotSynchronised));
    EXPECT_EQ(b.sut.state().counter, kNotSynchronised);
    EXPECT_TRUE(b.sut.state().alive);
}

TEST(SvSupervision, TellsAnotherConfRevAndASimulatedFrameApart) {
    SvBench b;
    b.run(0, 10);
    EXPECT_TRUE(b.send(10, 0, 2));
    EXPECT_EQ(b.sut.state().problem, SubscriptionProblem::conf_rev);
    EXPECT_TRUE(b.sut.state().needs_commissioning);
    EXPECT_EQ(b.sut.state().conf_rev, 2U);
    SvBench other;
    other.run(0, 10);
    EXPECT_TRUE(other.send(10, 0, 1, kGlobalClock, true));
    EXPECT_EQ(other.sut.state().problem, SubscriptionProblem::simulation);
    EXPECT_FALSE(other.sut.state().needs_commissioning);
    EXPECT_FALSE(other.sut.state().simulated);
}

TEST(SvSupervision, AProblemIsOverATenthOfASecondAfterItsLastFrame) {
    SvBench b;
    b.run(0, 10);
    b.send(10, 0, 2);
    b.run(10, 480);
    EXPECT_EQ(b.sut.state().problem, SubscriptionProblem::conf_rev);
    b.run(480, 520);
    EXPECT_EQ(b.sut.state().problem, SubscriptionProblem::none);
}

TEST(SvSupervision, IsLostWhenNoSampleComes) {
    SvBench b;
    b.run(0, 10);
    EXPECT_TRUE(b.sut.expire(*b.sut.deadline()));
    EXPECT_FALSE(b.sut.state().alive);
}

} // namespace
} // namespace gridspace::iec61850
