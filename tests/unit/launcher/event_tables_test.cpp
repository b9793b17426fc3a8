// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/event_tables.hpp"

#include "common/config/yaml.hpp"

#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

Results results() {
    Results r;
    r.events = {{0.1, "sim", "event", "fault"},
                {0.11, "relay<1>", "start", "PDIS2"},
                {0.12, "relay<1>", "trip", "sample 9"},
                {0.3, "sim", "event", "unknown"}};
    r.signals["breaker.QB.position"] = {"", {0, 130'000'000, 150'000'000, 400'000'000}, {2, 0, 1, 2}};
    r.signals["breaker.QB.pole.a"] = {"", {0, 140'000'000}, {2, 1}};
    return r;
}

config::Node timeline() {
    constexpr char const* kText =
        "events: {fault: {at_s: 0.1, apply_fault: {line: BC, position_percent: 50, type: 1ph_g}, clear_after_ms: 80}}";
    config::Diagnostics none;
    return *config::parse_yaml(kText, config::make_source("scenario", kText), none);
}

TEST(EventTables, AnEventOfTheTimelineSaysWhatItDidAndABreakerWhenItsLastPoleParted) {
    ReportTable const sut = event_table(results(), timeline());
    EXPECT_EQ(sut.header[1], "since fault, ms");
    std::vector<std::vector<std::string>> const wanted{
        {"0.1000&nbsp;s", "+0.00", "scenario", "event",
         "fault: apply_fault (line: BC, position_percent: 50 %, type: 1ph_g), clear_after_ms: 80 ms"},
        {"0.1100&nbsp;s", "+10.00", "relay&lt;1&gt;", "start", "PDIS2"},
        {"0.1200&nbsp;s", "+20.00", "relay&lt;1&gt;", "trip", "sample 9"},
        {"0.1500&nbsp;s", "+50.00", "QB", "opened", "the last pole has parted"},
        {"0.3000&nbsp;s", "+200.00", "scenario", "event", "unknown"},
        {"0.4000&nbsp;s", "+300.00", "QB", "closed", ""}};
    EXPECT_EQ(sut.rows, wanted);
}

TEST(EventTables, OfALongListWhatWasSwitchedStaysAndTheRestIsCounted) {
    ReportTable const sut = main_events(results(), timeline());
    EXPECT_EQ(sut.rows.size(), 5U) << "all but the start";
    EXPECT_TRUE(sut.note.starts_with("5 of 6 events")) << sut.note;
}

} // namespace
} // namespace gridspace::launcher
