// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/data_set.hpp"

#include "common/text.hpp"
#include "common/version.hpp"
#include "launcher/folder/sha256.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/ids/export/csv_file.hpp"
#include "launcher/ids/export/data_card.hpp"
#include "launcher/ids/export/splits.hpp"

#include <nlohmann/json.hpp>

namespace gridspace::dataset {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

Result<void> prepare(fs::path const& out) {
    std::error_code error;
    if (fs::exists(out, error) && (!fs::is_directory(out, error) || !fs::is_empty(out, error))) {
        return fail(ExitCode::usage, fmt::format("'{}' is there already", out.string()),
                    "name a folder that is not there yet, or is empty");
    }
    if (!fs::create_directories(out, error) && error) {
        return fail(ExitCode::environment, fmt::format("'{}' cannot be made: {}", out.string(), error.message()));
    }
    return {};
}

Result<void> copy_settings(RunSource const& run, fs::path const& to) {
    for (auto const& [from, name] :
         {std::pair{"scenario.resolved.yaml", "scenario.yaml"}, {"network.yaml", "network.yaml"}}) {
        std::error_code error;
        if (fs::exists(run.folder / from, error) && !fs::copy_file(run.folder / from, to / name, error)) {
            return fail(ExitCode::environment,
                        fmt::format("'{}' cannot be written: {}", (to / name).string(), error.message()));
        }
    }
    return {};
}

Result<void> write_labels(RunSource const& run, fs::path const& file) {
    CsvFile out{file, "target,index,phase,attack,kind,true_value,sent_value"};
    for (auto const& [target, labels] : run.labels.by_target()) {
        for (LabelTable::Label const& label : labels) {
            auto const& attack = run.labels.attacks()[label.attack];
            auto const config = std::find_if(run.attacks.begin(), run.attacks.end(),
                                             [&](auto const& a) { return a.name.name == attack.name; });
            bool const has_phases = config == run.attacks.end() || !config->goose;
            out.row("{},{},{},{},{},{},{}", target, label.index,
                    !has_phases         ? ""
                    : label.channel < 3 ? std::string(1, "abc"[label.channel])
                                        : "frame",
                    attack.name, attack.kind, shortest(label.true_value), shortest(label.sent_value));
        }
    }
    return out.close();
}

Result<void> write_runs(std::vector<DataSetRun> const& runs, fs::path const& file) {
    CsvFile out{file, "run,scenario,grid,seed,duration_s,frequency_hz,attack_kinds,split_by_grid,split_by_attack,"
                      "scenario_sha256,network_sha256,made_by,commit"};
    for (DataSetRun const& run : runs) {
        RunSource const& s = run.source;
        out.row("{},{},{},{},{},{},{},{},{},{},{},{},{}", cell(s.id), cell(s.scenario), cell(s.grid), s.seed,
                shortest(s.simulated_s), shortest(s.frequency_hz), join(s.kinds(), "+"), run.split_by_grid,
                run.split_by_attack, s.started_with, s.network_sha256, cell(s.version), cell(s.commit));
    }
    return out.close();
}

Result<void> write_attacks(std::vector<DataSetRun> const& runs, fs::path const& file) {
    CsvFile out{file,
                "run,attack,kind,target,by,place,from_s,until_s,labels,altered_frames,first_altered_s,last_altered_s"};
    for (DataSetRun const& run : runs) {
        for (attacker::AttackConfig const& attack : run.source.attacks) {
            std::string const name = attack.name.name;
            auto const& labelled = run.source.labels.attacks();
            auto const of =
                std::find_if(labelled.begin(), labelled.end(), [&](auto const& a) { return a.name == name; });
            auto const seen = run.exported.attacks.find(name);
            bool const is_seen = seen != run.exported.attacks.end();
            out.row("{},{},{},{},{},{},{},{},{},{},{},{}", cell(run.source.id), name, attacker::kind_name(attack),
                    attack.stream.empty() ? attack.topic.name : attack.stream.name, attack.by.name,
                    attack.place == attacker::AttackConfig::Place::between ? "between" : "second_publisher",
                    shortest(attack.from_s.to_double()), shortest(attack.until_s.to_double()),
                    of == labelled.end() ? 0 : of->labels, is_seen ? seen->second.altered_frames : 0,
                    is_seen ? seconds_text(seen->second.first_ns) : "",
                    is_seen ? seconds_text(seen->second.last_ns) : "");
        }
    }
    return out.close();
}

Result<void> write_captures(std::vector<DataSetRun> const& runs, fs::path const& file) {
    CsvFile out{file, "run,vantage,file,frames,altered_frames,samples,messages"};
    for (DataSetRun const& run : runs) {
        for (ExportedRun::Vantage const& v : run.exported.vantages) {
            out.row("{},{},{},{},{},{},{}", cell(run.source.id), cell(v.name),
                    cell(fmt::format("runs/{}/{}", run.source.id, v.file)), v.frames, v.altered, v.samples, v.messages);
        }
    }
    return out.close();
}

Result<void> write_manifest(DataSet& data, DataSetOptions const& options) {
    std::vector<fs::path> files;
    for (fs::recursive_directory_iterator at{options.out}, end; at != end; ++at) {
        if (at->is_regular_file()) {
            files.push_back(at->path());
        }
    }
    std::sort(files.begin(), files.end());
    Json list = Json::array();
    for (fs::path const& file : files) {
        std::uintmax_t const octets = fs::file_size(file);
        list.push_back({{"path", file.lexically_relative(options.out).generic_string()},
                        {"octets", octets},
                        {"sha256", launcher::sha256_of(file)}});
        data.octets += octets;
    }
    data.files = files.size();
    Json const manifest{{"gridspace_ids_data_set", 1},
                        {"licence", "CC-BY-4.0"},
                        {"version", version().version},
                        {"commit", version().commit},
                        {"seed", options.seed},
                        {"runs", data.runs.size()},
                        {"files", list}};
    return launcher::write_file(options.out / "manifest.json", manifest.dump(2) + "\n");
}

} // namespace

