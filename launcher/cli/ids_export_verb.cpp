// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace ids export`: a labelled data set of run folders.
#include "launcher/cli/checks.hpp"
#include "launcher/cli/ids_verbs.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/progress_line.hpp"
#include "launcher/ids/export/data_set.hpp"
#include "launcher/sweep/study_folder.hpp"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

struct IdsExportArguments {
    std::vector<std::filesystem::path> runs;
    std::filesystem::path out;
    std::int64_t seed{1};
    bool json{false}, quiet{false};
};

/// What repeats it, in whatever folder: the name of the data set's own is no part of it.
std::string command_of(IdsExportArguments const& a) {
    std::string out = "gridspace ids export";
    for (auto const& run : a.runs) {
        out += ' ' + launcher::shell_word(run.string());
    }
    return out + fmt::format(" --seed {} --out DIR", a.seed);
}

int ids_export(IdsExportArguments const& a) {
    std::vector<std::filesystem::path> folders;
    for (auto const& run : a.runs) {
        folders.push_back(run_folder(run));
    }
    auto runs = dataset::find_runs(folders);
    if (!runs) {
        return print_error(runs.error());
    }
    for (dataset::RunSource const& run : *runs) {
        if (auto const closed = closed_run(run.folder); !closed) {
            return print_error(closed.error());
        }
    }
    ProgressLine shown{a.json || a.quiet};
    auto const data =
        dataset::write_data_set(std::move(*runs), {a.out, static_cast<std::uint64_t>(a.seed), command_of(a)},
                                [&](std::string const& run, std::uint64_t frames) {
                                    shown.show(fmt::format("{}: {} frames", run, frames), false);
                                });
    if (!data) {
        return print_error(data.error());
    }
    shown.show(fmt::format("{} runs", data->runs.size()), true);
    if (a.json) {
        nlohmann::ordered_json out{{"folder", a.out.string()},
                                   {"runs", nlohmann::ordered_json::array()},
                                   {"files", data->files},
                                   {"octets", data->octets}};
        for (dataset::DataSetRun const& run : data->runs) {
            out["runs"].push_back({{"run", run.source.id},
                                   {"grid", run.source.grid},
                                   {"attack_kinds", run.source.kinds()},
                                   {"split_by_grid", run.split_by_grid},
                                   {"split_by_attack", run.split_by_attack}});
        }
        fmt::print("{}\n", out.dump(2));
    } else if (!a.quiet) {
        fmt::print("{} runs, {} files, {:.1f} MB in {}: begin with README.md\n", data->runs.size(), data->files,
                   1e-6 * static_cast<double>(data->octets), a.out.string());
    }
    return 0;
}

} // namespace

void add_ids_export(Command ids, Action& action) {
    auto const a = std::make_shared<IdsExportArguments>();
    Command verb = ids.add_subcommand(
        "export", "a labelled data set of runs: captures, features, labels, parts for training and test");
    verb.add_option("RUN", a->runs, "a study of `gridspace sweep` (with --keep), a folder of runs, or runs").required();
    verb.add_option("--out", a->out, "folder of the data set; not there yet, or empty").required();
    verb.add_option("--seed", a->seed, "of the parts for training, validation and test").check(not_negative());
    verb.add_flag("--json", a->json, "what came of it, as JSON");
    verb.add_flag("--quiet", a->quiet, "nothing but errors");
    verb.callback([a, &action] { action = [a] { return ids_export(*a); }; });
}

} // namespace gridspace::cli
