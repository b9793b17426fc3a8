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
