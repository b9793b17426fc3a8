// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/capture_scan.hpp"

#include "launcher/ids/scan/scan_output.hpp"
#include "recorder/pcapng/pcapng_writer.hpp"

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <gmock/gmock.h>
#include <nlohmann/json.hpp>
#include <numbers>

namespace gridspace::scan {
namespace {

using namespace iec61850;
using testing::AllOf;
using testing::ElementsAre;
using testing::HasSubstr;
using testing::IsEmpty;

constexpr std::int64_t kEpoch = 1'700'000'000'000'000'000;

struct MergingUnit {
    std::string sv_id{"MU1"};
    std::uint8_t device{1};
    std::optional<VlanTag> vlan{};
    double rate_hz{4000}, frequency_hz{50}, peak_a{1000};
    std::size_t asdus{2};
    std::uint32_t conf_rev{1};
};

/// A frame of 9-2LE: balanced currents, from sample `first` on; `added_a` to phase a.
std::vector<std::uint8_t> sv(MergingUnit const& unit, int first, double added_a = 0) {
    SvLayout const layout{data_set_92le()};
    AsduDescription asdu;
    asdu.sv_id = unit.sv_id;
    asdu.conf_rev = unit.conf_rev;
    asdu.sample_octets = layout.sample_octets();
    Address const address{*Mac::parse("01:0C:CD:04:00:21"), Mac{{2, 0, 0, 0, 0, unit.device}}, unit.vlan, 0x4000,
                          false};
    auto frame = SvTemplate::create(address, std::vector(unit.asdus, asdu));
    for (std::size_t i = 0; i < unit.asdus; ++i) {
        int const n = first + static_cast<int>(i);
        frame->set_smp_cnt(i, static_cast<std::uint16_t>(n % static_cast<int>(unit.rate_hz)));
        for (std::size_t p = 0; p < 3; ++p) {
            double const angle =
                2 * std::numbers::pi * (unit.frequency_hz * n / unit.rate_hz - static_cast<double>(p) / 3) + 0.3;
            double const i_a = unit.peak_a * std::cos(angle) + (p == 0 ? added_a : 0);
            layout.write(*layout.index_of(std::array{"Ia", "Ib", "Ic"}[p]),
                         Value::from_number(BasicType::int32, 1e3 * i_a), frame->sample(i));
        }
    }
    Octets const octets = frame->frame();
    return {octets.begin(), octets.end()};
}

std::vector<std::uint8_t> goose(std::uint32_t st_num, std::uint32_t sq_num, std::uint8_t device = 1,
                                std::uint32_t conf_rev = 1) {
    GooseDescription description;
    description.gocb_ref = "A/LLN0$GO$g";
    description.dat_set = "A/LLN0$d";
    description.conf_rev = conf_rev;
    description.data_set = {{DataNode::leaf("status", BasicType::boolean)}};
    auto frame = GooseTemplate::create(
        {*Mac::parse("01:0C:CD:01:00:01"), Mac{{2, 0, 0, 0, 0, device}}, VlanTag{}, 1, false}, description);
    GooseState state;
    state.st_num = st_num;
    state.sq_num = sq_num;
    state.t.seconds = st_num;
    state.live_ms = 1000;
    Octets const octets = frame->frame(state);
    return {octets.begin(), octets.end()};
}

class CaptureScanOf : public testing::Test {
  protected:
    void SetUp() override {
        std::string pattern = testing::TempDir() + "/gridspace-scan-XXXXXX";
        folder_ = ::mkdtemp(pattern.data());
        options_.file = folder_ / "c.pcapng";
        options_.forecast.model = ids::oscillator(4800, 60); // exact for a sinusoid of 80 samples
        writer_.emplace(std::move(*pcapng::Writer::create(options_.file, "test")));
        point_ = writer_->add_interface("eth0");
    }
    void TearDown() override { std::filesystem::remove_all(folder_); }

    /// Frame number of it.
    std::uint64_t put(double at_s, std::vector<std::uint8_t> const& frame) {
        EXPECT_TRUE(writer_->write(point_, kEpoch + std::llround(at_s * 1e9), frame));
        return writer_->frames();
    }
    void put(MergingUnit const& unit, int first, double added_a = 0) {
        put(first / unit.rate_hz, sv(unit, first, added_a));
    }
    Result<CaptureScan> try_read() {
        EXPECT_TRUE(writer_->close());
        return scan_capture(options_);
    }
    CaptureScan read() {
        auto out = try_read();
        EXPECT_TRUE(out) << describe(out.error());
        return out ? std::move(*out) : CaptureScan{};
    }
    static std::vector<std::string> rules(std::vector<Alarm> const& alarms) {
        std::vector<std::string> out;
        for (Alarm const& a : alarms) {
            out.push_back(a.rule);
        }
        return out;
    }

