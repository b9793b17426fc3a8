// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/current_inputs.hpp"

#include <gtest/gtest.h>
#include <vector>

namespace gridspace::relay {
namespace {

constexpr std::int64_t kPeriod = 208'333;
CurrentInputs::Members const kPhases{std::array<std::string, 3>{"Ia", "Ib", "Ic"}, {}};

streams::Stream stream(std::string sv_id, std::uint8_t synch = iec61850::kGlobalClock) {
    streams::Stream out;
    out.name.name = sv_id;
    out.sv_id = std::move(sv_id);
    out.address.destination = *iec61850::Mac::parse("01:0C:CD:04:00:21");
    out.address.app_id = 0x4021;
    out.smp_synch = synch;
    for (char const* phase : {"Ia", "Ib", "Ic"}) {
        out.data_set.members.push_back(iec61850::DataNode::leaf(phase, iec61850::BasicType::float32));
    }
    return out;
}

/// Two merging units, a relay's inputs, and what comes out of them.
class Bench {
  public:
    explicit Bench(gateways::FirstLineConfig::OnFinding on_finding, std::uint8_t from_synch = 2,
                   std::uint8_t to_synch = 2)
        : Bench{on_finding, {stream("A", from_synch), stream("B", to_synch)}} {}
    Bench(gateways::FirstLineConfig::OnFinding on_finding, std::array<streams::Stream, 2> streams,
          bool accept_test = false)
        : streams_{std::move(streams)},
          sut{*CurrentInputs::create(streams_[0], streams_[1],
                                     {{kPhases, kPhases}, 20'000'000, 3, {.on_finding = on_finding}, accept_test})} {
        sut.on_silence([this](std::size_t end) { silent.push_back(end); });
        sut.on_finding([this](std::size_t end, std::uint32_t found, iec61850::Mac const&) { findings[end] |= found; });
    }

    /// Sample `n` of an end, from the address that ends in `source`.
    void send(std::size_t end, std::uint16_t n, float value, std::uint8_t source = 1, bool simulated = false) {
        auto frame = *streams_[end].sv_template(iec61850::Mac{{2, 0, 0, 0, 0, source}});
        frame.set_smp_cnt(0, n);
        frame.set_simulated(simulated);
        iec61850::store_float(frame.sample(0), 0, value);
        sut.frame(frame.frame(), now_, [this](LineSample const& s) { out.push_back(s); });
    }
    /// A frame of samples `first`, ...; `value`, and one more for each.
    void send_frame(std::size_t end, std::uint16_t first, float value) {
        auto frame = *streams_[end].sv_template(iec61850::Mac{{2, 0, 0, 0, 0, 1}});
        for (std::size_t i = 0; i < frame.asdus(); ++i) {
            frame.set_smp_cnt(i, static_cast<std::uint16_t>(first + i));
            iec61850::store_float(frame.sample(i), 0, value + static_cast<float>(i));
        }
        sut.frame(frame.frame(), now_, [this](LineSample const& s) { out.push_back(s); });
    }
    void next() { now_ += kPeriod; }
    /// Nothing comes until `at_ns`.
    void elapse(std::int64_t at_ns) {
        now_ = at_ns;
        sut.elapse(now_, [this](LineSample const& s) { out.push_back(s); });
    }
    [[nodiscard]] std::int64_t now() const { return now_; }

  private:
    std::array<streams::Stream, 2> streams_;
    std::int64_t now_{0};

