// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A line differential relay behind two streams of sampled values of which one goes wrong: one test for each way in
// which it can. The table of docs/reference/bad_streams.md names these tests.
#include "agents/relay/current_inputs.hpp"
#include "agents/relay/line_relay.hpp"
#include "gateways/iec61850/quality.hpp"

#include "tests/unit/relay/waves.hpp"

#include <gmock/gmock.h>
#include <vector>

namespace gridspace::relay {
namespace {

namespace quality = iec61850::quality;
using iec61850::SvEvent;
using testing::ElementsAre;
using testing::IsEmpty;

constexpr std::int64_t kRate = 4800, kWindow = 80, kPartnerNs = 20'000'000;

/// Three currents, each with its quality, from an address of its own.
streams::Stream stream(std::string sv_id, std::uint16_t app_id) {
    streams::Stream out;
    out.name.name = out.sv_id = std::move(sv_id);
    out.address.destination = *iec61850::Mac::parse("01:0C:CD:04:00:21");
    out.address.app_id = app_id;
    for (char const* phase : {"Ia", "Ib", "Ic"}) {
        out.data_set.members.push_back(iec61850::DataNode::leaf(phase, iec61850::BasicType::float32));
        out.data_set.members.push_back(
            iec61850::DataNode::leaf(std::string{phase} + "_q", iec61850::BasicType::quality));
    }
    return out;
}

/// What is odd about a frame of one end.
struct Odd {
    std::uint32_t quality{0}; ///< of phase a
    std::int64_t shift{0};    ///< of smpCnt
    std::uint32_t conf_rev{1};
    std::uint8_t synch{iec61850::kGlobalClock};
    bool simulated{false}, silent{false}, longer{false};
};

/// Two merging units at the ends of a line, and a relay. Sample by sample; both ends read the load, or a fault.
class Line {
  public:
    explicit Line(RelayParams params = {})
        : inputs_{*CurrentInputs::create(
              streams_[0], streams_[1],
              {{kPhases, kPhases}, kPartnerNs, params.max_interpolated, {}, params.test_mode})},
          relay{with_pickup(params)} {
        inputs_.on_refusal([this](std::size_t end, SvEvent why, iec61850::Asdu const& asdu) {
            refusals.push_back(fmt_of(end, why, asdu.conf_rev));
        });
        inputs_.on_silence([this](std::size_t end) {
            relay.lost(end == 0 ? kFromLost : kToLost);
            reasons |= relay.output().blocked;
        });
    }

    /// `samples` instants, with `odd` frames of the `to` end (and of the `from` end `other`).
    void run(std::int64_t samples, Odd odd = {}, Odd other = {}) {
        reasons = 0;
        for (std::int64_t i = 0; i < samples; ++i, ++index_) {
            std::int64_t const now = index_ * 1'000'000'000 / kRate;
            inputs_.elapse(now - 1, on_pair_);
            send(0, other, now);
            send(1, odd, now);
        }
    }
    void fault() { faulted_ = true; }

    [[nodiscard]] bool blocked() const { return relay.output().blocked != 0; }
    [[nodiscard]] std::uint64_t refused(SvEvent event) const { return inputs_.end(1).subscriber.counters().of(event); }

  private:
    static inline CurrentInputs::Members const kPhases{std::array<std::string, 3>{"Ia", "Ib", "Ic"}, {}};
    static RelayParams with_pickup(RelayParams p) {
        p.element.pickup_a = 30;
        return p;
    }
    static std::string fmt_of(std::size_t end, SvEvent why, std::uint32_t conf_rev) {
        return std::string{end == 0 ? "from " : "to "} + std::string{event_name(why)} + " " + std::to_string(conf_rev);
    }

    void send(std::size_t end, Odd const& odd, std::int64_t now) {
        if (odd.silent) {
            return;
        }
        streams::Stream described = streams_[end];
        if (odd.longer) {
            described.data_set.members.push_back(iec61850::DataNode::leaf("more", iec61850::BasicType::int32));
        }
        auto frame = *described.sv_template(iec61850::Mac{{2, 0, 0, 0, 0, static_cast<std::uint8_t>(1 + end)}});
        frame.set_smp_cnt(0, static_cast<std::uint16_t>((index_ + odd.shift) % kRate));
        frame.set_smp_synch(0, odd.synch);
        frame.set_conf_rev(0, odd.conf_rev);
        frame.set_simulated(odd.simulated);
        Abc const i = faulted_ ? wave(end == 0 ? 300 : 80, end == 0 ? 0 : 180, index_) : wave(12.66, 0, index_);
        iec61850::SvLayout const layout{described.data_set};
        for (std::size_t p = 0; p < 3; ++p) {
            iec61850::store_float(frame.sample(0), 8 * p, static_cast<float>(i[p]));
            layout.write(2 * p + 1, iec61850::Value::quality(p == 0 ? odd.quality : 0), frame.sample(0));
        }
        inputs_.frame(frame.frame(), now, on_pair_);
    }

