// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/run_source.hpp"

#include "common/config/yaml.hpp"
#include "common/json_value.hpp"
#include "common/time.hpp"
#include "launcher/folder/sha256.hpp"
#include "launcher/judge/intrusion_recording.hpp"
#include "launcher/judge/run_network.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <fmt/format.h>
#include <fstream>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::dataset {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

bool is_run(fs::path const& folder) {
    std::error_code ignored;
    return fs::is_regular_file(folder / "manifest.json", ignored);
}

std::vector<fs::path> folders_in(fs::path const& folder) {
    std::vector<fs::path> out;
    std::error_code error;
    for (fs::directory_iterator at{folder, error}, end; !error && at != end; at.increment(error)) {
        if (at->is_directory(error)) {
            out.push_back(at->path());
        }
    }
    std::sort(out.begin(), out.end());
    return out;
}

void add(std::vector<RunSource>& runs, std::string const& id, fs::path const& folder) {
    RunSource run;
    run.id = id;
    run.folder = folder;
    runs.push_back(std::move(run));
}

Result<void> add_study(fs::path const& study, std::vector<RunSource>& runs) {
    for (fs::path const& folder : folders_in(study / "runs")) {
        std::error_code ignored;
        if (is_run(folder / "run")) {
            add(runs, folder.filename().string(), folder / "run");
        } else if (fs::exists(folder / "record.json", ignored)) {
            return fail(
                ExitCode::usage,
                fmt::format("the study '{}' has not kept its run {}", study.string(), folder.filename().string()),
                "gridspace sweep STUDY --keep keeps the run folders");
        }
    }
    return {};
}

Result<void> add_named(fs::path const& named, std::vector<RunSource>& runs) {
    std::error_code ignored;
    if (!fs::is_directory(named, ignored)) {
        return fail(ExitCode::usage, fmt::format("there is no folder '{}'", named.string()),
                    "a study of gridspace sweep, a folder of runs, or a run");
    }
    std::size_t const before = runs.size();
    if (is_run(named)) {
        fs::path const whole = fs::canonical(named, ignored);
        bool const of_study = whole.filename() == "run" && fs::exists(whole.parent_path() / "record.json", ignored);
        add(runs, (of_study ? whole.parent_path() : whole).filename().string(), named);
    } else if (fs::exists(named / "study.lock", ignored)) {
        if (auto ok = add_study(named, runs); !ok) {
            return ok;
        }
    } else {
        for (fs::path const& folder : folders_in(named)) {
            if (is_run(folder)) {
                add(runs, folder.filename().string(), folder);
            }
        }
    }
    return runs.size() > before ? Result<void>{}
                                : fail(ExitCode::usage, fmt::format("there is no run in '{}'", named.string()),
                                       "a run folder holds manifest.json, data.mcap and bus.pcapng.gz");
}

std::unexpected<Error> refuse(RunSource const& run, std::string const& what, std::string const& remedy) {
    return fail(ExitCode::usage, fmt::format("run '{}': {}", run.folder.string(), what), remedy);
}

Result<void> read_manifest(RunSource& run) {
    std::ifstream stream{run.folder / "manifest.json"};
    Json const manifest = Json::parse(stream, nullptr, false);
    if (!manifest.is_object()) {
        return refuse(run, "manifest.json cannot be read", "run the scenario again");
    }
    Json const clock = part_of(manifest, "clock"), made_by = part_of(manifest, "gridspace"),
               network = part_of(part_of(manifest, "files"), "network");
    run.scenario = text_of(manifest, "scenario");
    run.seed = value_of(manifest, "seed", std::int64_t{0});
    run.simulated_s = value_of(manifest, "simulated_s", 0.0);
    run.lockstep = text_of(clock, "mode") == "lockstep";
    run.epoch_ns = parse_utc(text_of(clock, "epoch")).value_or(0) * 1'000'000'000;
    run.version = value_of(made_by, "version", std::string{"unknown"});
    run.commit = value_of(made_by, "commit", std::string{"unknown"});
    run.grid = fs::path{text_of(network, "path")}.stem().string();
    run.network_sha256 = text_of(network, "sha256");
    if (run.grid.empty()) {
        run.grid = "none";
    }
    // 1: an expectation was not met, which is about the grid and not about the recording
    int const exit = value_of(manifest, "exit", -1);
    if (exit != 0 && exit != 1) {
        return refuse(run, exit < 0 ? "it has not come to its end" : fmt::format("it ended early, with code {}", exit),
                      "run the scenario again, or leave it out");
    }
    return {};
}

