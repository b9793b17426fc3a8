// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/run_info.hpp"

#include "common/json_value.hpp"
#include "common/text.hpp"
#include "common/time.hpp"
#include "launcher/wire/capture_statistics.hpp"
#include "recorder/mcap/mcap_index.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <map>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::launcher {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Json read_json(fs::path const& file) {
    std::ifstream stream{file};
    Json out = Json::parse(stream, nullptr, false);
    return out.is_object() ? out : Json::object();
}

/// For a terminal.
std::string shown(Json const& text) {
    return printable(text.get<std::string>());
}

struct Topic {
    std::string type;
    std::uint64_t samples{0}, octets{0};
    double first_s{0}, last_s{0};
    std::set<std::string> processes;
};

/// Topics of a recording with counts, rates and who wrote them. Times are from the epoch.
Result<Json> recording_json(fs::path const& file, std::int64_t epoch_ns) {
    auto const content = mcap::content_of(file);
    if (!content) {
        return std::unexpected{content.error()};
    }
    auto const seconds = [&](std::uint64_t time_ns) {
        return static_cast<double>(static_cast<std::int64_t>(time_ns - static_cast<std::uint64_t>(epoch_ns))) / 1e9;
    };
    std::map<std::string, Topic> topics;
    Json first = nullptr, last = nullptr;
    for (mcap::ChannelContent const& c : content->channels) {
        Topic& topic = topics[c.channel.topic];
        double const from = seconds(c.first_ns), to = seconds(c.last_ns);
        topic.first_s = topic.samples == 0 ? from : std::min(topic.first_s, from);
        topic.last_s = topic.samples == 0 ? to : std::max(topic.last_s, to);
        first = first.is_null() ? from : std::min(first.get<double>(), from);
        last = last.is_null() ? to : std::max(last.get<double>(), to);
        topic.samples += c.messages;
        topic.octets += c.octets;
        topic.type = topic.type.empty() ? c.type : topic.type;
        if (auto const process = c.channel.metadata.find("process"); process != c.channel.metadata.end()) {
            topic.processes.insert(process->second);
        }
    }
    Json list = Json::array();
    for (auto const& [name, topic] : topics) {
        // Intervals, not samples, by the time between the first and the last: 1 Hz is 1 Hz over any length.
        double const length_s = topic.last_s - topic.first_s;
        list.push_back({{"name", name},
                        {"type", topic.type},
                        {"samples", topic.samples},
                        {"octets", topic.octets},
                        {"rate_hz", length_s > 0 ? static_cast<double>(topic.samples - 1) / length_s : 0},
                        {"first_s", topic.first_s},
                        {"last_s", topic.last_s},
                        {"processes", topic.processes}});
    }
    std::error_code ignored;
    return Json{{"file", file.filename().string()},
                {"file_octets", fs::file_size(file, ignored)},
                {"complete", content->complete},
                {"note", content->note},
                {"samples", content->messages},
                {"first_s", first},
                {"last_s", last},
                {"topics", list}};
}

Result<Json> capture_json(fs::path const& file) {
    auto const statistics = wire::capture_statistics(file);
    if (!statistics) {
        return std::unexpected{statistics.error()};
    }
    std::error_code ignored;
    Json streams = Json::array();
    for (wire::StreamStatistics const& s : statistics->streams) {
        streams.push_back({{"kind", s.stream.goose ? "goose" : "smv"},
                           {"id", s.stream.id},
                           {"source", s.stream.source.to_string()},
                           {"frames", s.stream.frames},
                           {"rate_hz", s.stream.rate_hz()},
                           {"lost", s.stream.lost}});
    }
    return Json{{"file", file.filename().string()},
                {"file_octets", fs::file_size(file, ignored)},
                {"complete", !statistics->truncated},
                {"frames", statistics->frames},
                {"seconds", statistics->seconds},
                {"points", statistics->points},
                {"streams", streams}};
}

/// Everything in the folder, the parts of a folder added up.
std::pair<Json, std::uint64_t> sizes(fs::path const& folder) {
    std::map<std::string, std::uint64_t> parts;
    std::uint64_t total = 0;
    std::error_code error;
    for (auto it = fs::recursive_directory_iterator{folder, error}; !error && it != fs::recursive_directory_iterator{};
         it.increment(error)) {
        if (it->is_regular_file(error) && !it->is_symlink(error)) {
            fs::path const relative = it->path().lexically_relative(folder);
            bool const nested = std::distance(relative.begin(), relative.end()) > 1;
            parts[relative.begin()->string() + (nested ? "/" : "")] += it->file_size(error);
            total += it->file_size(error);
        }
    }
    Json out = Json::object();
    for (auto const& [name, octets] : parts) {
        out[name] = octets;
    }
    return {out, total};
}

