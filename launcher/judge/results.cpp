// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/results.hpp"

#include "common/config/yaml.hpp"
#include "common/json_value.hpp"
#include "common/lateness_json.hpp"
#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/judge/recording_loss.hpp"
#include "launcher/judge/run_network.hpp"
#include "launcher/judge/run_signals.hpp"
#include "launcher/judge/wall_clock.hpp"
#include "launcher/judge/wire_timing.hpp"
#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;
namespace fs = std::filesystem;

Result<void> read_manifest(fs::path const& folder, Results& out) {
    std::ifstream stream{folder / "manifest.json"};
    Json const m = Json::parse(stream, nullptr, false);
    if (!m.is_object()) {
        return fail(ExitCode::usage, fmt::format("'{}' is no JSON object", (folder / "manifest.json").string()),
                    "it says when the run began and how it ended; without it nothing can be judged");
    }
    std::string const none;
    out.scenario = value_of(m, "scenario", none);
    out.description = value_of(m, "description", none);
    out.scheduling = value_of(m, "scheduling", none);
    out.idle_processors = value_of(m, "idle_processors", none);
    out.duration_s = value_of(m, "duration_s", 0.0);
    out.mode = value_of(part_of(m, "clock"), "mode", none);
    out.epoch_unix_s = parse_utc(value_of(part_of(m, "clock"), "epoch", none)).value_or(0);
    out.outcome.exit_code = value_of(m, "exit", static_cast<int>(ExitCode::child_died));
    out.outcome.cause = value_of(m, "cause", std::string{"the launcher did not see its end"});
    out.outcome.simulated_s = value_of(m, "simulated_s", 0.0);
    out.outcome.wall_s = value_of(m, "wall_s", 0.0);
    out.outcome.overruns = value_of(m, "overruns", std::uint64_t{0});
    out.outcome.ticks = lateness_of(part_of(m, "ticks"));
    out.machine_latency = machine_latency_of(part_of(m, "machine_latency"));
    Json const processes = part_of(m, "processes");
    for (auto const& [name, p] : processes.items()) {
        out.processes.push_back({name, value_of(p, "program", none), value_of(p, "host", none),
                                 value_of(p, "end", none), value_of(p, "exit", 0), value_of(p, "cpu_s", 0.0)});
    }
    return {};
}

/// What the launcher has seen of the end.
void take_outcome(RunOutcome const& seen, Results& out) {
    out.outcome = seen;
    for (Results::ProcessRow& row : out.processes) {
        for (RunOutcome::ProcessEnd const& end : seen.ends) {
            if (end.process == row.name) {
                row.end = end.how;
                row.code = end.code;
                row.cpu_s = end.cpu_s;
            }
        }
    }
}

Result<void> read_recording(fs::path const& folder, Results& out, RecordingLoss& loss, AlsoNamed also_named) {
    fs::path const file = folder / "data.mcap";
    if (!fs::exists(file)) {
        out.recording_note = "nothing was recorded";
        return {};
    }
    std::map<std::string, Results::Topic> topics;
    std::map<std::string, std::set<std::string>> processes;
    std::uint64_t newest_ns = 0;
    auto const outcome = mcap::read_messages(file, [&](mcap::Message const& message) {
        newest_ns = std::max(newest_ns, message.time_ns);
        Results::Topic& topic = topics[message.channel.topic];
        ++topic.samples;
        if (topic.samples == 1) {
            topic.topic = message.channel.topic;
            topic.type = message.schema.name;
        }
        if (auto const it = message.channel.metadata.find("process"); it != message.channel.metadata.end()) {
            processes[topic.topic].insert(it->second);
            if (message.channel.topic == "signal_catalog") {
                loss.publishes_catalog(it->second, message.data);
            }
        }
        return true;
    });
    if (!outcome) {
        return std::unexpected{outcome.error()};
    }
    out.recording_note = outcome->note;
    if (!outcome->complete) {
        std::uint64_t const whole_until_ns = std::min(newest_ns, outcome->damaged_from_ns.value_or(newest_ns));
        out.cut_at_s = std::max(0.0, static_cast<double>(whole_until_ns) / 1e9 - static_cast<double>(out.epoch_unix_s));
    }
    for (auto& [name, topic] : topics) {
        topic.processes.assign(processes[name].begin(), processes[name].end());
        out.topics.push_back(std::move(topic));
    }
    auto signals = read_signals(file, needed_signals(out, also_named));
    if (!signals) {
        return std::unexpected{signals.error()};
    }
    out.signals = std::move(*signals);
    if (out.mode == "realtime") {
        derive_wire_delays(out.signals);
    }
    return {};
}