void assign_splits(std::vector<DataSetRun>& runs, std::uint64_t seed) {
    std::vector<std::vector<std::string>> grids, kinds;
    std::vector<std::string> ids, attacked_ids, healthy_ids;
    for (DataSetRun const& run : runs) {
        grids.push_back({run.source.grid + ' ' + run.source.network_sha256});
        ids.push_back(run.source.id);
        if (auto of_run = run.source.kinds(); of_run.empty()) {
            healthy_ids.push_back(run.source.id);
        } else {
            attacked_ids.push_back(run.source.id);
            kinds.push_back(std::move(of_run));
        }
    }
    auto const by_grid = split(grids, ids, seed), by_kind = split(kinds, attacked_ids, seed),
               healthy = split(std::vector<std::vector<std::string>>(healthy_ids.size()), healthy_ids, seed);
    std::size_t next_attacked = 0, next_healthy = 0;
    for (std::size_t i = 0; i < runs.size(); ++i) {
        runs[i].split_by_grid = by_grid[i];
        runs[i].split_by_attack = runs[i].source.kinds().empty() ? healthy[next_healthy++] : by_kind[next_attacked++];
    }
}

Result<DataSet> write_data_set(std::vector<RunSource> runs, DataSetOptions const& options,
                               std::function<void(std::string const&, std::uint64_t)> const& progress) {
    DataSet out;
    for (RunSource& run : runs) {
        if (auto ok = read_run(run); !ok) {
            return std::unexpected{ok.error()};
        }
        out.runs.push_back({std::move(run), {}, "", ""});
    }
    assign_splits(out.runs, options.seed);
    if (auto ok = prepare(options.out); !ok) {
        return std::unexpected{ok.error()};
    }
    for (DataSetRun& run : out.runs) {
        fs::path const folder = options.out / "runs" / run.source.id;
        std::error_code error;
        fs::create_directories(folder, error); // what went wrong shows at the first file
        auto exported = export_run(run.source, folder, [&](std::uint64_t frames) { progress(run.source.id, frames); });
        if (!exported) {
            return std::unexpected{exported.error()};
        }
        run.exported = std::move(*exported);
        for (auto const& ok : {copy_settings(run.source, folder), write_labels(run.source, folder / "labels.csv")}) {
            if (!ok) {
                return std::unexpected{ok.error()};
            }
        }
    }
    for (auto const& ok :
         {write_runs(out.runs, options.out / "runs.csv"), write_attacks(out.runs, options.out / "attacks.csv"),
          write_captures(out.runs, options.out / "captures.csv"),
          launcher::write_file(options.out / "README.md", data_card(out, options))}) {
        if (!ok) {
            return std::unexpected{ok.error()};
        }
    }
    if (auto ok = write_manifest(out, options); !ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

} // namespace gridspace::dataset
