// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/goose_forger.hpp"
#include "agents/attacker/sv_forger.hpp"
#include "common/config/yaml.hpp"
#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/sv_publisher.hpp"

#include <gtest/gtest.h>

#include <atomic>
#include <cmath>
#include <thread>

namespace gridspace::attacker {
namespace {

constexpr char const* kStreams = R"(
SMV: {kind: smv, mac: "01:0C:CD:04:00:21", app_id: 0x4021, sv_id: MU1, conf_rev: 1, rate_hz: 4800, samples_per_frame: 1,
      data_set: {Ia: float32, Ib: float32, Ic: float32}}
LE:  {kind: smv, mac: "01:0C:CD:04:00:22", app_id: 0x4022, sv_id: MU2, conf_rev: 1, rate_hz: 4800, samples_per_frame: 2,
      data_set: {Ia: int32, qa: quality, Ib: int32, qb: quality, Ic: int32, qc: quality}}
TRIP: {kind: goose, mac: "01:0C:CD:01:00:02", app_id: 0x8002, control_block: IED/LLN0$GO$Trip, conf_rev: 1,
      data_set: {other: boolean, status: boolean, count: int32}}
)";

std::vector<streams::Stream> declared() {
    config::Diagnostics diagnostics;
    auto const node = config::parse_yaml(kStreams, config::make_source("streams.yaml", kStreams), diagnostics);
    auto out = streams::read_streams(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return out;
}

AttackConfig values(double bias_a, double from_s, double until_s) {
    AttackConfig a;
    a.name.name = "x";
    a.channels = {"Ia"};
    a.from_s = Rational{std::llround(from_s * 10'000), 10'000};
    a.until_s = Rational{std::llround(until_s * 10'000), 10'000};
    a.samples.kind = SampleAttackParams::Kind::bias;
    a.samples.bias_a = bias_a;
    return a;
}

double current(std::int64_t n, int phase) {
    return 10 * std::cos(6.283185307179586 * (static_cast<double>(n) / 80 - phase / 3.0));
}

/// A publisher of the stream, frame by frame.
class Publisher {
  public:
    explicit Publisher(streams::Stream const& s)
        : layout_{s.data_set}, publisher_{*s.sv_template(*iec61850::Mac::parse("02:00:00:00:00:01")), 4800} {}
    /// Sample n; the frame when it was its last.
    iec61850::Octets send(std::int64_t n) {
        auto const sample = publisher_.sample(n);
        int phase = 0;
        for (std::size_t i = 0; i < layout_.slots().size(); ++i) {
            auto const type = layout_.slots()[i].leaf.type;
            if (iec61850::is_number(type)) {
                double const scale = iec61850::is_integer(type) ? 1000 : 1;
                layout_.write(i, iec61850::Value::from_number(type, current(n, phase++) * scale), sample);
            }
        }
        return publisher_.commit();
    }
    [[nodiscard]] double read(iec61850::Asdu const& asdu, char const* name) const {
        return layout_.read(*layout_.index_of(name), asdu.sample).number();
    }

  private:
    iec61850::SvLayout layout_;
    iec61850::SvPublisher publisher_;
};

std::int64_t ns_of(std::int64_t n) {
    return std::llround(static_cast<double>(n) * 1e9 / 4800) + 120'000;
}

TEST(SvForger, ManInTheMiddleAltersTheAttackedPhaseOfTheAttackedSamplesOnly) {
    auto const all = declared();
    auto sut =
        *SvForger::create(*streams::find_stream(all, "SMV"), values(3, 1.0, 1.1), 60, 1); // behind a wrap of smpCnt
    Publisher publisher{*streams::find_stream(all, "SMV")};
    std::vector<Label> labels;
    for (std::int64_t n = 4700; n < 5300; ++n) {
        iec61850::Octets const real = publisher.send(n);
        int frames = 0;
        sut->pass(
            real, ns_of(n),
            [&](std::span<std::uint8_t const> sent) {
                ++frames;
                iec61850::SvFrame frame;
                ASSERT_TRUE(iec61850::decode_sv(sent, frame));
                bool const attacked = n >= 4800 && n < 5280;
                EXPECT_NEAR(publisher.read(frame.view()[0], "Ia"), current(n, 0) + (attacked ? 3 : 0), 1e-5) << n;
                EXPECT_NEAR(publisher.read(frame.view()[0], "Ib"), current(n, 1), 1e-5);
                EXPECT_EQ(frame.view()[0].smp_cnt, n % 4800);
                EXPECT_EQ(std::equal(sent.begin(), sent.end(), real.begin(), real.end()), !attacked);
            },
            [&](Label const& l) { labels.push_back(l); });
        ASSERT_EQ(frames, 1);
    }
    ASSERT_EQ(labels.size(), 480U);
    EXPECT_EQ(labels.front().index, 4800);
    EXPECT_EQ(labels.front().channel, 0);
    EXPECT_NEAR(labels.front().sent_a - labels.front().true_a, 3, 1e-5);
    EXPECT_EQ(sut->forged(), 480U);
}

/// In real time frames pass on one thread, and another says how many were forged: for the thread sanitizer. Relaxed, so
/// that nothing here puts the two in an order.
template <class Sut, class Forge>
void count_from_another_thread(Sut const& sut, Forge const& forge) {
    std::atomic<bool> done{false};
    std::atomic<int> looks{0};
    std::thread watching{[&] {
        for (std::uint64_t last = 0; !done.load(std::memory_order_relaxed);) {
            std::uint64_t const now = sut.forged();
            EXPECT_GE(now, last);
            last = now;
            looks.fetch_add(1, std::memory_order_relaxed);
        }
    }};
    auto const wait_for_looks = [&](int more) {
        for (int const until = looks.load(std::memory_order_relaxed) + more;
             looks.load(std::memory_order_relaxed) < until;) {
            std::this_thread::yield();
        }
    };
    wait_for_looks(2);
    forge();
    wait_for_looks(2);
    done.store(true, std::memory_order_relaxed);
    watching.join();
}

TEST(SvForger, WhatItHasForgedMayBeAskedFromAnotherThread) {
    auto const all = declared();
    auto sut = *SvForger::create(*streams::find_stream(all, "SMV"), values(3, 1.0, 1.1), 60, 1);
    Publisher publisher{*streams::find_stream(all, "SMV")};
    count_from_another_thread(*sut, [&] {
        for (std::int64_t n = 4700; n < 5300; ++n) {
            sut->pass(publisher.send(n), ns_of(n), [](auto) {}, [](Label const&) {});
        }
    });
    EXPECT_EQ(sut->forged(), 480U);
}

TEST(SvForger, AltersMilliamperesAndFramesOfSeveralSamples) {
    auto const all = declared();
    auto const& stream = *streams::find_stream(all, "LE");
    auto sut = *SvForger::create(stream, values(2, 0, 0.001), 60, 1); // samples 0 to 4
    Publisher publisher{stream};
    std::vector<Label> labels;
    for (std::int64_t n = 0; n < 10; ++n) {
        iec61850::Octets const real = publisher.send(n);
        if (!real.empty()) {
            sut->pass(real, ns_of(n), [](auto) {}, [&](Label const& l) { labels.push_back(l); });
        }
    }
    ASSERT_EQ(labels.size(), 5U);
    EXPECT_EQ(labels[4].index, 4);
    EXPECT_NEAR(labels[4].sent_a, current(4, 0) + 2, 1e-3); // amperes, as a receiver reads them
}

TEST(SvForger, SecondPublisherIsAheadOfTheRealSampleAndTellsTheTruthLater) {
    auto const all = declared();
    auto const& stream = *streams::find_stream(all, "SMV");
    auto sut = *SvForger::create(stream, values(4, 0.1, 0.2), 60, 1);
    Publisher publisher{stream};
    std::vector<Label> labels;
    std::int64_t forged = 0, heard = 0;
    for (std::int64_t n = 0; n < 1200; ++n) {
        heard = n;
        sut->hear(
            publisher.send(n), ns_of(n),
            [&](std::span<std::uint8_t const> sent) {
                iec61850::SvFrame frame;
                ASSERT_TRUE(iec61850::decode_sv(sent, frame));
                EXPECT_EQ(frame.view()[0].smp_cnt, heard + 1);
                EXPECT_NEAR(publisher.read(frame.view()[0], "Ia"), current(heard + 1, 0) + 4, 1e-3);
                EXPECT_NEAR(publisher.read(frame.view()[0], "Ic"), current(heard + 1, 2), 1e-3);
                ++forged;
            },
            [&](Label const& l) {
                EXPECT_EQ(l.index, heard);
                labels.push_back(l);
            });
    }
    EXPECT_EQ(forged, 480);
    ASSERT_EQ(labels.size(), 480U);
    EXPECT_NEAR(labels[0].true_a, current(480, 0), 1e-5); // the sample's own, not the guess
}

TEST(SvForger, FramesOfOthersAndDamagedOnesPassUntouched) {
    auto const all = declared();
    auto sut = *SvForger::create(*streams::find_stream(all, "SMV"), values(3, 0, 1), 60, 1);
    Publisher other{*streams::find_stream(all, "LE")};
    (void)other.send(0);
    iec61850::Octets const foreign = other.send(1);
    std::vector<std::uint8_t> const cut{foreign.begin(), foreign.begin() + 30};
    for (iec61850::Octets const frame : {foreign, iec61850::Octets{cut}}) {
        int same = 0;
        sut->pass(
            frame, ns_of(1),
            [&](auto sent) { same += std::equal(sent.begin(), sent.end(), frame.begin(), frame.end()) ? 1 : 0; },
            [](Label const&) { FAIL(); });
        EXPECT_EQ(same, 1);
    }
}

AttackConfig message(GooseAttackParams::Kind kind) {
    AttackConfig a;
    a.name.name = "g";
    a.channels = {"status"};
    a.from_s = Rational{1};
    a.until_s = Rational{2};
    a.goose = GooseAttackParams{};
    a.goose->kind = kind;
    a.goose->interval_ms = 10;
    return a;
}

std::vector<std::uint8_t> real_message(streams::Stream const& stream, std::uint32_t st, std::uint32_t sq, bool status) {
    auto frame = *stream.goose_template(*iec61850::Mac::parse("02:00:00:00:00:01"));
    (void)frame.set(0, iec61850::Value::of(true));
    (void)frame.set(1, iec61850::Value::of(status));
    (void)frame.set(2, iec61850::Value::integer(iec61850::BasicType::int32, 77));
    auto const octets = frame.frame({st, sq, 30, iec61850::UtcTime::from_nanoseconds(1'000'000'000'500'000'000)});
    return {octets.begin(), octets.end()};
}

TEST(GooseForger, MasqueradeIsTheNextStateWithTheOtherMembersAsTheyAre) {
    auto const all = declared();
    auto const& stream = *streams::find_stream(all, "TRIP");
    auto sut = *GooseForger::create(stream, message(GooseAttackParams::Kind::masquerade_trip), 1);
    sut->set_utc_base(1'000'000'000'000'000'000);
    std::vector<Label> labels;
    Tell const tell = [&](Label const& l) { labels.push_back(l); };
    sut->pass(real_message(stream, 4, 9, false), 500'000'000, nullptr, tell);
    std::vector<iec61850::GooseState> sent;
    sut->elapse(
        1'020'000'000,
        [&](std::span<std::uint8_t const> octets) {
            iec61850::GooseFrame frame;
            ASSERT_TRUE(iec61850::decode_goose(octets, frame));
            iec61850::GooseSubscription s;
            s.gocb_ref = stream.control_block;
            s.data_set = stream.data_set;
            iec61850::GooseSubscriber reader{s};
            ASSERT_TRUE(reader.receive(frame, 0).accepted);
            EXPECT_TRUE(reader.value(0).boolean());
            EXPECT_TRUE(reader.value(1).boolean());
            EXPECT_EQ(reader.value(2).number(), 77);
            sent.push_back({frame.st_num, frame.sq_num, frame.live_ms, frame.t});
        },
        tell);
    ASSERT_EQ(sent.size(), 3U); // at 1.000, 1.010 and 1.020 s
    EXPECT_EQ(sent[0].st_num, 5U);
    EXPECT_EQ(sent[2].sq_num, 2U);
    ASSERT_EQ(labels.size(), 3U);
    EXPECT_EQ(labels[0].true_a, 0);
    EXPECT_EQ(labels[0].sent_a, 1);
    EXPECT_EQ(*sut->due(), 1'030'000'000);
}

TEST(GooseForger, GrayholeDropsAndStretchAltersOnlyInItsTime) {
    auto const all = declared();
    auto const& stream = *streams::find_stream(all, "TRIP");
    auto hole = *GooseForger::create(stream, message(GooseAttackParams::Kind::grayhole), 1);
    auto stretch = *GooseForger::create(stream, message(GooseAttackParams::Kind::stretch), 1);
    int passed = 0, labels = 0;
    std::uint32_t live_ms = 0;
    for (std::uint32_t k = 0; k < 30; ++k) { // from 0.1 to 3.0 s
        auto const real = real_message(stream, 1, k, false);
        std::int64_t const at = 100'000'000LL * (k + 1);
        hole->pass(real, at, [&](auto) { ++passed; }, [&](Label const&) { ++labels; });
        stretch->pass(
            real, at,
            [&](std::span<std::uint8_t const> octets) {
                iec61850::GooseFrame frame;
                ASSERT_TRUE(iec61850::decode_goose(octets, frame));
                EXPECT_EQ(frame.sq_num, k);
                live_ms = std::max(live_ms, frame.live_ms);
                EXPECT_EQ(frame.live_ms == 30, at < 1'000'000'000 || at >= 2'000'000'000);
            },
            [](Label const&) {});
    }
    EXPECT_EQ(passed, 20);
    EXPECT_EQ(labels, 10);
    EXPECT_EQ(live_ms, 60'000U);
}

TEST(GooseForger, WhatItHasForgedMayBeAskedFromAnotherThread) {
    auto const all = declared();
    auto const& stream = *streams::find_stream(all, "TRIP");
    auto hole = *GooseForger::create(stream, message(GooseAttackParams::Kind::grayhole), 1);
    auto flood = *GooseForger::create(stream, message(GooseAttackParams::Kind::flooding), 1);
    count_from_another_thread(*hole, [&] {
        for (std::uint32_t k = 0; k < 30; ++k) {
            hole->pass(real_message(stream, 1, k, false), 100'000'000LL * (k + 1), [](auto) {}, [](Label const&) {});
        }
    });
    EXPECT_EQ(hole->forged(), 10U);
    flood->pass(real_message(stream, 1, 1, false), 500'000'000, nullptr, [](Label const&) {});
    count_from_another_thread(*flood, [&] { flood->elapse(1'995'000'000, [](auto) {}, [](Label const&) {}); });
    EXPECT_EQ(flood->forged(), 100U);
}

TEST(GooseForger, NeedsABooleanMember) {
    auto const all = declared();
    auto config = message(GooseAttackParams::Kind::flooding);
    config.channels = {"count"};
    auto const sut = GooseForger::create(*streams::find_stream(all, "TRIP"), config, 1);
    ASSERT_FALSE(sut);
    EXPECT_NE(sut.error().message.find("no Boolean member 'count'"), std::string::npos);
}

} // namespace
} // namespace gridspace::attacker