Json expectations_json(Json const& summary) {
    std::uint64_t passed = 0, failed = 0, open = 0;
    Json failures = Json::array();
    for (Json const& e : value_of(summary, "expectations", Json::array())) {
        Json const pass = e.is_object() ? value_of(e, "pass", Json(nullptr)) : Json(nullptr);
        if (!pass.is_boolean()) {
            ++open;
        } else if (pass.get<bool>()) {
            ++passed;
        } else {
            ++failed;
            failures.push_back(text_of(e, "name"));
        }
    }
    return {{"passed", passed}, {"failed", failed}, {"not_judged", open}, {"failures", failures}};
}

/// Passed, failed, or why there is no verdict.
std::string verdict_of(Json const& manifest, Json const& summary) {
    if (!manifest.contains("exit")) {
        return "not finished: the run is under way, or its supervisor was killed";
    }
    int const code = value_of(summary, "exit", value_of(manifest, "exit", 0));
    std::string const cause = text_of(manifest, "cause");
    if (code == 0) {
        return "passed";
    }
    return code == static_cast<int>(ExitCode::expectation_failed)
               ? "failed: an expectation did not hold"
               : fmt::format("ended early (exit {}){}{}", code, cause.empty() ? "" : ": ", cause);
}

std::string size_text(double octets) {
    for (char const* unit : {"B", "kB", "MB", "GB"}) {
        if (octets < 1000 || unit == std::string{"GB"}) {
            return fmt::format("{:.{}f} {}", octets, unit == std::string{"B"} || octets >= 100 ? 0 : 1, unit);
        }
        octets /= 1000;
    }
    return "";
}

std::string recording_text(Json const& r) {
    std::string out = fmt::format("{}  {}, {} samples{}\n", shown(r["file"]), size_text(r["file_octets"].get<double>()),
                                  r["samples"].get<std::uint64_t>(),
                                  r["complete"].get<bool>() ? "" : "; incomplete: " + shown(r["note"]));
    if (r["topics"].empty()) {
        return out;
    }
    out += fmt::format("  {:<22} {:<20} {:>10} {:>11} {:>10} {:>12}  {}\n", "topic", "type", "samples", "rate Hz",
                       "from s", "to s", "processes");
    for (Json const& t : r["topics"]) {
        out += fmt::format("  {:<22} {:<20} {:>10} {:>11.6g} {:>10.6g} {:>12.9g}  {}\n", shown(t["name"]),
                           shown(t["type"]), t["samples"].get<std::uint64_t>(), t["rate_hz"].get<double>(),
                           t["first_s"].get<double>(), t["last_s"].get<double>(),
                           printable(join(t["processes"].get<std::vector<std::string>>(), " ")));
    }
    return out;
}

std::string capture_text(Json const& c) {
    std::string out = fmt::format("{}  {}, {} frames at {} points{}\n", shown(c["file"]),
                                  size_text(c["file_octets"].get<double>()), c["frames"].get<std::uint64_t>(),
                                  c["points"].size(), c["complete"].get<bool>() ? "" : "; incomplete: it was cut");
    for (Json const& s : c["streams"]) {
        out += fmt::format("  {:<5} {:<32} {:>10} frames {:>9.6g} Hz  from {}{}\n", shown(s["kind"]), shown(s["id"]),
                           s["frames"].get<std::uint64_t>(), s["rate_hz"].get<double>(), shown(s["source"]),
                           s["lost"].get<std::uint64_t>() > 0 ? fmt::format(", {} lost", s["lost"].get<std::uint64_t>())
                                                              : "");
    }
    return out;
}

std::string run_text(Json const& j) {
    std::string out;
    auto const line = [&](char const* what, std::string const& text) {
        if (!text.empty()) {
            out += fmt::format("{:<12} {}\n", what, text);
        }
    };
    line("run", shown(j["folder"]));
    line("scenario", shown(j["scenario"]) + (shown(j["description"]).empty() ? "" : ": " + shown(j["description"])));
    line("sha256", shown(j["scenario_sha256"]));
    line("network", shown(j["network_sha256"]));
    line("started", shown(j["started"]));
    line("gridspace", shown(j["gridspace"]));
    line("clock", fmt::format("{}, tick {} s, step {} s, epoch {}, seed {}", shown(j["mode"]), shown(j["tick_s"]),
                              shown(j["step_s"]), shown(j["epoch"]), j["seed"].dump()));
    if (j["simulated_s"].is_number()) {
        line("duration",
             fmt::format("{} of {} simulated, in {} ({} overruns)", human_duration(j["simulated_s"].get<double>()),
                         human_duration(j["duration_s"].get<double>()), human_duration(j["wall_s"].get<double>()),
                         j["overruns"].dump()));
    } else {
        line("duration", fmt::format("{} planned", human_duration(j["duration_s"].get<double>())));
    }
    line("verdict", shown(j["verdict"]));
    Json const& e = j["expectations"];
    if (e["passed"].get<int>() + e["failed"].get<int>() + e["not_judged"].get<int>() > 0) {
        std::string const failures = printable(join(e["failures"].get<std::vector<std::string>>(), ", "));
        line("expected",
             fmt::format("{} held, {} did not{}{}", e["passed"].dump(), e["failed"].dump(),
                         failures.empty() ? "" : ": " + failures,
                         e["not_judged"].get<int>() > 0 ? fmt::format(", {} not judged", e["not_judged"].dump()) : ""));
    }
    std::string processes;
    for (Json const& p : j["processes"]) {
        std::string const end = printable(text_of(p, "end"));
        processes += fmt::format("{}{}", processes.empty() ? "" : ", ", shown(p["name"])) +
                     (p["exit"].is_number() && p["exit"].get<int>() != 0
                          ? fmt::format(" ({})", end.empty() ? "exit " + p["exit"].dump() : end)
                          : "");
    }
    line("processes", processes);
    return out;
}