Result<void> read_scenario(RunSource& run) {
    config::Diagnostics diagnostics;
    auto const file = run.folder / "scenario.resolved.yaml";
    auto const scenario = config::load_yaml(file, diagnostics);
    if (scenario) {
        if (config::Node const* const all = scenario->find("streams")) {
            run.streams = streams::read_streams(*all, diagnostics);
        }
        if (config::Node const* const all = scenario->find("attacks")) {
            config::Node attacks = config::Node::map(all->where);
            attacks.set("attacks", *all);
            config::read_fields(attacks, "", diagnostics,
                                [&](config::Fields& f) { attacker::describe_attacks(f, run.attacks); });
        }
        config::Node const* const processes = scenario->find("processes");
        for (auto const& entry : processes != nullptr ? processes->entries : std::vector<config::Node::Entry>{}) {
            if (config::Node const* const host = entry.value.find("host")) {
                run.host_of[entry.key] = host->text;
            }
        }
        run.started_with = launcher::sha256_of(file);
    }
    run.frequency_hz = launcher::frequency_of_run(run.folder);
    return diagnostics.ok() ? Result<void>{} : fail(ExitCode::usage, diagnostics.render());
}

Result<void> read_labels(RunSource& run) {
    auto const cut = launcher::read_attack_labels(run.folder / "data.mcap", [&](auto const& label) {
        run.labels.add(label.attack, label.kind, label.target,
                       {label.index, 0, label.channel, label.true_value, label.sent_value});
    });
    if (!cut) {
        return refuse(run, cut.error().message, "run the scenario again with record: {samples: all, frames: all}");
    }
    if (!cut->empty()) {
        return refuse(run, "its recording data.mcap is damaged: " + *cut, "run the scenario again");
    }
    run.labels.sort();
    for (attacker::AttackConfig const& attack : run.attacks) {
        auto const& labelled = run.labels.attacks();
        bool const has_labels = std::any_of(labelled.begin(), labelled.end(),
                                            [&](LabelTable::Attack const& a) { return a.name == attack.name.name; });
        if (!has_labels && attack.from_s.to_double() < run.simulated_s) {
            return refuse(
                run, fmt::format("the attack '{}' has no labels: nobody knows what it altered", attack.name.name),
                fmt::format("processes.{}.labels: attack_labels, and record: {{samples: all}}", attack.by.name));
        }
    }
    return {};
}

} // namespace

std::vector<std::string> RunSource::kinds() const {
    std::set<std::string> out;
    for (LabelTable::Attack const& attack : labels.attacks()) {
        out.insert(attack.kind);
    }
    return {out.begin(), out.end()};
}

Result<std::vector<RunSource>> find_runs(std::vector<fs::path> const& named) {
    std::vector<RunSource> out;
    for (fs::path const& name : named) {
        if (auto ok = add_named(name, out); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    std::stable_sort(out.begin(), out.end(), [](RunSource const& a, RunSource const& b) { return a.id < b.id; });
    for (std::size_t i = 1; i < out.size(); ++i) {
        if (out[i].id == out[i - 1].id) {
            return fail(ExitCode::usage,
                        fmt::format("two runs have the name '{}': '{}' and '{}'", out[i].id, out[i - 1].folder.string(),
                                    out[i].folder.string()),
                        "name each run once; rename one of two folders of the same name");
        }
    }
    return out;
}

Result<void> read_run(RunSource& run) {
    if (auto ok = read_manifest(run); !ok) {
        return ok;
    }
    if (auto ok = read_scenario(run); !ok) {
        return ok;
    }
    std::error_code ignored;
    if (!fs::is_regular_file(pcapng::capture_of_run(run.folder), ignored)) {
        return refuse(run, "it has no capture bus.pcapng.gz",
                      "run the scenario again with record: {samples: all, frames: all}");
    }
    return read_labels(run);
}

} // namespace gridspace::dataset