/// Only where somebody watched, attacked or disturbed: other runs are not read twice.
Result<void> add_intrusion(fs::path const& folder, Results& out) {
    config::Diagnostics unread;
    auto const scenario = config::load_yaml(folder / "scenario.resolved.yaml", unread);
    bool const disturbed = scenario && is_disturbed(*scenario);
    bool const watched = std::any_of(out.topics.begin(), out.topics.end(),
                                     [](auto const& t) { return t.type == "IdsVerdict" || t.type == "AttackLabel"; });
    if (!disturbed && !watched) {
        return {};
    }
    auto score = read_intrusion_score(folder, out.signals, out.events, out.outcome.simulated_s);
    if (!score) {
        return std::unexpected{score.error()};
    }
    out.intrusion = std::move(*score);
    add_intrusion_signals(out.intrusion, out.outcome.simulated_s, out.signals);
    if (disturbed) {
        out.consequences = find_consequences(out.intrusion, *scenario, network_of_run(folder, *scenario), out.signals,
                                             out.outcome.simulated_s);
        add_consequence_signals(*out.consequences, out.outcome.simulated_s, out.signals);
    }
    return {};
}

/// The capture of a run, where streams were heard by nobody who counts: a relay that is not ours, a process that ended.
void read_capture(fs::path const& folder, Results& out) {
    config::Diagnostics unread;
    auto const scenario = config::load_yaml(folder / "scenario.resolved.yaml", unread);
    fs::path const file = pcapng::capture_of_run(folder);
    if (!scenario || !fs::exists(file) || uncounted_streams(out, *scenario).empty()) {
        return;
    }
    auto capture = wire::capture_statistics(file);
    if (capture) {
        out.capture = std::move(*capture);
    } else {
        out.notes.push_back(fmt::format("{} cannot be read: {}", file.filename().string(), capture.error().message));
    }
}

void judge_all(fs::path const& folder, Results& out, RecordingLoss loss) {
    config::Diagnostics diagnostics;
    auto const scenario = config::load_yaml(folder / "scenario.resolved.yaml", diagnostics);
    config::Node const* expect = scenario ? scenario->find("expect") : nullptr;
    auto const expectations = read_expectations(expect == nullptr ? config::Node{} : *expect, diagnostics);
    if (!diagnostics.ok()) { // somebody has changed it: half an expectation says nothing
        out.notes.push_back(fmt::format("the expectations cannot be judged: {}", diagnostics.sorted().front().message));
        out.unjudged = true;
        return;
    }
    out.moments = moments_of(scenario->find("events"), out.events);
    for (LoggedEvent const& event : out.events) {
        if (event.event == "samples_dropped") {
            loss.dropped(event.text);
        }
    }
    for (Expectation const& e : expectations) {
        out.expectations.push_back(judge(e, out.signals, out.moments, out.outcome.simulated_s, out.mode == "lockstep"));
        mind_gaps(e, out.counter_gaps, out.expectations.back());
        name_loss(e, loss, out.expectations.back());
        if (out.cut_at_s) {
            mind_the_end(e, out.moments, *out.cut_at_s, out.outcome.simulated_s, out.expectations.back());
        }
    }
}

} // namespace

bool Results::passed() const {
    return std::none_of(expectations.begin(), expectations.end(),
                        [](auto const& e) { return e.status == ExpectationResult::Status::failed && !e.advisory; });
}

int Results::exit_code() const {
    if (outcome.exit_code != 0) {
        return outcome.exit_code;
    }
    return static_cast<int>(unjudged ? ExitCode::usage : passed() ? ExitCode::ok : ExitCode::expectation_failed);
}

Result<Results> read_results(fs::path const& folder, RunOutcome const* seen, AlsoNamed also_named) {
    if (!fs::exists(folder / "manifest.json")) {
        return fail(ExitCode::usage, fmt::format("'{}' is not a run folder", folder.string()),
                    "it has no manifest.json: give a folder that `gridspace run` has written, or latest");
    }
    Results out;
    out.folder = fs::canonical(folder);
    if (auto ok = read_manifest(folder, out); !ok) {
        return std::unexpected{ok.error()};
    }
    if (seen != nullptr) {
        take_outcome(*seen, out);
    }
    out.events = read_events(folder / "events.ndjson");
    RecordingLoss loss;
    if (auto ok = read_recording(folder, out, loss, also_named); !ok) {
        return std::unexpected{ok.error()};
    }
    out.silences = silences(out.signals, loss.published(), out.events);
    out.counter_gaps = continue_counters(out.signals, loss.published(), out.events);
    if (auto ok = add_intrusion(folder, out); !ok) {
        return std::unexpected{ok.error()};
    }
    read_capture(folder, out);
    add_wall_clock_values(folder, out.outcome.simulated_s, out.signals);
    judge_all(folder, out, std::move(loss));
    std::error_code none;
    for (auto const& file : fs::directory_iterator{folder / "comtrade", none}) {
        if (file.path().extension() == ".cfg") {
            out.comtrade.push_back(file.path().filename().string());
        }
    }
    std::sort(out.comtrade.begin(), out.comtrade.end());
    return out;
}

} // namespace gridspace::launcher
