// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/judge/recording_loss.hpp"

#include <gmock/gmock.h>

namespace gridspace::launcher {
namespace {

using testing::HasSubstr;
using Status = ExpectationResult::Status;

constexpr char const* kOnTheWay = "not in the recording, because this machine was too slow: 12 of 300 samples of "
                                  "'TL_21' from sim, 3 of 50 samples of 'signals' from sim";

RecordingLoss loss(std::string const& event_text) {
    RecordingLoss out;
    out.publishes("sim", "breaker.CB3.position");
    out.publishes("relay2", "relay.relay2.trip");
    out.dropped(event_text);
    return out;
}

/// An expectation that the recording, in which the breaker is always closed, does not fulfil.
ExpectationResult judged(std::string const& settings, RecordingLoss const& lost) {
    config::Diagnostics diagnostics;
    std::string const text = "e: " + settings;
    auto const node = config::parse_yaml(text, config::make_source("e.yaml", text), diagnostics);
    auto const list = read_expectations(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    SignalStore const store{{"breaker.CB3.position", {"", {0}, {2}}}, {"relay.relay2.trip", {"", {0}, {0}}}};
    auto out = judge(list.at(0), store, {}, 10);
    name_loss(list.at(0), lost, out);
    return out;
}

TEST(RecordingLoss, WhatFailsOnSignalsWithHolesCannotBeJudged) {
    auto const sut = judged("{eventually: breaker.CB3.position == 1}", loss(kOnTheWay));
    EXPECT_EQ(sut.status, Status::failed);
    EXPECT_EQ(sut.value, std::nullopt);
    EXPECT_THAT(sut.detail, HasSubstr("cannot be judged: the recording has lost 3 of 50 samples of 'signals' from sim "
                                      "(by what is left: never true in that time)"));
    EXPECT_THAT(judged("{last_of: breaker.CB3.position, is: 1, tolerance: 0}", loss(kOnTheWay)).detail,
                HasSubstr("by what is left: 2"));
}

/// Of a run of 10 s whose recording was cut at 4 s: a signal that was 1, 3 and 2.
ExpectationResult judged_when_cut(std::string const& settings) {
    config::Diagnostics diagnostics;
    std::string const text = "e: " + settings;
    auto const node = config::parse_yaml(text, config::make_source("e.yaml", text), diagnostics);
    auto const list = read_expectations(*node, diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    SignalStore const store{{"a.b", {"", {0, 1'000'000'000, 2'000'000'000, 4'000'000'000}, {1, 3, 2, 2}}}};
    auto out = judge(list.at(0), store, {}, 10);
    mind_the_end(list.at(0), {}, 4, 10, out);
    return out;
}

TEST(RecordingLoss, OfACutRecordingWhatMayStillChangeCannotBeJudged) {
    for (char const* settings :
         {"{always: a.b > 0}", "{never: a.b > 9}", "{eventually: a.b > 9}", "{time_of: a.b == 9, below: 20}",
          "{min_of: a.b, above: 0}", "{max_of: a.b, below: 9}", "{mean_of: a.b, above: 0}", "{last_of: a.b, above: 0}",
          "{count_of: a.b > 2, below: 9}", "{always: a.b > 0, until: 4.1 s}", "{eventually: a.b > 9, within_s: 4.1}"}) {
        auto const sut = judged_when_cut(settings);
        EXPECT_EQ(sut.status, Status::failed) << settings;
        EXPECT_THAT(sut.detail, HasSubstr("cannot be judged: the recording is whole until 4 s, and 10 s")) << settings;
        EXPECT_EQ(sut.value, std::nullopt) << settings;
    }
}

TEST(RecordingLoss, OfACutRecordingWhatIsDecidedIsJudgedAsEver) {
    for (auto const& [settings, status] :
         std::initializer_list<std::pair<char const*, Status>>{{"{always: a.b > 0, until: 4 s}", Status::passed},
                                                               {"{always: a.b > 2}", Status::failed},
                                                               {"{never: a.b > 2}", Status::failed},
                                                               {"{eventually: a.b > 2}", Status::passed},
                                                               {"{eventually: a.b > 9, within_s: 3}", Status::failed},
                                                               {"{time_of: a.b == 3, below: 2}", Status::passed},
                                                               {"{time_of: a.b == 3, above: 2}", Status::failed},
                                                               {"{time_of: a.b == 3, show_only: true}", Status::shown},
                                                               {"{max_of: a.b, above: 2}", Status::passed},
                                                               {"{max_of: a.b, below: 2}", Status::failed},
                                                               {"{min_of: a.b, below: 2}", Status::passed},
                                                               {"{min_of: a.b, above: 2}", Status::failed}}) {
        auto const sut = judged_when_cut(settings);
        EXPECT_EQ(sut.status, status) << settings << sut.detail;
        EXPECT_THAT(sut.detail, testing::Not(HasSubstr("cannot be judged"))) << settings;
    }
}

TEST(RecordingLoss, WhatIsFulfilledAndWhatIsWholeIsJudgedAsEver) {
    EXPECT_EQ(judged("{eventually: breaker.CB3.position == 2}", loss(kOnTheWay)).status, Status::passed);
    EXPECT_EQ(judged("{eventually: relay.relay2.trip == 1}", loss(kOnTheWay)).detail, "never true in that time");
    EXPECT_EQ(judged("{eventually: breaker.CB3.position == 1}", RecordingLoss{}).detail, "never true in that time");
    EXPECT_EQ(judged("{eventually: breaker.CB3.position == 1}", loss("12 of 300 samples of 'TL_21' from sim")).detail,
              "never true in that time");
}

TEST(RecordingLoss, WhatTheDiskWasTooSlowForMayHaveBeenAnybodys) {
    RecordingLoss sut =
        loss("5 samples of 'signals' are not in the recording: the disk is too slow (5 since the start)");
    sut.dropped("2 samples of 'signals' are not in the recording: the disk is too slow (7 since the start)");
    EXPECT_EQ(sut.of({"relay.*.trip"}), "7 samples of 'signals'");
    EXPECT_EQ(sut.of({"breaker.CB3.position"}), "7 samples of 'signals'");
}

TEST(RecordingLoss, ASignalThatNoCatalogueNamesMayHaveBeenInOneThatWasLost) {
    RecordingLoss const sut = loss("1 of 9 samples of 'signal_catalog' from sim");
    EXPECT_EQ(sut.of({"machine.G1.frequency_hz"}), "1 of 9 samples of 'signal_catalog' from sim");
    EXPECT_EQ(sut.of({"relay.relay2.trip"}), "");
    EXPECT_EQ(loss(kOnTheWay).of({"machine.G1.frequency_hz"}), "");
}

} // namespace
} // namespace gridspace::launcher
