// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/judge/wire_timing.hpp"
#include "launcher/report/figures.hpp"
#include "launcher/report/wire_timing_page.hpp"

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <iterator>

namespace gridspace::launcher {
namespace {

constexpr char const* kScenario = R"(
simulation:
  gateways:
    TL2: {publish: {TL_21: CT21, TL_22: CT22}, subscribe: {TL2_Trip: [CB3]}}
streams:
  SMV21: {kind: smv, rate_hz: 1000}
processes:
  mu21: {program: gridspace-mu, from: TL_21, to: SMV21}
  relay2: {program: gridspace-relay, currents: {from: SMV21, to: SMV22}, trip: TRIP2}
  breaker2: {program: gridspace-breaker, from: TRIP2.status, to: TL2_Trip}
events:
  load_step: {at_s: 0.95, set: {loads.A.p_kw: 1}}
  fault: {at_s: 0.9, apply_fault: {line: TL2}}
  later: {at_s: 1.5, open: [CB3]}
)";

config::Node scenario() {
    config::Diagnostics diagnostics;
    auto node = config::parse_yaml(kScenario, config::make_source("test", kScenario), diagnostics);
    EXPECT_TRUE(diagnostics.ok()) << diagnostics.render();
    return node.value_or(config::Node::map());
}

std::int64_t ns(double seconds) {
    return std::llround(seconds * 1e9);
}

/// A run in real time whose every delay is a different number of milliseconds.
Results run() {
    Results r;
    r.mode = "realtime";
    r.outcome.simulated_s = 2;
    auto const put = [&](std::string const& name, std::vector<double> times_s, std::vector<double> values) {
        SignalSeries& series = r.signals[name];
        for (double const t : times_s) {
            series.times_ns.push_back(ns(t));
        }
        series.values = std::move(values);
    };
    put("stream.SMV21.received", {2}, {2000});
    put("stream.SMV21.lost", {2}, {3});
    put("stream.SMV21.arrival_age_ms", {0.998, 0.999, 1.000, 1.001},
        {2, 2, 2.5, 1.5}); // arrives 1 ms, 1.5 ms, 0 ms after the one before
    put("relay.relay2.pickup", {0, 1.003}, {0, 1});
    put("relay.relay2.trip", {0, 1.003}, {0, 1});
    put("relay.relay2.sample_s", {0, 1.003}, {0, 1.001});
    put("relay.relay2.sample_to_decision_ms", {1.000, 1.001}, {2.75, 2});
    put("stream.TRIP2.st_num", {0.98, 0.99, 1.004, 1.005, 1.007}, {1, 1, 2, 2, 2});
    put("stream.TRIP2.interval_ms", {0.98, 0.99, 1.004, 1.005, 1.007}, {0, 10, 14, 1, 2});
    put("stream.TRIP2.sent_after_ms", {0.98, 0.99, 1.004, 1.005, 1.007}, {980, 990, 1004, 1005, 1007});
    put("stream.TRIP2.heard_st_num", {0.99, 1.004}, {1, 2});
    put("stream.TRIP2.heard_after_ms", {0.99, 1.004}, {990.1, 1004.25});
    put("breaker_ied.breaker2.command", {0, 1.0045}, {0, 1});
    put("breaker_ied.breaker2.commanded_after_ms", {0, 1.0045}, {0, 1004.5});
    put("breaker_ied.breaker2.effect_ms", {0, 1.0045}, {0, 1005.5});
    for (auto const& [phase, opened_s] : {std::pair{"a", 1.010}, {"b", 1.012}, {"c", 1.011}}) {
        put(std::string{"breaker.CB3.pole."} + phase, {0, opened_s}, {2, 1});
    }
    return r;
}

std::string cells(std::vector<ReportTable> const& tables, std::string const& title) {
    std::string out;
    for (ReportTable const& table : tables) {
        for (auto const& row : table.rows) {
            EXPECT_EQ(row.size(), table.header.size()) << table.title;
            for (std::string const& cell : row) {
                out += table.title.starts_with(title) ? cell + "|" : "";
            }
        }
    }
    return out;
}

/// Of those that a report draws whose scenario lists none.
Figure figure_of(std::string const& id, Results const& r, WireTiming const& timing) {
    for (Figure& f : make_figures(report_settings(config::Node::map()), {r, scenario(), timing})) {
        if (f.id == id) {
            return std::move(f);
        }
    }
    ADD_FAILURE() << "no figure " << id;
    return {};
}

TEST(WireTiming, PercentilesAreOfTheNearestRank) {
    std::vector<double> values;
    for (int n = 1000; n >= 1; --n) {
        values.push_back(n);
    }
    values.push_back(std::nan("")); // no value
    Spread const sut = spread_of(values);

    EXPECT_EQ(sut.count, 1000U);
    EXPECT_DOUBLE_EQ(sut.p50, 500);
    EXPECT_DOUBLE_EQ(sut.p99, 990);
    EXPECT_DOUBLE_EQ(sut.p999, 999);
    EXPECT_DOUBLE_EQ(sut.max, 1000);
    EXPECT_NEAR(sut.mean, 500.5, 1e-9);
    EXPECT_EQ(spread_of({}).count, 0U);
}

TEST(WireTiming, TheChainIsCountedFromTheFaultAndNotFromWhatElseHappened) {
    WireTiming const sut = measure_wire_timing(run(), scenario());

    ASSERT_EQ(sut.relays.size(), 1U);
    RelayTiming const& relay = sut.relays[0];
    EXPECT_EQ(relay.event, "fault");
    std::vector<std::pair<std::string, double>> const expected{
        {"sample that picks up", 101},   {"relay decides to trip", 103},        {"trip GOOSE sent", 104},
        {"trip GOOSE received", 104.25}, {"command of breaker2 in DDS", 104.5}, {"command takes effect", 105.5},
        {"CB3: last pole open", 112}};
    ASSERT_EQ(relay.chain.size(), expected.size());
    for (std::size_t i = 0; i < expected.size(); ++i) {
        EXPECT_EQ(relay.chain[i].what, expected[i].first);
        EXPECT_NEAR(relay.chain[i].after_ms, expected[i].second, 1e-6) << relay.chain[i].what;
        if (relay.chain[i].what == "command takes effect") { // simulated time behind the wall clock
            EXPECT_EQ(relay.chain[i].since_before_ms, std::nullopt);
        } else {
            EXPECT_NEAR(relay.chain[i].since_before_ms.value_or(-1),
                        expected[i].second - (i == 0 ? 0 : expected[i - 1].second), 1e-6)
                << relay.chain[i].what;
        }
        EXPECT_FALSE(relay.chain[i].method.empty());
    }
}

TEST(WireTiming, ThePickupOfTheChainIsTheLastOneBeforeTheTrip) {
    Results r = run();
    r.signals["relay.relay2.pickup"] = {"", {0, ns(0.8), ns(0.81), ns(1.003), ns(1.2)}, {0, 1, 0, 1, 0}};
    r.signals["relay.relay2.trip"] = {"", {0, ns(0.8), ns(0.81), ns(1.003), ns(1.2)}, {0, 0, 0, 1, 1}};
    r.signals["relay.relay2.sample_s"] = {"s", {0, ns(0.8), ns(0.81), ns(1.003), ns(1.2)}, {0, 0.8, 0.81, 1.001, 1.2}};

    WireTiming const sut = measure_wire_timing(r, scenario());

    ASSERT_FALSE(sut.relays[0].chain.empty());
    EXPECT_EQ(sut.relays[0].chain[0].what, "sample that picks up");
    EXPECT_NEAR(sut.relays[0].chain[0].after_ms, 101, 1e-6);
}

TEST(WireTiming, TheTripOfTheChainIsTheMessageAfterTheDecisionAndNotAnotherMemberThatChangedBefore) {
    Results r = run();
    // At 0.95 s, after the fault, the stream says that the relay has started; the trip is its next state.
    auto const put = [&](char const* name, std::initializer_list<double> seconds,
                         std::initializer_list<double> values) {
        SignalSeries series;
        for (double const s : seconds) {
            series.times_ns.push_back(ns(s));
        }
        series.values = values;
        r.signals[name] = series;
    };
    put("stream.TRIP2.st_num", {0.89, 0.95, 1.004, 1.005}, {1, 2, 3, 3});
    put("stream.TRIP2.interval_ms", {0.89, 0.95, 1.004, 1.005}, {0, 60, 54, 1});
    put("stream.TRIP2.sent_after_ms", {0.89, 0.95, 1.004, 1.005}, {890, 950, 1004, 1005});
    put("stream.TRIP2.heard_st_num", {0.95, 1.004}, {2, 3});
    put("stream.TRIP2.heard_after_ms", {0.95, 1.004}, {950.2, 1004.25});

    WireTiming const sut = measure_wire_timing(r, scenario());

    ASSERT_GT(sut.relays[0].chain.size(), 3U);
    EXPECT_EQ(sut.relays[0].chain[2].what, "trip GOOSE sent");
    EXPECT_NEAR(sut.relays[0].chain[2].after_ms, 104, 1e-6);
    EXPECT_EQ(sut.relays[0].chain[3].what, "trip GOOSE received");
    EXPECT_NEAR(sut.relays[0].chain[3].after_ms, 104.25, 1e-6);
}

TEST(WireTiming, TheChainIsCountedFromTheFaultOnTheRelaysOwnLine) {
    Results r = run();
    r.folder = std::filesystem::path{testing::TempDir()} / "wire_timing_own_line";
    std::filesystem::create_directories(r.folder);
    std::ofstream{r.folder / "network.yaml"} << "cts:\n  CT21: {line: TL2, end: from}\n  CT31: {line: TL3, end: to}\n";
    config::Node settings = scenario();
    auto const event = [&](char const* name, char const* text) {
        config::Diagnostics none;
        settings.find("events")->set(name, *config::parse_yaml(text, config::make_source("event", text), none));
    };
    event("elsewhere", "{at_s: 0.95, apply_fault: {line: TL3}}");
    EXPECT_EQ(measure_wire_timing(r, settings).relays[0].event, "fault") << "the other is newer, and not its own";

    event("newer", "{at_s: 0.97, apply_fault: {line: TL2}, clear_after_ms: 5}");
    EXPECT_EQ(measure_wire_timing(r, settings).relays[0].event, "newer");

    event("fault", "{at_s: 0.2, apply_fault: {line: TL2}, clear_after_ms: 50}");
    settings.find("events")->erase("newer");
    EXPECT_EQ(measure_wire_timing(r, settings).relays[0].event, "elsewhere") << "its own had long been cleared";
}

TEST(WireTiming, TripsAfterTheFirstAreNotKeptQuiet) {
    Results r = run();
    r.signals["relay.relay2.pickup"] = {"", {0, ns(1.003), ns(1.2), ns(1.6)}, {0, 1, 0, 1}};
    r.signals["relay.relay2.trip"] = {"", {0, ns(1.003), ns(1.2), ns(1.6)}, {0, 1, 0, 1}};
    r.signals["relay.relay2.sample_s"] = {"s", {0, ns(1.003), ns(1.2), ns(1.6)}, {0, 1.001, 1.2, 1.598}};

    WireTiming const timing = measure_wire_timing(r, scenario());
    std::vector<ReportTable> const sut = chain_tables(timing, {});

    EXPECT_NE(sut[0].note.find("first of 2 trips; not shown: that of the sample at 1.598 s"), std::string::npos)
        << sut[0].note;
    EXPECT_NE(wire_timing_json(timing).find(R"("trips_s":[1.001,1.598])"), std::string::npos);
}

TEST(WireTiming, ACommandBeforeTheFaultIsNotOfTheChain) {
    Results r = run();
    r.signals["breaker_ied.breaker2.command"] = {"", {0, ns(0.3), ns(0.4), ns(1.0045)}, {0, 1, 0, 1}};
    r.signals["breaker_ied.breaker2.commanded_after_ms"] = {
        "ms", {0, ns(0.3), ns(0.4), ns(1.0045)}, {0, 300, 400, 1004.5}};
    r.signals["breaker_ied.breaker2.effect_ms"] = {"ms", {0, ns(0.3), ns(0.4), ns(1.0045)}, {0, 301, 401, 1005.5}};

    auto const chain = measure_wire_timing(r, scenario()).relays[0].chain;
    auto const step =
        std::find_if(chain.begin(), chain.end(), [](auto const& s) { return s.what.starts_with("command of"); });
    ASSERT_NE(step, chain.end());
    EXPECT_NEAR(step->after_ms, 104.5, 1e-6);
}

TEST(WireTiming, ClocksAreNotMixedAndThereIsNoNegativeZero) {
    Results r = run();
    r.signals["breaker_ied.breaker2.effect_ms"].values.back() = 1004.17; // the simulation lags behind the wall clock
    r.signals["stream.TRIP2.heard_after_ms"].values.back() = 1004 - 1e-9;

    auto const sut = cells(chain_tables(measure_wire_timing(r, scenario()), {}), "From fault");

    EXPECT_NE(sut.find("command takes effect|104.170|– (another clock)|"), std::string::npos) << sut;
    EXPECT_EQ(sut.find("-0.000"), std::string::npos) << sut;
    r.mode = "lockstep";
    EXPECT_NEAR(measure_wire_timing(r, scenario()).relays[0].chain[5].since_before_ms.value_or(-1), -0.33, 1e-6)
        << "one clock";
}

TEST(WireTiming, RefusedFramesHaveAColumnOfTheirOwn) {
    Results r = run();
    r.signals["stream.SMV21.invalid"] = {"", {ns(2)}, {2000}};

    WireTiming const timing = measure_wire_timing(r, scenario());

    EXPECT_NE(cells(wire_timing_tables(timing, {}), "Sampled values")
                  .find("|2000|<span class=\"bad\">3</span>|<span class=\"bad\">2000</span>|0|0|"),
              std::string::npos);
    EXPECT_NE(wire_timing_json(timing).find("\"refused\":2000"), std::string::npos);
}

TEST(WireTiming, ARunWithoutATripHasNoChain) {
    Results r = run();
    r.signals["relay.relay2.trip"].values = {0, 0};

    EXPECT_TRUE(measure_wire_timing(r, scenario()).relays[0].chain.empty());
}

TEST(WireTiming, IntervalsAndRateComeFromArrivals) {
    WireTiming const sut = measure_wire_timing(run(), scenario());

    ASSERT_EQ(sut.smv.size(), 1U);
    EXPECT_EQ(sut.smv[0].lost, 3U);
    EXPECT_EQ(sut.smv[0].interval.count, 3U);
    EXPECT_NEAR(sut.smv[0].interval.max, 1.5, 1e-9);
    EXPECT_NEAR(sut.smv[0].mean_hz, 1000, 1e-6); // the line through 0, 1, 2.5 and 2.5 ms: 4.5 / 4.5 a millisecond
    ASSERT_EQ(sut.goose.size(), 1U);
    EXPECT_EQ(sut.goose[0].event, std::optional<std::size_t>{2});
    EXPECT_EQ(sut.goose[0].steady_ms, std::nullopt) << "one interval alone does not say whether it still grows";
}

TEST(WireTiming, CountersOfARelayThatWasStartedAgainSayThatTheyAreNoLess) {
    Results r = run();
    r.counter_gaps["stream.SMV21.lost"].push_back({"relay2", 0, 0.4});

    WireTiming const timing = measure_wire_timing(r, scenario());
    std::string const sut = cells(wire_timing_tables(timing, {}), "Sampled values");

    EXPECT_NE(sut.find("SMV21|at least 2000|<span class=\"bad\">at least 3</span>|at least 0|at least 0|at least 0|"),
              std::string::npos)
        << sut;
    EXPECT_NE(wire_timing_json(timing).find("\"not_counted\":\"what relay2 counted from 0 s to 0.4 s\""),
              std::string::npos);
}

TEST(WireTiming, WithSomebodyElsesRelayTheCaptureAndTheBreakerIedTell) {
    config::Node settings = scenario();
    settings.find("processes")->erase("relay2");
    config::Diagnostics none;
    constexpr char const* kStreams =
        "SMV21: {kind: smv, sv_id: MU1, app_id: 0x4021}\nTRIP2: {kind: goose, "
        "control_block: R1}\nGONE: {kind: smv, sv_id: X}\nODD: {kind: smv, sv_id: MU1, app_id: "
        "none}";
    settings.set("streams", *config::parse_yaml(kStreams, config::make_source("streams", kStreams), none));
    Results r = run();
    for (char const* gone : {"stream.SMV21.received", "stream.SMV21.arrival_age_ms", "stream.TRIP2.st_num",
                             "stream.TRIP2.interval_ms", "stream.TRIP2.sent_after_ms", "relay.relay2.trip",
                             "relay.relay2.pickup", "relay.relay2.sample_s", "relay.relay2.sample_to_decision_ms"}) {
        r.signals.erase(gone);
    }
    wire::StreamStatistics smv, fake, goose;
    smv.stream.id = fake.stream.id = "MU1";
    smv.stream.app_id = fake.stream.app_id = 0x4021;
    smv.stream.frames = 1000;
    smv.stream.lost = 60;
    smv.stream.counter = fake.stream.counter = std::make_shared<iec61850::SvSubscriber>(iec61850::SvSubscription{});
    fake.stream.frames = 3;
    goose.stream.goose = true;
    goose.stream.id = "R1";
    goose.stream.frames = 4;
    goose.stream.intervals = {{10, true}, {7, false}, {1, true}};
    r.capture.emplace();
    r.capture->streams = {fake, smv, goose};

    WireTiming const timing = measure_wire_timing(r, settings);

    ASSERT_EQ(timing.smv.size(), 1U);
    EXPECT_TRUE(timing.smv[0].captured);
    EXPECT_EQ(timing.smv[0].lost, 60U);
    EXPECT_EQ(timing.smv[0].other_senders, 1U);
    ASSERT_EQ(timing.goose.size(), 1U);
    EXPECT_EQ(timing.goose[0].event, std::optional<std::size_t>{2});
    EXPECT_THAT(timing.goose[0].interval_ms, testing::ElementsAre(0, 10, 7, 1));
    EXPECT_THAT(timing.not_seen, testing::UnorderedElementsAre("GONE", "ODD"));
    ASSERT_EQ(timing.relays.size(), 1U);
    std::vector<std::string> steps;
    for (ChainStep const& step : timing.relays[0].chain) {
        steps.push_back(step.what);
    }
    EXPECT_THAT(steps, testing::ElementsAre("trip GOOSE received", "command of breaker2 in DDS", "command takes effect",
                                            "CB3: last pole open"));
    auto const chains = chain_tables(timing, {}), tables = wire_timing_tables(timing, {});
    EXPECT_FALSE(timing.relays[0].chain[0].communication) << "nobody knows when it was sent";
    EXPECT_NE(cells(tables, "Sampled values").find("SMV21, in the capture|"), std::string::npos);
    EXPECT_NE(chains[0].note.find("not measurable"), std::string::npos);
    EXPECT_NE(tables[0].note.find("Neither counted nor captured: GONE, ODD."), std::string::npos);
}

TEST(WireTiming, AFirstFrameThatWasLateDoesNotMoveTheRate) {
    Results r = run();
    SignalSeries& ages = r.signals["stream.SMV21.arrival_age_ms"];
    ages = {"ms", {}, {}};
    for (int frame = 0; frame < 48'000; ++frame) { // ten seconds of 4800 Hz; the first comes 20 ms late
        ages.times_ns.push_back(ns(frame / 4800.0));
        ages.values.push_back(frame == 0 ? 22 : 2);
    }

    EXPECT_NEAR(measure_wire_timing(r, scenario()).smv[0].mean_hz, 4800, 0.01); // over its time: 4809.6 Hz
}

TEST(WireTiming, FramesOfSeveralSamplesCountAsSoManySamples) {
    config::Node settings = scenario();
    settings.find("streams")->find("SMV21")->set("samples_per_frame", config::Node::scalar("2"));
    Results r = run();
    SignalSeries& ages = r.signals["stream.SMV21.arrival_age_ms"];
    ages = {"ms", {}, {}};
    for (int frame = 0; frame < 1000; ++frame) { // 1000 Hz, two samples in a frame
        ages.times_ns.push_back(ns(frame * 0.002));
        ages.values.push_back(2);
    }

    WireTiming const sut = measure_wire_timing(r, settings);

    EXPECT_NEAR(sut.smv[0].mean_hz, 1000, 1e-6);
    std::string table;
    for (ReportTable const& t : wire_timing_tables(sut, {})) {
        for (auto const& row : t.rows) {
            table += row[0] == "SMV21" && row.size() == 9 ? row[7] : "";
        }
    }
    EXPECT_EQ(table, "+0 ppm");
    Figure const rate = figure_of("sample_rate", r, sut);
    EXPECT_EQ(rate.y_label, "samples per second");
    ASSERT_FALSE(rate.series[0].values.empty());
    for (double const hz : rate.series[0].values) {
        EXPECT_NEAR(hz, 1000, 1e-6);
    }
    EXPECT_NEAR(rate.lines[0].value, 1000, 1e-9);
}

TEST(WireTiming, TheSteadyIntervalIsThatOfMessagesWhoseIntervalNoLongerGrows) {
    Results r = run();
    r.signals["stream.TRIP2.st_num"].values = {1, 1, 1, 1, 1, 1, 2, 2, 2, 2, 3, 3, 3, 3};
    r.signals["stream.TRIP2.interval_ms"].values = {0, 1, 2, 4, 10, 10.2, 7, 1, 2, 4, 3, 1, 2, 4};
    EXPECT_EQ(measure_wire_timing(r, scenario()).goose[0].steady_ms, 10.2);

    r.signals["stream.TRIP2.interval_ms"].values = {0, 1, 2, 4, 8, 16, 7, 1, 2, 4, 3, 1, 2, 4};
    EXPECT_EQ(measure_wire_timing(r, scenario()).goose[0].steady_ms, std::nullopt);
    EXPECT_NE(wire_timing_json(measure_wire_timing(r, scenario())).find("\"steady_interval_ms\":null"),
              std::string::npos);
}

TEST(WireTiming, ADelayBelowZeroIsNotMeasurableAndGetsNoVerdict) {
    Results r = run();
    r.signals["relay.relay2.sample_to_decision_ms"] = {"ms", {ns(1.000), ns(1.001)}, {-199.858, 2}};
    r.signals["stream.TRIP2.wire_delay_ms"] = {"ms", {ns(1.004)}, {-0.5}};
    r.signals["stream.SMV21.wire_delay_ms"] = {"ms", {ns(1.004)}, {0.25}};
    Published published;
    published.delay_limit_ms = 4;

    WireTiming const timing = measure_wire_timing(r, scenario());
    auto const sut = cells(wire_timing_tables(timing, published), "One-way delays");

    EXPECT_NE(sut.find("transfer|relay2|2|not measurable: 1 of 2 below 0, the lowest -199.858||||||not measurable|not "
                       "measurable|"),
              std::string::npos)
        << sut;
    EXPECT_NE(sut.find("wire_delay|TRIP2|1|not measurable: 1 of 1 below 0, the lowest -0.500|"), std::string::npos)
        << sut;
    EXPECT_NE(sut.find("wire_delay|SMV21|1|0.250|"), std::string::npos) << sut;
    std::string const json = wire_timing_json(timing);
    EXPECT_NE(json.find(R"("transfer_ms":{"n":2,"not_measurable":{"below_zero":1,"min":-199.858}})"), std::string::npos)
        << json;
    Figure const delays = figure_of("delays", r, timing);
    ASSERT_EQ(delays.series.size(), 1U);
    EXPECT_EQ(delays.series[0].name, "SMV21");
    EXPECT_NE(delays.note.find("Not measurable, and not drawn: TRIP2"), std::string::npos) << delays.note;
}

TEST(WireTiming, AStepBeforeTheOneBeforeItGetsNoVerdict) {
    Results r = run();
    r.signals["stream.TRIP2.heard_after_ms"].values.back() = 904;

    WireTiming const timing = measure_wire_timing(r, scenario());
    auto const sut = cells(chain_tables(timing, {}), "From fault");

    EXPECT_NE(sut.find("trip GOOSE received|4.000|-100.000|not measurable|"), std::string::npos) << sut;
    EXPECT_EQ(timing.relays[0].chain[1].what, "relay decides to trip");
    EXPECT_FALSE(timing.relays[0].chain[1].communication) << "a transfer class is about a message";
    EXPECT_NE(wire_timing_json(timing).find(R"("within_class":null)"), std::string::npos);
}

TEST(WireTiming, TablesShowPublishedValuesBesideTheMeasuredOnesAndSayHow) {
    Published published;
    published.smv_rate_hz = 987.5;
    published.delay_limit_ms = 4;
    WireTiming const timing = measure_wire_timing(run(), scenario());

    std::vector<ReportTable> sut = chain_tables(timing, published);
    std::ranges::move(wire_timing_tables(timing, published), std::back_inserter(sut));

    ASSERT_EQ(sut.size(), 3U);
    std::string all;
    for (ReportTable const& table : sut) {
        for (auto const& row : table.rows) {
            EXPECT_EQ(row.size(), table.header.size()) << table.title;
            for (std::string const& cell : row) {
                all += cell + "|";
            }
        }
    }
    EXPECT_NE(all.find("987.50"), std::string::npos) << all;
    EXPECT_NE(sut[1].note.find("kernel's stamps"), std::string::npos);
    EXPECT_NE(wire_timing_json(timing).find("\"command takes effect\""), std::string::npos);
}

} // namespace
} // namespace gridspace::launcher