  public:
    CurrentInputs sut;
    std::vector<LineSample> out;
    std::array<std::uint32_t, 2> findings{};
    std::vector<std::size_t> silent;
};

constexpr auto kRefuse = gateways::FirstLineConfig::OnFinding::refuse,
               kReport = gateways::FirstLineConfig::OnFinding::report;

TEST(CurrentInputs, GiveAPairAsSoonAsBothEndsAreThere) {
    Bench b{kReport};
    b.send(0, 7, 1);
    b.send(1, 7, 2);
    ASSERT_EQ(b.out.size(), 1U);
    EXPECT_EQ(b.out[0].from.i_a[0], 1);
    EXPECT_EQ(b.out[0].to.i_a[0], 2);
    EXPECT_EQ(b.out[0].from.validity, Validity::good);
}

TEST(CurrentInputs, TellThatNothingComesAnyMoreOfEitherEnd) {
    Bench b{kReport};
    for (std::uint16_t n = 0; n < 10; ++n, b.next()) {
        b.send(0, n, 1);
        b.send(1, n, 1);
    }
    std::int64_t const last = b.now() - kPeriod;
    EXPECT_EQ(b.sut.deadline(), last + 20'000'000);
    b.elapse(last + 19'999'999);
    EXPECT_TRUE(b.silent.empty()) << "late is not lost";
    b.elapse(last + 20'000'000);
    EXPECT_EQ(b.silent, (std::vector<std::size_t>{0, 1}));
    EXPECT_FALSE(b.sut.deadline());
    b.elapse(last + 60'000'000);
    EXPECT_EQ(b.silent.size(), 2U) << "said once";
    EXPECT_EQ(b.sut.end(0).subscriber.counters().silences, 1U);
    b.send(0, 298, 1); // back, and gone again
    b.send(1, 298, 1);
    b.elapse(b.now() + 20'000'000);
    EXPECT_EQ(b.silent.size(), 4U);
}

TEST(CurrentInputs, GiveOutWhatWaitsBeforeTheyTellOfTheSilence) {
    Bench b{kReport};
    b.send(0, 0, 1);
    b.send(1, 0, 1);
    b.send(0, 1, 1);
    b.sut.on_silence([&](std::size_t) { EXPECT_EQ(b.out.size(), 2U); });
    b.elapse(20'000'000);
}

std::array<streams::Stream, 2> of_four_samples() {
    std::array<streams::Stream, 2> out{stream("A"), stream("B")};
    for (streams::Stream& s : out) {
        s.samples_per_frame = 4;
    }
    return out;
}

TEST(CurrentInputs, UseAFrameThatWasOvertaken) {
    Bench b{kReport, of_four_samples()};
    for (std::uint16_t first = 0; first < 400; first += 4) {
        b.send_frame(0, first, 1);
        bool const overtaken = first % 20 == 8, overtakes = first % 20 == 12;
        if (!overtaken) {
            b.send_frame(1, first, first);
        }
        if (overtakes) {
            b.send_frame(1, first - 4, static_cast<float>(first - 4));
        }
        b.elapse(b.now() + 4 * kPeriod);
    }
    ASSERT_EQ(b.out.size(), 400U);
    for (std::size_t i = 0; i < b.out.size(); ++i) {
        EXPECT_EQ(b.out[i].index, static_cast<std::int64_t>(i));
        ASSERT_TRUE(b.out[i].from.present && b.out[i].to.present) << i;
        EXPECT_EQ(b.out[i].to.i_a[0], static_cast<double>(i));
    }
    auto const& counters = b.sut.end(1).subscriber.counters();
    EXPECT_EQ(counters.lost, 0U);
    EXPECT_EQ(counters.of(iec61850::SvEvent::late), 80U);
}

TEST(CurrentInputs, DoNotWaitLongForAFrameThatIsLost) {
    Bench b{kReport, of_four_samples()};
    for (std::uint16_t first = 0; first < 40; first += 4) {
        b.send_frame(0, first, 1);
        if (first != 8) {
            b.send_frame(1, first, 1);
        }
        b.elapse(b.now() + 4 * kPeriod);
        // Frame 12 shows that 8 is missing; two frames later it is given up.
        EXPECT_EQ(b.out.size(), first < 8 ? first + 4U : first < 20 ? 8U : first + 4U) << first;
    }
    EXPECT_FALSE(b.out[11].to.present);
    EXPECT_TRUE(b.out[12].to.present);
}

TEST(CurrentInputs, CallQuestionableWhatTwoFramesOfOneAddressClaim) {
    Bench b{kRefuse};
    for (std::uint16_t n = 0; n < 10; ++n, b.next()) {
        if (n == 5) {
            b.send(0, n, 200); // with the address of the real one, and before it
        }
        b.send(0, n, 1);
        b.send(1, n, 1);
    }
    ASSERT_EQ(b.out.size(), 9U) << "a sample is held back until nobody else can claim it";
    for (LineSample const& s : b.out) {
        EXPECT_EQ(s.from.validity, s.index == 5 ? Validity::questionable : Validity::good) << s.index;
        EXPECT_EQ(s.to.validity, Validity::good);
    }
    EXPECT_NE(b.findings[0] & ids::kDuplicate, 0U);
    EXPECT_EQ(b.findings[1], 0U);
}

TEST(CurrentInputs, LetTheNextSampleAnswerForOneThatWasGivenOutAlready) {
    Bench b{kRefuse};
    for (std::uint16_t n = 0; n < 10; ++n, b.next()) {
        b.send(0, n, 1);
        b.send(1, n, 1);
        if (n == 5) {
            b.send(0, 3, 200); // so late that sample 3 is gone
        }
    }
    for (LineSample const& s : b.out) {
        EXPECT_EQ(s.from.validity, s.index == 6 ? Validity::questionable : Validity::good) << s.index;
    }
}

TEST(CurrentInputs, DoNotDoubtCopies) {
    Bench b{kRefuse};
    for (std::uint16_t n = 0; n < 10; ++n, b.next()) {
        for (int copy = 0; copy < 2; ++copy) {
            b.send(0, n, 1);
            b.send(1, n, 1);
        }
    }
    for (LineSample const& s : b.out) {
        EXPECT_EQ(s.from.validity, Validity::good);
    }
    EXPECT_EQ(b.out.size(), 9U);
}

TEST(CurrentInputs, KeepTheSampleOfTheBoundAddress) {
    for (auto const on_finding : {kReport, kRefuse}) {
        Bench b{on_finding};
        for (std::uint16_t n = 0; n < 10; ++n, b.next()) {
            if (n == 5) {
                b.send(0, n, 200, 66);
            }
            b.send(0, n, 1);
            b.send(1, n, 1);
        }
        auto const fifth = b.out.at(5);
        EXPECT_EQ(fifth.index, 5);
        EXPECT_EQ(fifth.from.i_a[0], on_finding == kRefuse ? 1 : 200) << "who only reports is deceived";
        EXPECT_EQ(fifth.from.validity, Validity::good);
        EXPECT_NE(b.findings[0] & ids::kWrongSource, 0U);
    }
}

TEST(CurrentInputs, TakeSimulatedSamplesInTestModeOnly) {
    for (bool const test_mode : {false, true}) {
        Bench b{kReport, {stream("A"), stream("B")}, test_mode};
        for (std::uint16_t n = 0; n < 5; ++n, b.next()) {
            b.send(0, n, 1, 1, true);
            b.send(1, n, 1);
        }
        EXPECT_EQ(b.sut.end(0).subscriber.counters().samples, test_mode ? 5U : 0U);
        EXPECT_EQ(b.sut.end(1).subscriber.counters().samples, 5U) << "nobody simulates that end";
        if (test_mode) {
            ASSERT_EQ(b.out.size(), 5U);
            EXPECT_TRUE(b.out[4].from.simulated && b.out[4].from.present);
            EXPECT_FALSE(b.out[4].to.simulated);
            EXPECT_EQ(b.findings[0], 0U);
        }
    }
}

TEST(CurrentInputs, TellTwoStreamsOfOneSvIdApartByTheirAddresses) {
    streams::Stream other = stream("A");
    other.address.destination = *iec61850::Mac::parse("01:0C:CD:04:00:22");
    other.address.app_id = 0x4022;
    Bench b{kRefuse, {stream("A"), other}};
    for (std::uint16_t n = 0; n < 10; ++n, b.next()) {
        b.send(0, n, 1, 1);
        b.send(1, n, 2, 2);
    }
    ASSERT_EQ(b.out.size(), 9U);
    EXPECT_EQ(b.out[8].from.i_a[0], 1);
    EXPECT_EQ(b.out[8].to.i_a[0], 2);
    EXPECT_EQ(b.findings, (std::array<std::uint32_t, 2>{})) << "each has its own source";
    EXPECT_EQ(b.sut.end(0).subscriber.counters().of(iec61850::SvEvent::identity_mismatch), 0U);
    EXPECT_EQ(b.sut.end(1).first_line.refused(), 0U);
}

TEST(CurrentInputs, DoubtAnSvIdFromAnAddressThatIsNobodys) {
    Bench b{kReport};
    b.send(0, 0, 1);
    b.next();
    streams::Stream strange = stream("A");
    strange.address.app_id = 0x4999;
    auto frame = *strange.sv_template(iec61850::Mac{{2, 0, 0, 0, 0, 66}});
    frame.set_smp_cnt(0, 1);
    b.sut.frame(frame.frame(), kPeriod, [](LineSample const&) {});
    EXPECT_NE(b.findings[0] & ids::kWrongSource, 0U);
    EXPECT_EQ(b.sut.end(0).subscriber.counters().of(iec61850::SvEvent::identity_mismatch), 1U);
}

TEST(CurrentInputs, CallUnsynchronisedWhatTwoDifferentClocksCount) {
    for (auto const& [from, to, same] : {std::tuple{2, 2, true},
                                         {1, 1, true},
                                         {5, 5, true},
                                         {5, 7, false},
                                         {1, 2, false},
                                         {0, 2, false},
                                         {0, 0, false}}) {
        Bench b{kReport, static_cast<std::uint8_t>(from), static_cast<std::uint8_t>(to)};
        b.send(0, 7, 1);
        b.send(1, 7, 2);
        ASSERT_EQ(b.out.size(), 1U);
        EXPECT_EQ(b.out[0].from.synch != Synch::none && b.out[0].to.synch != Synch::none, same)
            << from << " and " << to;
    }
}

} // namespace
} // namespace gridspace::relay