    std::array<streams::Stream, 2> streams_{stream("A", 0x4021), stream("B", 0x4022)};
    CurrentInputs inputs_;
    CurrentInputs::OnPair on_pair_{[this](LineSample const& s) {
        relay.step(s);
        reasons |= relay.output().blocked;
    }};
    std::int64_t index_{0};
    bool faulted_{false};

  public:
    LineRelay relay;
    BlockReasons reasons{0}; ///< all that blocked it since the last run() began
    std::vector<std::string> refusals;
};

void start(Line& line) {
    line.run(2 * kWindow);
    ASSERT_FALSE(line.blocked());
}

/// The stream has been well again for a window: the relay works, and trips for a fault.
void expect_recovered(Line& line) {
    line.run(2 * kWindow);
    EXPECT_FALSE(line.blocked());
    EXPECT_FALSE(line.relay.output().trip) << "nothing has happened on the line so far";
    line.fault();
    line.run(kWindow);
    EXPECT_TRUE(line.relay.output().trip);
}

TEST(BadStream, NothingOddBlocksNothing) { // the control of all that follow
    Line sut;
    start(sut);
    sut.run(kRate / 10);
    EXPECT_EQ(sut.reasons, 0U);
    EXPECT_THAT(sut.refusals, IsEmpty());
    expect_recovered(sut);
}

TEST(BadStream, OneThatStopsBlocksAndAFaultDoesNotTrip) {
    Line sut;
    start(sut);
    sut.fault();
    sut.run(kRate / 10, {.silent = true});
    EXPECT_TRUE(sut.blocked());
    EXPECT_NE(sut.reasons & kToLost, 0U);
    EXPECT_FALSE(sut.relay.output().trip);
}

TEST(BadStream, OneThatComesBackIsTrustedAfterAWholeWindow) {
    Line sut;
    start(sut);
    sut.run(kRate / 10, {.silent = true});
    EXPECT_TRUE(sut.blocked());
    sut.run(kWindow / 2);
    EXPECT_TRUE(sut.blocked());
    expect_recovered(sut);
}

TEST(BadStream, OneThatComesBackIsTrustedHoweverLongItWasSilent) {
    for (std::int64_t const tenths : {4, 6, 9, 10, 11, 16, 26}) {
        for (bool const both : {false, true}) {
            SCOPED_TRACE(testing::Message() << tenths << " tenths of a second, " << (both ? "both" : "one"));
            Line sut;
            start(sut);
            sut.run(tenths * kRate / 10, {.silent = true}, {.silent = both});
            EXPECT_TRUE(sut.blocked());
            sut.run(kWindow / 2);
            EXPECT_TRUE(sut.blocked()) << "half of the window is of before the silence";
            expect_recovered(sut);
        }
    }
}

TEST(BadStream, BothThatStopBlockThoughNoPartnerIsMissing) {
    Line sut;
    start(sut);
    sut.run(kRate / 10, {.silent = true}, {.silent = true});
    EXPECT_EQ(sut.reasons & (kFromLost | kToLost), kFromLost | kToLost);
}

TEST(BadStream, ACounterThatJumpsBlocksAndIsNotComparedWithTheWrongSample) {
    for (std::int64_t const jump : {1000LL, 3800LL}) { // ahead, and back
        Line sut;
        start(sut);
        sut.run(kRate / 20, {.shift = jump});
        EXPECT_TRUE(sut.blocked()) << jump;
        EXPECT_FALSE(sut.relay.output().trip) << jump;
        sut.run(2 * kRate);
        SCOPED_TRACE(jump);
        expect_recovered(sut);
    }
}

TEST(BadStream, AJumpWithinThePartnerTimeoutBlocksUntilAWindowIsFullAgain) {
    Line sut;
    start(sut);
    sut.run(kWindow / 2, {.shift = 40});
    EXPECT_TRUE(sut.blocked());
    EXPECT_NE(sut.reasons & (kToLost | kFilling), 0U);
    sut.run(2 * kWindow, {.shift = 40});
    EXPECT_FALSE(sut.blocked()) << "it says that its clock is right, and its partner's samples come in time";
}

TEST(BadStream, AnotherConfRevIsRefusedSaidOnceAndBlocks) {
    Line sut;
    start(sut);
    sut.fault();
    sut.run(kRate / 10, {.conf_rev = 2});
    EXPECT_TRUE(sut.blocked());
    EXPECT_NE(sut.reasons & kToLost, 0U) << "none of its samples is used";
    EXPECT_FALSE(sut.relay.output().trip);
    EXPECT_EQ(sut.refused(SvEvent::conf_rev_mismatch), static_cast<std::uint64_t>(kRate / 10));
    EXPECT_THAT(sut.refusals, ElementsAre("to conf_rev_mismatch 2"));
}

TEST(BadStream, AConfRevThatIsRightAgainIsTaken) {
    Line sut;
    start(sut);
    sut.run(kRate / 10, {.conf_rev = 2});
    expect_recovered(sut);
    sut.run(kRate);
    sut.run(10, {.conf_rev = 7});
    EXPECT_THAT(sut.refusals, ElementsAre("to conf_rev_mismatch 2", "to conf_rev_mismatch 7"))
        << "after a good second it is news again";
}

TEST(BadStream, ADataSetOfAnotherSizeIsRefusedAndBlocks) {
    Line sut;
    start(sut);
    sut.run(kRate / 10, {.longer = true});
    EXPECT_TRUE(sut.blocked());
    EXPECT_THAT(sut.refusals, ElementsAre("to size_mismatch 1"));
    expect_recovered(sut);
}

struct QualityCase {
    std::uint32_t quality;
    bool blocks, blocks_lenient; ///< with accept_questionable
};

TEST(BadStream, QualityBlocksByValidityAndByItsDetails) {
    for (QualityCase const& c :
         {QualityCase{quality::kInvalid, true, true}, QualityCase{quality::kReserved, true, true},
          QualityCase{quality::kQuestionable, true, false},
          QualityCase{quality::kQuestionable | quality::kOldData, true, false},
          QualityCase{quality::kOldData, true, false}, // details beside "good": worth no more
          QualityCase{quality::kInaccurate, true, false}, QualityCase{quality::kInconsistent, true, false},
          QualityCase{quality::kOperatorBlocked, true, false}, QualityCase{quality::kOverflow, true, true},
          QualityCase{quality::kFailure, true, true}, QualityCase{quality::kSubstituted, false, false},
          QualityCase{quality::kDerived, false, false}}) {
        for (bool const lenient : {false, true}) {
            RelayParams params;
            params.accept_questionable = lenient;
            Line sut{params};
            start(sut);
            sut.run(kRate / 20, {.quality = c.quality});
            bool const blocks = lenient ? c.blocks_lenient : c.blocks;
            EXPECT_EQ(sut.reasons & kToQuality, blocks ? kToQuality : 0U) << c.quality << lenient;
            EXPECT_EQ(sut.blocked(), blocks) << c.quality << lenient;
            expect_recovered(sut);
        }
    }
}

TEST(BadStream, TheTestBitBlocksUnlessTheRelayIsInTest) {
    for (bool const in_test : {false, true}) {
        RelayParams params;
        params.test_mode = in_test;
        Line sut{params};
        start(sut);
        sut.run(kRate / 20, {.quality = quality::kTest});
        EXPECT_EQ(sut.reasons & kToTest, in_test ? 0U : kToTest);
        EXPECT_EQ(sut.blocked(), !in_test);
        expect_recovered(sut);
    }
}

TEST(BadStream, SimulatedFramesAreNotUsedUnlessTheRelayIsInTest) {
    for (bool const in_test : {false, true}) {
        RelayParams params;
        params.test_mode = in_test;
        Line sut{params};
        start(sut);
        sut.run(kRate / 10, {.simulated = true});
        EXPECT_EQ(sut.blocked(), !in_test);
        EXPECT_EQ(sut.refused(SvEvent::simulation_refused), in_test ? 0U : static_cast<std::uint64_t>(kRate / 10));
    }
}

TEST(BadStream, InTestRealFramesNoLongerCountOnceSimulatedOnesCame) {
    RelayParams params;
    params.test_mode = true;
    Line sut{params};
    start(sut);
    sut.run(10, {.simulated = true});
    sut.run(kRate / 10);
    EXPECT_TRUE(sut.blocked());
    EXPECT_GT(sut.refused(SvEvent::simulation_refused), 0U);
}

TEST(BadStream, NoClockAtOneSideBlocksAtOnce) {
    Line sut;
    start(sut);
    sut.run(1, {.synch = iec61850::kNotSynchronised});
    EXPECT_NE(sut.reasons & kToSynch, 0U);
    sut.run(kWindow / 2);
    EXPECT_TRUE(sut.blocked()) << "a window with a sample of unknown time is worth nothing";
    expect_recovered(sut);
}

TEST(BadStream, TwoLocalClocksAreComparedOnlyWhereTheyAreTheSame) {
    RelayParams params;
    params.required_synch = Synch::local;
    Line same{params};
    same.run(2 * kWindow, {.synch = 7}, {.synch = 7});
    EXPECT_FALSE(same.blocked());
    Line different{params};
    different.run(2 * kWindow, {.synch = 7}, {.synch = 8});
    EXPECT_TRUE(different.blocked());
    EXPECT_NE(different.reasons & kToSynch, 0U);
}

TEST(BadStream, ATripThatStandsIsKeptWhateverBecomesOfTheStream) {
    Line sut;
    start(sut);
    sut.fault();
    sut.run(kWindow);
    ASSERT_TRUE(sut.relay.output().trip);
    sut.run(kRate / 10, {.quality = quality::kInvalid});
    EXPECT_TRUE(sut.blocked());
    EXPECT_TRUE(sut.relay.output().trip) << "seal-in: only a reset takes it off";
}

} // namespace
} // namespace gridspace::relay
