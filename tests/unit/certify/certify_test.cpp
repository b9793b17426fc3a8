// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/certify/certificate.hpp"

#include <fstream>
#include <gtest/gtest.h>

namespace gridspace::launcher {
namespace {

/// Tables of the exact interval, for example Clopper and Pearson 1934; all successes: (alpha / 2)^(1 / n).
TEST(ClopperPearson, GivesTheTabulatedIntervals) {
    struct Row {
        std::size_t k, n;
        double confidence, low, high;
    };
    for (Row const& r : {Row{5, 10, 0.95, 0.1871, 0.8129},
                         {0, 10, 0.95, 0, 0.3085},
                         {10, 10, 0.95, 0.6915, 1},
                         {12, 12, 0.95, 0.7354, 1},
                         {95, 100, 0.95, 0.8872, 0.9836},
                         {1000, 1000, 0.95, 0.99632, 1}}) {
        Proportion const p = clopper_pearson(r.k, r.n, r.confidence);
        EXPECT_NEAR(p.low, r.low, 5e-5) << r.k << " of " << r.n;
        EXPECT_NEAR(p.high, r.high, 5e-5) << r.k << " of " << r.n;
    }
    EXPECT_EQ(clopper_pearson(0, 0, 0.95).high, 1);
}

RunRecord record(std::vector<RunRecord::Value> values, int exit = 0) {
    RunRecord out;
    out.exit = exit;
    out.values = std::move(values);
    return out;
}
RunRecord::Value condition(char const* name, bool holds) {
    RunRecord::Value out;
    out.name = name;
    out.value = holds ? 1 : 0;
    out.passed = holds;
    return out;
}
RunRecord::Value trip_after(double ms) {
    RunRecord::Value out;
    out.name = kTripMs;
    out.value = ms;
    return out;
}

GroupResult group(bool must_trip, std::vector<std::optional<RunRecord>> records) {
    GroupResult out;
    out.group.must_trip = must_trip;
    out.group.within_ms = 50;
    out.plan.runs.resize(records.size());
    out.finished.records = std::move(records);
    return out;
}

TEST(Certificate, CountsWhatTrippedInTimeAndWhatStayed) {
    CertifyCase all;
    all.criteria.dependability_at_least = 0.5;
    all.criteria.security_at_least = 0.9;
    std::vector<GroupResult> groups;
    groups.push_back(
        group(true, {record({trip_after(20), condition(kTripped, true), condition(kQuietBefore, true)}),
                     record({trip_after(30), condition(kTripped, true), condition(kQuietBefore, true)}),
                     record({trip_after(80), condition(kTripped, false), condition(kQuietBefore, true)}, 1),
                     record({trip_after(5), condition(kTripped, true), condition(kQuietBefore, false)}, 1)}));
    groups.push_back(group(false, {record({condition(kStayed, true)}), record({condition(kStayed, true)})}));
    Certificate const c = make_certificate(all, groups);
    EXPECT_EQ(c.dependability.successes, 2U);
    EXPECT_EQ(c.dependability.of, 4U);
    EXPECT_EQ(c.security.successes, 2U); // the trip before its fault is the third
    EXPECT_EQ(c.security.of, 3U);
    EXPECT_EQ(c.trip_ms, (std::vector<double>{20, 30}));
    ASSERT_EQ(c.criteria.size(), 2U);
    EXPECT_TRUE(c.criteria[0].met);
    EXPECT_FALSE(c.criteria[1].met);
    EXPECT_FALSE(c.is_passed());
    ASSERT_EQ(c.worst.size(), 4U);
    EXPECT_EQ(c.worst[0].run, 2U); // failures first, then the slowest
    EXPECT_EQ(c.worst[2].run, 1U);
}

TEST(Certificate, IsNotPassedWhileARunIsMissingOrEndedEarly) {
    CertifyCase const all;
    for (bool const missing : {true, false}) {
        std::vector<GroupResult> groups;
        groups.push_back(
            group(false, {record({condition(kStayed, true)}), missing ? std::nullopt : std::optional{record({}, 4)}}));
        Certificate const c = make_certificate(all, groups);
        EXPECT_FALSE(c.is_passed());
        EXPECT_EQ(c.security.of, 1U); // it counts for nothing
    }
    std::vector<GroupResult> groups;
    groups.push_back(group(false, {record({condition(kStayed, true)})}));
    EXPECT_TRUE(make_certificate(all, groups).is_passed());
}

TEST(CertifyCase, NamesWhatIsWrongWithIt) {
    for (auto const& [text, expected] : {std::pair{"faults: {a: {must: trip}}", "how soon has it to trip?"},
                                         {"faults: {a: {must: stay, within_ms: 3}}", "it must not trip at any time"},
                                         {"faults: {a: {must: hold}}", "hold"},
                                         {"faults: {}", "no group of faults"}}) {
        std::string const file = ::testing::TempDir() + "certify_case.yaml";
        std::ofstream{file} << "gridspace_certify: 1\nname: x\nscenario: s.yaml\ntrip: a == 1\nfault: f\n" << text;
        config::Diagnostics diagnostics;
        EXPECT_FALSE(load_certify_case(file, diagnostics));
        EXPECT_NE(diagnostics.render().find(expected), std::string::npos) << diagnostics.render();
    }
}

} // namespace
} // namespace gridspace::launcher
