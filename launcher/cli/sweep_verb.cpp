// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace sweep`: a scenario many times.
#include "common/time.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/ids_verbs.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/sweep_progress.hpp"
#include "launcher/run/say.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/sweep/run_pool.hpp"
#include "launcher/sweep/slurm.hpp"
#include "launcher/sweep/sweep.hpp"

#include <algorithm>
#include <csignal>
#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>
#include <unistd.h>

namespace gridspace::cli {
namespace {

using namespace launcher;
using Json = nlohmann::ordered_json;

constexpr std::size_t kShownPoints = 20, kShownFailures = 5;

struct SweepArguments {
    std::filesystem::path study, out;
    std::size_t jobs{0};
    bool slurm{false}, dry_run{false}, resume{false}, keep{false}, json{false}, quiet{false};
};

std::string plural(std::size_t count, std::string_view what) {
    return fmt::format("{} {}{}", count, what, count == 1 ? "" : "s");
}

int dry_run(Study const& study, StudyPlan const& plan, StudyFolder const& folder) {
    auto const records = read_records(plan, folder);
    auto const there = std::count_if(records.begin(), records.end(), [](auto const& r) { return r && r->is_final(); });
    fmt::print("study {}: {} of {}{}{}\n", study.name, plural(plan.runs.size(), "run"), plan.scenario,
               plan.left_out > 0 ? fmt::format(", {} left out by `where`", plural(plan.left_out, "point")) : "",
               there > 0 ? fmt::format(", {} there already in {}", there, folder.root.string()) : "");
    for (std::size_t i = 0; i < std::min(plan.runs.size(), kShownPoints); ++i) {
        fmt::print("  {:>6}  {}  {}{}\n", i + 1, plan.runs[i].key, describe(study, plan.runs[i]),
                   records[i] && records[i]->is_final() ? fmt::format("  ({})", records[i]->state()) : "");
    }
    if (plan.runs.size() > kShownPoints) {
        fmt::print("  … and {} more\n", plan.runs.size() - kShownPoints);
    }
    return 0;
}

void print_failures(Study const& study, StudyPlan const& plan, FinishedSweep const& finished) {
    std::size_t shown = 0, all = 0;
    for (std::size_t i = 0; i < plan.runs.size(); ++i) {
        auto const& record = finished.records[i];
        if (!record || record->exit == 0) {
            continue;
        }
        if (++all <= kShownFailures) {
            say(stdout, "  run {} {}: {}\n    {}\n    again: {}\n", i + 1, record->exit == 1 ? "failed" : "ended early",
                record->cause, describe(study, plan.runs[i]), finished.folder.command(plan.runs[i].key));
            ++shown;
        }
    }
    if (all > shown) {
        say(stdout, "  … and {} more\n", all - shown);
    }
}

void print_result(SweepArguments const& arguments, Study const& study, StudyPlan const& plan,
                  FinishedSweep const& finished) {
    std::filesystem::path const& root = finished.folder.root;
    if (arguments.json) {
        say(stdout, "{}\n",
            Json{{"study", study.name},
                 {"folder", root.string()},
                 {"runs", plan.runs.size()},
                 {"there_already", finished.found},
                 {"passed", finished.count("passed")},
                 {"failed", finished.count("failed")},
                 {"ended_early", finished.count("ended_early")},
                 {"open", finished.count("open")},
                 {"wall_s", finished.wall_s},
                 {"csv", (root / "results.csv").string()},
                 {"sqlite", (root / "results.sqlite").string()},
                 {"page", (root / "index.html").string()}}
                .dump(2, ' ', false, Json::error_handler_t::replace));
        return;
    }
    if (arguments.quiet) {
        return;
    }
    std::string text =
        fmt::format("{}: {} of {} passed", study.name, finished.count("passed"), plural(plan.runs.size(), "run"));
    for (auto const& [state, what] :
         {std::pair{"failed", "failed"}, {"ended_early", "ended early"}, {"open", "not done"}}) {
        text += finished.count(state) > 0 ? fmt::format(", {} {}", finished.count(state), what) : "";
    }
    say(stdout, "{} in {}{}\n", text, human_duration(finished.wall_s),
        finished.found > 0 ? fmt::format(" ({} there already)", finished.found) : "");
    print_failures(study, plan, finished);
    say(stdout, "page:  {}\ntable: {} and .sqlite\n", (root / "index.html").string(), (root / "results.csv").string());
}

struct TaskArguments {
    std::filesystem::path folder;
    std::size_t task{1}, of{1};
    bool keep{false};
};

int sweep_task(TaskArguments const& arguments) {
    InterruptWatch interrupts;
    auto const ok = do_task({std::filesystem::absolute(arguments.folder).lexically_normal()}, arguments.task,
                            arguments.of, arguments.keep, interrupts);
    return ok ? 0 : print_error(ok.error());
}

int sweep_verb(SweepArguments const& arguments) {
    config::Diagnostics diagnostics;
    std::optional<Study> const study = load_study(arguments.study, diagnostics);
    std::optional<StudyPlan> const plan = study ? plan_study(*study, diagnostics) : std::nullopt;
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        say(stderr, "{}{}\n", diagnostics.render(), plan ? "" : "  Nothing was started.");
    }
    if (!plan) {
        return static_cast<int>(ExitCode::usage);
    }
    SweepProgressLine line{study->name, arguments.quiet || arguments.json};
    SweepOptions options;
    options.out = arguments.out.empty() ? std::filesystem::path{"runs"} / ("study-" + study->name) : arguments.out;
    options.jobs = arguments.jobs > 0 ? arguments.jobs : plan->lockstep ? usable_processors().size() : 1;
    if (arguments.slurm) {
        options.slurm = true;
        options.jobs = arguments.jobs;
    }
    options.keep = arguments.keep;
    options.resume = arguments.resume;
    if (arguments.dry_run) {
        return dry_run(*study, *plan, {std::filesystem::absolute(options.out).lexically_normal()});
    }
    if (!plan->lockstep && !options.slurm && options.jobs > 1) {
        line.note("note: the scenario runs in real time, and runs that go on at once disturb each other: --jobs 1");
    }
    std::signal(SIGPIPE, SIG_IGN); // whoever reads what is printed may leave; the runs go on
    InterruptWatch interrupts;
    SweepListener const listener{[&](SweepProgress const& at, bool last) { line.show(at, last); },
                                 [&](std::string_view text) { line.note(text); }};
    auto const finished = sweep(*study, *plan, options, listener, interrupts);
    if (!finished) {
        return print_error(finished.error());
    }
    print_result(arguments, *study, *plan, *finished);
    if (finished->stopped) {
        return print_error(*finished->stopped);
    }
    if (finished->is_interrupted) {
        line.note("interrupted; the same command goes on where it stopped");
    }
    return finished->exit_code();
}

void sweep_options(Command verb, std::shared_ptr<SweepArguments> const& a, Action& action) {
    verb.add_option("--jobs", a->jobs, "runs at once (default: as many as processors; 1 in real time)")
        .check(in_range(1, 1024));
    verb.add_flag("--slurm", a->slurm, "as job arrays of Slurm; --jobs: tasks at once (default: as many as it likes)");
    verb.add_option("--out", a->out, "folder of the study (default: runs/study-<name>)");
    verb.add_flag("--dry-run", a->dry_run, "show the runs; start nothing");
    verb.add_flag("--resume", a->resume, "go on; an error where nothing was begun");
    verb.add_flag("--keep", a->keep, "keep the folders of runs that passed, too");
    verb.add_flag("--json", a->json, "what came of it as JSON");
    verb.add_flag("--quiet", a->quiet, "print nothing but errors");
    verb.callback([a, &action] { action = [a] { return sweep_verb(*a); }; });
}

} // namespace

