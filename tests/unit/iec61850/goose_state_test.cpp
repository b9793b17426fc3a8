// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "hex.hpp"

#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/quality.hpp"

#include <gmock/gmock.h>

namespace gridspace::iec61850 {
namespace {

using testing::ElementsAre;

constexpr std::int64_t kMs = 1'000'000;
constexpr std::int64_t kUtc = 1'575'158'400LL * 1'000'000'000;

GooseDescription two_leaves() {
    GooseDescription out = one_boolean();
    out.data_set = {{DataNode::leaf("trip", BasicType::boolean), DataNode::leaf("q", BasicType::quality),
                     DataNode::leaf("t", BasicType::timestamp)}};
    return out;
}

GoosePublisher publisher(GooseTiming timing = {1 * kMs, 10 * kMs, 2, 3, 30}, std::uint32_t conf_rev = 1) {
    return {*GooseTemplate::create(sv_address(), two_leaves()), conf_rev, {.timing = timing}};
}

struct Sent {
    std::int64_t at_ms;
    std::uint32_t st_num, sq_num, live_ms;
    friend bool operator==(Sent const&, Sent const&) = default;
};

/// Everything that is due up to `until`, polled exactly when it is.
std::vector<Sent> run(GoosePublisher& sut, std::int64_t until) {
    std::vector<Sent> out;
    while (sut.due() && *sut.due() <= until) {
        std::int64_t const now = *sut.due();
        GooseFrame frame;
        EXPECT_TRUE(decode_goose(sut.take(now), frame));
        out.push_back({now / kMs, frame.st_num, frame.sq_num, frame.live_ms});
    }
    return out;
}

TEST(GoosePublisher, SendsAtOnceAndThenAtGrowingIntervals) {
    auto sut = publisher();
    EXPECT_FALSE(sut.due());
    EXPECT_TRUE(sut.take(0).empty());
    sut.start(0, kUtc);
    EXPECT_EQ(run(sut, 46 * kMs), (std::vector<Sent>{{0, 1, 0, 30},
                                                     {1, 1, 1, 30},
                                                     {3, 1, 2, 30},
                                                     {7, 1, 3, 30},
                                                     {15, 1, 4, 30},
                                                     {25, 1, 5, 30},
                                                     {35, 1, 6, 30},
                                                     {45, 1, 7, 30}}));
}

TEST(GoosePublisher, PromisesToLiveAMultipleOfTheNextInterval) {
    auto sut = publisher({4 * kMs, 500 * kMs, 2, 3, 0});
    sut.start(0, kUtc);
    std::vector<std::uint32_t> live;
    for (Sent const& sent : run(sut, 1'600 * kMs)) {
        live.push_back(sent.live_ms);
    }
    // A merging unit on the market: 4, 8, .., 256, 500 ms with exactly three times the next interval.
    EXPECT_THAT(live, ElementsAre(12, 24, 48, 96, 192, 384, 768, 1500, 1500, 1500));
}

TEST(GoosePublisher, NeverPromisesLessThanTheNextInterval) {
    auto sut = publisher({2'500'000, 1000 * kMs, 1.5, 0.1, 0});
    sut.start(0, kUtc);
    std::int64_t last = -1;
    std::uint32_t live = 0;
    for (int i = 0; i < 30; ++i) {
        std::int64_t const now = *sut.due();
        if (last >= 0) {
            EXPECT_GT(std::int64_t{live} * kMs, now - last) << i;
        }
        GooseFrame frame;
        ASSERT_TRUE(decode_goose(sut.take(now), frame));
        live = frame.live_ms;
        last = now;
    }
}

TEST(GoosePublisher, BeginsANewStateForAValueAndForAQualityButNotForATime) {
    auto sut = publisher();
    sut.start(0, kUtc);
    run(sut, 50 * kMs);
    sut.set(2, Value::of(UtcTime{5, 6, 7}));
    EXPECT_FALSE(sut.commit(51 * kMs, kUtc));
    sut.set(0, Value::of(false));
    EXPECT_FALSE(sut.commit(52 * kMs, kUtc)) << "the same value again";
    sut.set(0, Value::of(true));
    EXPECT_TRUE(sut.commit(53 * kMs, kUtc + 53 * kMs));
    EXPECT_THAT(run(sut, 54 * kMs), ElementsAre(Sent{53, 2, 0, 30}, Sent{54, 2, 1, 30}));
    EXPECT_EQ(sut.state().t, UtcTime::from_nanoseconds(kUtc + 53 * kMs, 0x0A));
    sut.set(1, Value::quality(quality::kTest));
    EXPECT_TRUE(sut.commit(55 * kMs, kUtc));
    EXPECT_EQ(sut.state().st_num, 3U);
}

TEST(GoosePublisher, LeavesOutTheBitOfAQualityThatOnlySampledValuesHave) {
    auto sut = publisher();
    EXPECT_EQ(sut.set(1, Value::quality(quality::kQuestionable | quality::kDerived)), GooseTemplate::Stored::changed);
    EXPECT_EQ(sut.frame().get(1).bits, quality::kQuestionable);
    EXPECT_EQ(sut.set(1, Value::quality(quality::kQuestionable)), GooseTemplate::Stored::same);
    EXPECT_EQ(sut.set(1, Value::quality(0x4000)), GooseTemplate::Stored::refused);
    EXPECT_EQ(sut.counters().refused, 1U);
}

TEST(GoosePublisher, BeginsNoStateForAValueThatCameBack) {
    GooseDescription description = one_boolean();
    description.data_set = {
        {DataNode::leaf("trip", BasicType::boolean), DataNode::leaf("name", BasicType::visible_string, 8)}};
    GoosePublisher sut{*GooseTemplate::create(sv_address(), description), 1, {}};
    sut.set(1, Value::visible("a"));
    sut.start(0, kUtc);
    sut.set(0, Value::of(true));
    sut.set(0, Value::of(false));
    sut.set(1, Value::visible("b"));
    sut.set(1, Value::visible("a"));
    EXPECT_FALSE(sut.commit(1 * kMs, kUtc)) << "nobody has seen another value";
    EXPECT_EQ(sut.state().st_num, 1U);
    sut.set(0, Value::of(true));
    EXPECT_TRUE(sut.commit(2 * kMs, kUtc));
    sut.set(0, Value::of(false));
    EXPECT_TRUE(sut.commit(3 * kMs, kUtc)) << "a pulse of two states";
    sut.set(1, Value::visible("ab"));
    EXPECT_TRUE(sut.commit(4 * kMs, kUtc));
    EXPECT_EQ(sut.state().st_num, 4U);
}

TEST(GoosePublisher, RestartsTheBurstWhenAnotherChangeComesDuringIt) {
    auto sut = publisher();
    sut.start(0, kUtc);
    run(sut, 5 * kMs);
    sut.set(0, Value::of(true));
    sut.commit(5 * kMs, kUtc);
    EXPECT_THAT(run(sut, 13 * kMs),
                ElementsAre(Sent{5, 2, 0, 30}, Sent{6, 2, 1, 30}, Sent{8, 2, 2, 30}, Sent{12, 2, 3, 30}));
}

TEST(GoosePublisher, DoesNotDriftWhenItIsPolledLateAndDoesNotBurstAfterAStall) {
    auto sut = publisher({10 * kMs, 10 * kMs, 1, 3, 0});
    sut.start(0, kUtc);
    EXPECT_FALSE(sut.take(4 * kMs).empty());
    EXPECT_EQ(sut.due(), 10 * kMs);
    EXPECT_FALSE(sut.take(107 * kMs).empty());
    EXPECT_TRUE(sut.take(108 * kMs).empty());
    EXPECT_EQ(sut.due(), 117 * kMs);
    EXPECT_EQ(sut.counters().late, 1U);
}

TEST(GoosePublisher, RollsItsCountersOverToOne) {
    GoosePublisherParams params;
    params.first_st_num = 0xFFFFFFFF;
    params.first_sq_num = 0xFFFFFFFE;
    GoosePublisher sut{*GooseTemplate::create(sv_address(), two_leaves()), 1, params};
    sut.start(0, kUtc);
    std::vector<std::uint32_t> sq;
    for (Sent const& sent : run(sut, 10 * kMs)) {
        sq.push_back(sent.sq_num);
    }
    EXPECT_THAT(sq, ElementsAre(0xFFFFFFFE, 0xFFFFFFFF, 1));
    sut.set(0, Value::of(true));
    sut.commit(20 * kMs, kUtc);
    EXPECT_EQ(sut.state().st_num, 1U);
    EXPECT_EQ(sut.state().sq_num, 0U);
}

TEST(GoosePublisher, AsksForCommissioningWithoutAConfigurationRevision) {
    auto sut = publisher({}, 0);
    sut.start(0, kUtc);
    GooseFrame frame;
    ASSERT_TRUE(decode_goose(sut.take(0), frame));
    EXPECT_TRUE(frame.nds_com);
}

TEST(GoosePublisher, SaysItsStateOnceMoreWhenItStops) {
    auto sut = publisher();
    EXPECT_TRUE(sut.last(0).empty()) << "it never started";
    sut.start(0, kUtc);
    run(sut, 20 * kMs);
    std::uint32_t const sq = sut.state().sq_num;
    EXPECT_FALSE(sut.last(21 * kMs).empty());
    EXPECT_EQ(sut.state().sq_num, sq + 1);
}

TEST(DataSet, FindsTheTimeBesideAMember) {
    auto const inside = [](char const* name) {
        return DataNode{name,
                        DataNode::Kind::structure,
                        BasicType::boolean,
                        0,
                        {DataNode::leaf("general", BasicType::boolean), DataNode::leaf("q", BasicType::quality),
                         DataNode::leaf("t", BasicType::timestamp)}};
    };
    std::vector<Leaf> const nested = leaves_of({{inside("Str"), inside("Op")}});
    EXPECT_EQ(time_next_to(nested, 0), 2U);
    EXPECT_EQ(time_next_to(nested, 3), 5U);
    EXPECT_EQ(time_next_to(leaves_of(two_leaves().data_set), 0), 2U);
    EXPECT_FALSE(time_next_to(leaves_of({{DataNode::leaf("trip", BasicType::boolean), inside("Op")}}), 0));
    EXPECT_FALSE(time_next_to(
        leaves_of({{DataNode::leaf("trip", BasicType::boolean), DataNode::leaf("t", BasicType::int64)}}), 0));
}

/// A message with chosen counters, as the subscriber gets it.
struct Message {
    GooseState state;
    bool trip{false};
    GooseDescription description{two_leaves()};

    [[nodiscard]] Buffer octets() const {
        auto frame = GooseTemplate::create(sv_address(), description);
        frame->set(0, Value::of(trip));
        Octets const out = frame->frame(state);
        return {out.begin(), out.end()};
    }
};

Message message(std::uint32_t st, std::uint32_t sq, bool trip = false) {
    Message out;
    out.state.st_num = st;
    out.state.sq_num = sq;
    out.state.live_ms = 30;
    out.state.t = UtcTime::from_nanoseconds(kUtc + std::int64_t{st} * 1'000 * kMs);
    out.trip = trip;
    return out;
}

GooseSubscription subscription() {
    GooseSubscription out;
    out.gocb_ref = "A/LLN0$GO$g";
    out.data_set = two_leaves().data_set;
    return out;
}

GooseVerdict give(GooseSubscriber& sut, Message const& m, std::int64_t now, std::int64_t utc = kUtc) {
    Buffer const octets = m.octets();
    GooseFrame frame;
    EXPECT_TRUE(decode_goose(octets, frame));
    return sut.receive(frame, now, utc);
}

TEST(GooseSubscriber, TakesTheFirstMessageWhateverItsSequenceNumber) {
    GooseSubscriber sut{subscription()};
    EXPECT_EQ(sut.status(), GooseStatus::waiting);
    auto const verdict = give(sut, message(7, 12, true), 0);
    EXPECT_EQ(verdict.event, GooseEvent::first);
    EXPECT_TRUE(verdict.accepted);
    EXPECT_TRUE(sut.value(0).boolean());
    EXPECT_EQ(sut.status(), GooseStatus::good);
    EXPECT_EQ(sut.deadline(), 30 * kMs);
}

TEST(GooseSubscriber, CountsLossAndSkippedStates) {
    GooseSubscriber sut{subscription()};
    give(sut, message(1, 0), 0);
    EXPECT_EQ(give(sut, message(1, 1), 1).event, GooseEvent::repetition);
    EXPECT_EQ(give(sut, message(1, 4), 2).lost, 2U);
    auto const change = give(sut, message(4, 1, true), 3);
    EXPECT_EQ(change.event, GooseEvent::state_change);
    EXPECT_EQ(change.skipped_states, 2U);
    EXPECT_EQ(sut.counters().skipped_states, 2U);
    EXPECT_EQ(sut.counters().lost, 3U);
}

TEST(GooseSubscriber, MeasuresTheRateOfTheMessagesThatItTook) {
    GooseSubscriber sut{subscription()};
    give(sut, message(1, 0), 0);
    EXPECT_EQ(sut.arrivals().rate_hz(), 0.0);
    give(sut, message(1, 1), 20 * kMs);
    give(sut, message(1, 1), 25 * kMs); // twice: not taken
    give(sut, message(1, 2), 30 * kMs);
    give(sut, message(2, 0, true), 50 * kMs);
    EXPECT_DOUBLE_EQ(sut.arrivals().rate_hz(), 3 / 0.05);
    EXPECT_EQ(sut.arrivals().shortest_ns(), 10 * kMs);
    EXPECT_EQ(sut.arrivals().longest_ns(), 20 * kMs);
}

TEST(GooseSubscriber, DropsDuplicatesAndOvertakenMessages) {
    GooseSubscriber sut{subscription()};
    give(sut, message(5, 3, true), 0);
    EXPECT_EQ(give(sut, message(5, 3, true), 1).event, GooseEvent::duplicate);
    EXPECT_EQ(give(sut, message(5, 2, true), 1).event, GooseEvent::out_of_order);
    auto const older = give(sut, message(4, 9, false), 2);
    EXPECT_EQ(older.event, GooseEvent::out_of_order) << "the state began before the one that is held";
    EXPECT_FALSE(older.accepted);
    EXPECT_TRUE(sut.value(0).boolean());
}

TEST(GooseSubscriber, TakesARestartedPublisherAtOnceUnlessItIsStrict) {
    for (bool const strict : {false, true}) {
        GooseSubscription s = subscription();
        s.strict = strict;
        GooseSubscriber sut{s};
        give(sut, message(50, 9, true), 0);
        Message restarted = message(1, 0, false);
        restarted.state.t = UtcTime::from_nanoseconds(kUtc + 100'000 * kMs);
        auto const verdict = give(sut, restarted, 1 * kMs);
        EXPECT_EQ(verdict.event, strict ? GooseEvent::stale : GooseEvent::restart);
        EXPECT_EQ(sut.value(0).boolean(), strict);
        if (strict) {
            EXPECT_TRUE(sut.expire(30 * kMs));
            EXPECT_EQ(give(sut, restarted, 31 * kMs).event, GooseEvent::resumed);
            EXPECT_FALSE(sut.value(0).boolean());
        }
    }
}

TEST(GooseSubscriber, TakesARestartedPublisherThatHasNoClockYetAndSaysSo) {
    for (std::uint8_t const quality : std::initializer_list<std::uint8_t>{0x0A, 0x3F, 0x4A}) {
        for (std::uint32_t const held : {2U, 50U}) {
            GooseSubscriber sut{subscription()};
            give(sut, message(held, 7, true), 0);
            Message restarted = message(1, 0, false);
            restarted.state.t = UtcTime::from_nanoseconds(1'000, quality); // 1970
            auto const verdict = give(sut, restarted, 1 * kMs);
            bool const says_so = quality != 0x0A;
            EXPECT_EQ(verdict.event, says_so && held > 2 ? GooseEvent::restart : GooseEvent::out_of_order) << held;
        }
    }
}

TEST(GooseSubscriber, TakesAPublisherThatWasRestartedAtTheSameStateNumber) {
    for (bool const strict : {false, true}) {
        for (std::uint32_t const held : {0U, 9U}) {
            GooseSubscription s = subscription();
            s.strict = strict;
            GooseSubscriber sut{s};
            give(sut, message(1, held, true), 0);
            Message restarted = message(1, 0, false);
            restarted.state.t = UtcTime::from_nanoseconds(kUtc + 100'000 * kMs);
            auto const verdict = give(sut, restarted, 1 * kMs);
            EXPECT_EQ(verdict.event == GooseEvent::restart, !strict);
            EXPECT_EQ(sut.value(0).boolean(), strict);
            if (!strict) {
                EXPECT_TRUE(verdict.changed);
                EXPECT_EQ(give(sut, message(1, held + 1, true), 2 * kMs).event, GooseEvent::inconsistent)
                    << "of the life before";
            }
        }
    }
}

TEST(GooseSubscriber, DoesNotBelieveAnAbsurdLoss) {
    for (std::uint32_t const st : {1U, 2U}) { // a repetition, a new state
        GooseSubscriber sut{subscription()};
        give(sut, message(1, 0), 0);
        EXPECT_TRUE(give(sut, message(st, 0xFFFFFFFF, st == 2), 1).accepted);
        EXPECT_EQ(sut.counters().lost, 30U) << "one in each millisecond of its time to live";
    }
    GooseSubscriber sut{subscription()};
    give(sut, message(1, 0), 0);
    give(sut, message(0xFFFFFFFF, 0, true), 1);
    EXPECT_EQ(sut.counters().skipped_states, 30U);
}

TEST(GooseSubscriber, StrictlyNeedsASecondMessageBeforeItBelievesAJump) {
    GooseSubscription s = subscription();
    s.strict = true;
    GooseSubscriber sut{s};
    give(sut, message(5, 0), 0);
    EXPECT_EQ(give(sut, message(0xFFFFFFF0, 0, true), 1).event, GooseEvent::unconfirmed_jump);
    EXPECT_FALSE(sut.value(0).boolean());
    EXPECT_EQ(give(sut, message(5, 1), 2).event, GooseEvent::repetition)
        << "the poison must not shut out the publisher";
    EXPECT_EQ(give(sut, message(0xFFFFFFF0, 1, true), 3).event, GooseEvent::unconfirmed_jump);
    EXPECT_EQ(give(sut, message(6, 0, true), 4).event, GooseEvent::state_change);
    EXPECT_EQ(give(sut, message(9, 0), 5).event, GooseEvent::unconfirmed_jump);
    EXPECT_EQ(give(sut, message(9, 1), 6).event, GooseEvent::state_change) << "the publisher really is there";
}

TEST(GooseSubscriber, StrictlyRefusesStatesFromAnotherTime) {
    GooseSubscription s = subscription();
    s.strict = true;
    s.max_skew_ns = 2'000 * kMs;
    GooseSubscriber sut{s};
    give(sut, message(1, 0), 0, kUtc + 1'000 * kMs);
    EXPECT_EQ(give(sut, message(2, 0), 1, kUtc + 10'000 * kMs).event, GooseEvent::stale);
    EXPECT_EQ(give(sut, message(2, 0), 1, kUtc + 2'500 * kMs).event, GooseEvent::state_change);
}

TEST(GooseSubscriber, NoticesSilenceByItselfAndActsFailSafe) {
    GooseSubscription s = subscription();
    s.fail_safe = {FailSafe{true, Value::of(false)}};
    GooseSubscriber sut{s};
    give(sut, message(1, 0, true), 0);
    EXPECT_FALSE(sut.expire(29 * kMs));
    EXPECT_TRUE(sut.value(0).boolean());
    EXPECT_TRUE(sut.expire(30 * kMs));
    EXPECT_FALSE(sut.expire(31 * kMs)) << "said once";
    EXPECT_EQ(sut.status(), GooseStatus::expired);
    EXPECT_FALSE(sut.value(0).boolean());
    EXPECT_FALSE(sut.deadline());
    EXPECT_EQ(give(sut, message(1, 9, true), 50 * kMs).event, GooseEvent::resumed);
    EXPECT_TRUE(sut.value(0).boolean());
}

TEST(GooseSubscriber, GoesOnWithAMessageThatComesJustWhenItsTimeIsOver) {
    for (std::int64_t const late_ns : {0, 1}) {
        GooseSubscriber sut{subscription()};
        give(sut, message(1, 0, true), 0);
        auto const event = give(sut, message(1, 1, true), 30 * kMs + late_ns).event;
        EXPECT_EQ(event, late_ns == 0 ? GooseEvent::repetition : GooseEvent::resumed);
        EXPECT_EQ(sut.counters().expired, late_ns == 0 ? 0U : 1U);
    }
}

TEST(GooseSubscriber, HoldsTheLastValueAfterSilenceWhenNothingElseIsAsked) {
    GooseSubscriber sut{subscription()};
    give(sut, message(1, 0, true), 0);
    sut.expire(kUtc);
    EXPECT_TRUE(sut.value(0).boolean());
}

TEST(GooseSubscriber, ChecksWhatItWasConfiguredWith) {
    GooseSubscription s = subscription();
    s.app_id = 0x4000;
    s.dat_set = "A/LLN0$d";
    s.go_id = "G";
    GooseSubscriber sut{s};
    Message other = message(1, 0);
    other.description.gocb_ref = "B/LLN0$GO$g";
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::not_ours);
    other = message(1, 0);
    other.description.dat_set = "A/LLN0$e";
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::identity_mismatch);
    other = message(1, 0);
    other.description.go_id = "H";
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::identity_mismatch);
    other = message(1, 0);
    other.description.conf_rev = 2;
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::conf_rev_mismatch);
    other = message(1, 0);
    other.state.nds_com = true;
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::needs_commissioning);
    other = message(1, 0);
    other.state.live_ms = 0;
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::no_time_to_live);
    other = message(1, 0);
    other.description.data_set.members.pop_back();
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::data_set_mismatch);
    other = message(1, 0);
    other.description.data_set.members[1].type = BasicType::int32;
    EXPECT_EQ(give(sut, other, 0).event, GooseEvent::data_set_mismatch);
    EXPECT_EQ(sut.status(), GooseStatus::waiting);
    EXPECT_TRUE(give(sut, message(1, 0), 0).accepted) << "and takes what is right";
}

TEST(GooseSubscriber, DoesNotTakeOtherValuesWithoutANewState) {
    GooseSubscriber sut{subscription()};
    give(sut, message(1, 0, false), 0);
    EXPECT_EQ(give(sut, message(1, 1, true), 1).event, GooseEvent::inconsistent);
    EXPECT_FALSE(sut.value(0).boolean());
}

TEST(GooseSubscriber, PrefersSimulatedMessagesOnlyWhileItIsTold) {
    GooseSubscriber sut{subscription()};
    Message simulated = message(1, 0, true);
    simulated.state.simulation = true;
    EXPECT_EQ(give(sut, simulated, 0).event, GooseEvent::simulation_refused);
    sut.set_simulation(true);
    EXPECT_TRUE(give(sut, message(1, 0), 1).accepted) << "real ones until a simulated one comes";
    simulated.state.st_num = 2;
    EXPECT_TRUE(give(sut, simulated, 2).accepted);
    EXPECT_EQ(give(sut, message(3, 0), 3).event, GooseEvent::simulation_refused);
    sut.set_simulation(false);
    EXPECT_TRUE(give(sut, message(3, 0), 4).accepted);
}

TEST(GooseSubscriber, FollowsThePublisherThroughBothRollovers) {
    GooseSubscriber sut{subscription()};
    give(sut, message(0xFFFFFFFF, 0xFFFFFFFF), 0);
    auto const repeated = give(sut, message(0xFFFFFFFF, 1), 1);
    EXPECT_EQ(repeated.event, GooseEvent::repetition);
    EXPECT_EQ(repeated.lost, 0U);
    auto const changed = give(sut, message(1, 0, true), 2);
    EXPECT_EQ(changed.event, GooseEvent::state_change);
    EXPECT_EQ(changed.skipped_states, 0U);
}

TEST(GooseSubscriber, UnderstandsWhatThePublisherSays) {
    auto source = publisher();
    source.start(0, kUtc);
    GooseSubscriber sut{subscription()};
    for (std::int64_t now = 0; now < 100 * kMs; now += kMs / 2) {
        if (now == 40 * kMs) {
            source.set(0, Value::of(true));
            source.commit(now, kUtc + now);
        }
        if (Octets const octets = source.take(now); !octets.empty()) {
            GooseFrame frame;
            ASSERT_TRUE(decode_goose(octets, frame));
            EXPECT_TRUE(sut.receive(frame, now).accepted);
        }
        EXPECT_FALSE(sut.expire(now));
        EXPECT_EQ(sut.value(0).boolean(), now >= 40 * kMs);
    }
    EXPECT_EQ(sut.counters().lost, 0U);
    EXPECT_EQ(sut.counters().of(GooseEvent::state_change), 1U);
}

} // namespace
} // namespace gridspace::iec61850