/// What the manifest and the report's summary say of the run; parts of its folder are added.
Json run_json(fs::path const& run) {
    Json const manifest = read_json(run / "manifest.json"), summary = read_json(run / "report/summary.json");
    Json const clock = part_of(manifest, "clock"), files = part_of(manifest, "files"),
               build = part_of(manifest, "gridspace");
    std::error_code ignored;
    Json j{{"folder", fs::canonical(run, ignored).string()},
           {"scenario", text_of(manifest, "scenario")},
           {"description", text_of(manifest, "description")},
           {"scenario_sha256", text_of(part_of(files, "scenario"), "sha256")},
           {"network_sha256", text_of(part_of(files, "network"), "sha256")},
           {"started", text_of(manifest, "started")},
           {"gridspace",
            fmt::format("{} ({}, {})", text_of(build, "version"), text_of(build, "commit"), text_of(build, "build"))},
           {"seed", value_of(manifest, "seed", Json(nullptr))},
           {"mode", text_of(clock, "mode")},
           {"tick_s", text_of(clock, "tick_s")},
           {"step_s", text_of(clock, "step_s")},
           {"epoch", text_of(clock, "epoch")},
           {"duration_s", value_of(manifest, "duration_s", 0.0)},
           {"simulated_s", value_of(manifest, "simulated_s", Json(nullptr))},
           {"wall_s", value_of(manifest, "wall_s", 0.0)},
           {"overruns", value_of(manifest, "overruns", Json(nullptr))},
           {"exit", value_of(summary, "exit", value_of(manifest, "exit", Json(nullptr)))},
           {"verdict", verdict_of(manifest, summary)},
           {"expectations", expectations_json(summary)}};
    j["processes"] = Json::array();
    Json const processes = part_of(manifest, "processes");
    for (auto const& [name, process] : processes.items()) {
        j["processes"].push_back({{"name", name},
                                  {"program", text_of(process, "program")},
                                  {"host", text_of(process, "host")},
                                  {"exit", value_of(process, "exit", Json(nullptr))},
                                  {"end", text_of(process, "end")}});
    }
    return j;
}

} // namespace

Result<RunInfo> run_info(fs::path const& run) {
    std::error_code ignored;
    if (fs::is_regular_file(run, ignored)) { // a recording without its folder: times are since 1970
        auto recording = recording_json(run, 0);
        if (!recording) {
            return std::unexpected{recording.error()};
        }
        return RunInfo{recording_text(*recording),
                       Json{{"recording", *recording}}.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
    }
    if (!fs::exists(run / "manifest.json", ignored)) {
        return fail(ExitCode::usage, fmt::format("'{}' is not the folder of a run", run.string()),
                    "give one that `gridspace run` has written, its data.mcap, or latest");
    }
    Json j = run_json(run);
    std::string text = run_text(j);
    auto const add = [&](char const* key, char const* name, auto const& read, auto const& show) {
        j[key] = nullptr;
        if (!fs::exists(run / name, ignored)) {
            return;
        }
        auto const part = read(run / name);
        if (part) {
            j[key] = *part;
            text += "\n" + show(*part);
        } else { // the rest of the folder is worth showing
            j[key] = Json{{"file", name}, {"error", part.error().message}};
            text += fmt::format("\n{}: {}\n", name, printable(part.error().message));
        }
    };
    std::int64_t const epoch_ns = parse_utc(j["epoch"].get<std::string>()).value_or(0) * 1'000'000'000;
    add("recording", "data.mcap", [&](fs::path const& file) { return recording_json(file, epoch_ns); }, recording_text);
    add("capture", pcapng::capture_of_run(run).filename().c_str(), capture_json, capture_text);
    auto const [parts, total] = sizes(run);
    j["files"] = parts;
    j["octets"] = total;
    text += fmt::format("\n{} in all:", size_text(static_cast<double>(total)));
    for (auto const& [name, octets] : parts.items()) {
        text += fmt::format(" {} {}", printable(name), size_text(octets.get<double>()));
    }
    return RunInfo{text + "\n", j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n"};
}

} // namespace gridspace::launcher