void add_sweep(Command app, Action& action) {
    auto const a = std::make_shared<SweepArguments>();
    Command verb = app.add_subcommand("sweep", "run a scenario many times: a study of what varies, with one table");
    verb.add_option("STUDY", a->study, "study file (YAML)").required();
    sweep_options(verb, a, action);
}

/// A detector's thresholds, attacks and grids are what a study varies: the same verb, and a study to begin with.
void add_ids_sweep(Command ids, Action& action) {
    auto const a = std::make_shared<SweepArguments>();
    Command verb =
        ids.add_subcommand("sweep", "thresholds by sizes of an attack by grids: `gridspace sweep` of a study");
    a->study = launcher::shared_folder("configs") / "studies/ids_thresholds.yaml";
    verb.add_option("STUDY", a->study, "study file (default: configs/studies/ids_thresholds.yaml)");
    sweep_options(verb, a, action);
}

void add_sweep_task(Command app, Action& action) {
    auto const a = std::make_shared<TaskArguments>();
    Command verb = app.add_subcommand("sweep-task", "one task of a job array of `sweep --slurm`");
    verb.add_option("FOLDER", a->folder, "folder of the study").required();
    verb.add_option("--task", a->task, "which task").required().check(in_range(1, 1'000'000));
    verb.add_option("--of", a->of, "how many tasks there are").required().check(in_range(1, 1'000'000));
    verb.add_flag("--keep", a->keep, "keep the folders of runs that passed, too");
    verb.hide(); // for the scripts that it makes
    verb.callback([a, &action] { action = [a] { return sweep_task(*a); }; });
}

} // namespace gridspace::cli