    ScanOptions options_;

  private:
    std::filesystem::path folder_;
    std::optional<pcapng::Writer> writer_;
    std::uint32_t point_{0};
};

TEST_F(CaptureScanOf, ACalmStreamOfTwoSamplesAFrameRaisesNoAlarmAndIsJudged) {
    MergingUnit const unit;
    for (int n = 0; n < 6000; n += 2) {
        put(unit, n);
    }
    auto const scan = read();
    ASSERT_EQ(scan.streams.size(), 1U);
    StreamScan const& s = scan.streams[0];
    EXPECT_FALSE(scan.has_alarms());
    EXPECT_EQ(s.layout, "9-2LE");
    EXPECT_EQ(s.forecast.why_not, "");
    EXPECT_GT(s.forecast.samples, 5900U);
    EXPECT_NEAR(s.forecast.nominal_peak_a, 1000, 1);
    EXPECT_NEAR(s.senders[0].rate_hz(), 4000, 1);
    EXPECT_THAT(to_text(scan, "c.pcapng"), AllOf(HasSubstr("no alarm"), HasSubstr("0 of 59")));
}

TEST_F(CaptureScanOf, AForgedSampleIsFoundAtItsFrame) {
    MergingUnit unit;
    unit.vlan = VlanTag{7, 4, false};
    for (int n = 0; n < 4000; n += 2) {
        put(unit, n, n == 2500 ? 300 : 0);
    }
    auto const scan = read();
    ASSERT_THAT(rules(scan.streams.at(0).alarms), ElementsAre("off_forecast"));
    EXPECT_EQ(scan.streams[0].alarms[0].first.frame, 1251U);
    EXPECT_NEAR(scan.seconds(scan.streams[0].alarms[0].first), 0.625, 1e-6);
    auto const json = nlohmann::json::parse(to_json(scan, "c.pcapng"));
    EXPECT_EQ(json["streams"][0]["alarms"][0]["first"]["frame"], 1251);
}

TEST_F(CaptureScanOf, ASecondSenderIsNamedWithItsFramesAndAnotherConfRevIsFound) {
    MergingUnit const unit;
    MergingUnit evil;
    evil.device = 0x66;
    evil.conf_rev = 2;
    std::uint64_t first = 0;
    for (int n = 0; n < 2000; n += 2) {
        put(unit, n);
        if (n >= 1000 && n < 1010) {
            std::uint64_t const frame = put(n / unit.rate_hz + 1e-5, sv(evil, n));
            first = first == 0 ? frame : first;
        }
    }
    auto const scan = read();
    StreamScan const& s = scan.streams.at(0);
    EXPECT_THAT(s.foreign, ElementsAre(testing::Pair(Mac{{2, 0, 0, 0, 0, 0x66}}, 5U)));
    ASSERT_THAT(rules(s.alarms), testing::UnorderedElementsAre("wrong_source", "wrong_identity"));
    EXPECT_EQ(s.alarms[0].first.frame, first);
    EXPECT_EQ(s.alarms[0].what, "from 02:00:00:00:00:66");
    EXPECT_EQ(s.conf_rev_changes, 10U);
}

TEST_F(CaptureScanOf, AChangeThatOneEndSeesIsAForgeryAndOneOfBothEndsIsNot) {
    MergingUnit const from;
    MergingUnit to;
    to.sv_id = "MU2";
    to.device = 2;
    options_.lines = {{"MU1", "MU2"}};
    std::uint64_t forged = 0;
    for (int n = 0; n < 8000; n += 2) {
        bool const both = n >= 2000, one = n >= 5000;
        put(from, n, (both ? 500 : 0) + (one ? 2000 : 0));
        std::uint64_t const frame = put(n / to.rate_hz + 1e-5, sv(to, n, both ? 500 : 0));
        forged = one && forged == 0 ? frame : forged;
    }
    auto const scan = read();
    ASSERT_EQ(scan.lines.size(), 1U);
    EXPECT_EQ(scan.lines[0].pairs, 8000U);
    auto const& alarms = scan.lines[0].alarms;
    ASSERT_FALSE(alarms.empty());
    EXPECT_THAT(rules(alarms), testing::Contains("one_end"));
    EXPECT_GE(alarms[0].first.frame, forged);
    EXPECT_LE(alarms[0].first.frame, forged + 40) << "within 5 ms";
    for (StreamScan const& s : scan.streams) {
        EXPECT_THAT(s.alarms, IsEmpty()) << "the line judges both ends";
    }
}

TEST_F(CaptureScanOf, CurrentsOfAnotherFrequencyThanTheModelsAreNotJudged) {
    MergingUnit unit;
    unit.rate_hz = 4800; // 96 samples a cycle
    for (int n = 0; n < 6000; n += 2) {
        put(unit, n);
    }
    auto const scan = read();
    EXPECT_FALSE(scan.has_alarms());
    EXPECT_THAT(scan.streams.at(0).forecast.why_not, HasSubstr("96.0 samples a cycle; the model is for 80"));
}

TEST_F(CaptureScanOf, SamplesOfAnUnknownLayoutAreJudgedByTheRulesAlone) {
    MergingUnit const unit;
    auto cut = streams::Stream{};
    cut.sv_id = cut.name.name = "MU1";
    cut.data_set = {{DataNode::leaf("only", BasicType::float32)}};
    options_.known = KnownStreams{{cut}, {}};
    for (int n = 0; n < 4000; n += 2) {
        put(unit, n == 3000 ? 100 : n);
    }
    auto const scan = read();
    EXPECT_EQ(scan.streams.at(0).layout, "unknown: 64 octets, and its description has 4");
    EXPECT_THAT(rules(scan.streams[0].alarms), testing::Contains("out_of_order"));
}

TEST_F(CaptureScanOf, GooseThatIsForgedComesTooLateOrEndsIsFound) {
    for (std::uint32_t k = 0; k < 10; ++k) {
        put(0.5 * k, goose(1, k));
    }
    std::uint64_t const jump = put(4.6, goose(90, 0, 0x66));
    std::uint64_t const late = put(6.5, goose(1, 10));
    MergingUnit const unit;
    put(9, sv(unit, 0));
    auto const scan = read();
    StreamScan const* const s = scan.streams[0].goose ? &scan.streams[0] : &scan.streams.at(1);
    ASSERT_THAT(rules(s->alarms), ElementsAre("wrong_source", "time_to_live", "silent"));
    EXPECT_EQ(s->alarms[0].first.frame, jump);
    EXPECT_EQ(s->alarms[1].first.frame, late);
    EXPECT_EQ(s->alarms[2].first.frame, late) << "the last of it";
}

TEST_F(CaptureScanOf, WhatIsNoCaptureOrHoldsNothingIsAnError) {
    put(0, std::vector<std::uint8_t>(60, 0));
    EXPECT_THAT(describe(try_read().error()), HasSubstr("holds no GOOSE and no sampled values"));
    std::ofstream{options_.file} << "time_s,value\n";
    EXPECT_THAT(describe(scan_capture(options_).error()), HasSubstr("is not a capture"));
    options_.file = "/dev/null";
    EXPECT_THAT(describe(scan_capture(options_).error()), HasSubstr("no regular file"));
}

TEST_F(CaptureScanOf, AStreamOrALineThatIsNotThereIsNamedWithWhatIs) {
    put(MergingUnit{}, 0);
    options_.streams = {"MU9"};
    EXPECT_THAT(describe(try_read().error()), AllOf(HasSubstr("no stream 'MU9'"), HasSubstr("there are: MU1")));
    options_.streams = {};
    options_.lines = {{"MU1", "MU9"}};
    EXPECT_THAT(describe(scan_capture(options_).error()), HasSubstr("both 'MU1' and 'MU9'"));
}

TEST(Vantage, PortsOfALinkAreOnePlaceAndCablesAreTheirOwn) {
    EXPECT_EQ(vantage_of("process_bus/mu21"), "process_bus");
    EXPECT_EQ(vantage_of("process_bus/mu21:attacker"), "process_bus/mu21:attacker");
    EXPECT_EQ(vantage_of("eth0"), "eth0");
}

} // namespace
} // namespace gridspace::scan
