// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace certify`: seeded faults against the relay of a scenario.
#include "common/config/merge.hpp"
#include "launcher/certify/worst_runs.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/sweep_progress.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/sweep/run_pool.hpp"

#include <algorithm>
#include <csignal>
#include <memory>

namespace gridspace::cli {
namespace {

using namespace launcher;

struct CertifyArguments {
    std::filesystem::path file, out;
    std::size_t jobs{0};
    std::int64_t samples{0};
    std::vector<std::string> set;
    bool dry_run{false}, keep{false}, json{false}, quiet{false};
};

void print_certificate(CertifyCase const& all, std::vector<GroupResult> const& groups, Certificate const& c,
                       std::filesystem::path const& page) {
    auto const line = [&](char const* name, Proportion const& p) {
        if (p.of > 0) {
            say(stdout, "  {:<14} {} of {}, {:.2f} % ({:.2f} to {:.2f} % at {:g} %, Clopper-Pearson)\n", name,
                p.successes, p.of, 100 * p.estimate, 100 * p.low, 100 * p.high, 100 * all.confidence);
        }
    };
    say(stdout, "{}: {}\n", all.name, c.is_passed() ? "every criterion is met" : "not passed");
    line("dependability", c.dependability);
    line("security", c.security);
    if (!c.trip_ms.empty()) {
        say(stdout, "  {:<14} mean {:.2f} +- {:.2f} ms, median {:.2f}, 95 % {:.2f}, slowest {:.2f}\n", "trip time",
            c.mean_ms, c.deviation_ms, c.median_ms, c.p95_ms, c.trip_ms.back());
    }
    for (Judged const& j : c.criteria) {
        say(stdout, "  {} {}: {}, asked {:.6g}\n", j.met ? "met    " : "NOT MET", j.name,
            j.value ? fmt::format("{:.6g}", *j.value) : "nothing to count", j.limit);
    }
    if (c.inconclusive + c.open > 0) {
        say(stdout, "  {} runs ended early, {} were not done\n", c.inconclusive, c.open);
    }
    double wall_s = 0, runs = 0;
    for (GroupResult const& group : groups) {
        wall_s += group.finished.wall_s;
        runs += static_cast<double>(group.finished.records.size() - group.finished.found);
    }
    if (runs > 0) {
        say(stdout, "  {:<14} {:g} in {}: {:.0f} faults an hour\n", "runs", runs, human_duration(wall_s),
            3600 * runs / std::max(wall_s, 1e-3));
    }
    if (!c.worst.empty()) {
        WorstFault const& w = c.worst.front();
        say(stdout, "worst: {}, run {}: {}\n  {}\n  again: {}\n  kept:  {}\n", groups[w.group].group.name.name,
            w.run + 1, w.why, describe(groups[w.group].study, groups[w.group].plan.runs[w.run]), w.command,
            w.folder.string());
    }
    say(stdout, "page: {}\n", page.string());
}

/// What `--set` says, for all groups.
void apply_settings(std::vector<std::string> const& settings, CertifyCase& all, config::Diagnostics& diagnostics) {
    for (std::size_t i = 0; i < settings.size(); ++i) {
        std::size_t const equals = settings[i].find('=');
        config::Node value = config::Node::map();
        std::string const path = settings[i].substr(0, equals);
        config::apply_set(value, equals == std::string::npos ? path : "value" + settings[i].substr(equals),
                          static_cast<int>(i + 1), diagnostics);
        if (config::Node const* const said = value.find("value")) {
            all.set = all.set.is_null() ? config::Node::map(said->where) : all.set;
            all.set.set(path, *said);
        }
    }
}

/// The runs of all groups that are not there yet. What ends the whole is an exit code.
int run_groups(CertifyArguments const& a, std::filesystem::path const& root, std::vector<PlannedGroup>&& planned,
               InterruptWatch& interrupts, std::vector<GroupResult>& groups) {
    for (PlannedGroup& group : planned) {
        SweepOptions options;
        options.out = root / group.group.name.name;
        options.jobs = a.jobs > 0 ? a.jobs : group.plan.lockstep ? usable_processors().size() : 1;
        options.keep = a.keep || !group.plan.lockstep; // a run in real time cannot be repeated
        SweepProgressLine line{group.study.name, a.quiet || a.json};
        SweepListener const listener{[&](SweepProgress const& at, bool last) { line.show(at, last); },
                                     [&](std::string_view text) { line.note(text); }};
        auto finished = sweep(group.study, group.plan, options, listener, interrupts);
        if (!finished) {
            return print_error(finished.error());
        }
        bool const stops = finished->is_interrupted || finished->stopped.has_value();
        int const code = finished->stopped ? print_error(*finished->stopped) : finished->exit_code();
        groups.push_back({std::move(group.group), std::move(group.study), std::move(group.plan), std::move(*finished)});
        if (stops) {
            say(stderr, "the same command goes on where it stopped\n");
            return code;
        }
    }
    return 0;
}

/// The certificate of finished groups; its worst faults are kept.
int conclude(CertifyArguments const& a, CertifyCase const& all, std::filesystem::path const& root,
             std::vector<GroupResult>& groups, InterruptWatch& interrupts) {
    Certificate const certificate = make_certificate(all, groups);
    if (auto ok = keep_worst(groups, certificate, a.jobs > 0 ? a.jobs : usable_processors().size(), interrupts); !ok) {
        return print_error(ok.error());
    }
    std::string const json = certificate_json(all, groups, certificate);
    for (auto const& [name, text] :
         {std::pair{"certificate.json", json}, {"index.html", certificate_page(all, groups, certificate)}}) {
        if (auto ok = replace_file(root / name, text); !ok) {
            return print_error(ok.error());
        }
    }
    if (a.json) {
        say(stdout, "{}", json);
    } else if (!a.quiet) {
        print_certificate(all, groups, certificate, root / "index.html");
    }
    int ended_early = 0;
    for (GroupResult const& group : groups) {
        ended_early = std::max(ended_early, group.finished.exit_code());
    }
    return ended_early > 1 ? ended_early : certificate.is_passed() ? 0 : static_cast<int>(ExitCode::expectation_failed);
}

int certify_verb(CertifyArguments const& a) {
    config::Diagnostics diagnostics;
    auto all = load_certify_case(a.file, diagnostics);
    if (all) {
        apply_settings(a.set, *all, diagnostics);
    }
    auto planned = all && diagnostics.ok() ? plan_case(*all, a.samples, diagnostics) : std::nullopt;
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        say(stderr, "{}{}\n", diagnostics.render(), planned ? "" : "  Nothing was started.");
    }
    if (!planned) {
        return static_cast<int>(ExitCode::usage);
    }
    if (a.dry_run) {
        for (PlannedGroup const& group : *planned) {
            say(stdout, "{}: must {}, {} runs\n", group.group.name.name, group.group.must_trip ? "trip" : "stay",
                group.plan.runs.size());
        }
        return 0;
    }
    auto const root =
        std::filesystem::absolute(a.out.empty() ? std::filesystem::path{"runs"} / ("certify-" + all->name) : a.out)
            .lexically_normal();
    std::signal(SIGPIPE, SIG_IGN); // whoever reads what is printed may leave; the runs go on
    InterruptWatch interrupts;
    std::vector<GroupResult> groups;
    int const stopped = run_groups(a, root, std::move(*planned), interrupts, groups);
    return stopped != 0 ? stopped : conclude(a, *all, root, groups, interrupts);
}

} // namespace

void add_certify(Command app, Action& action) {
    auto const a = std::make_shared<CertifyArguments>();
    Command verb = app.add_subcommand("certify", "seeded faults against a relay: trip times, dependability, security");
    verb.add_option("CASE", a->file, "case file (YAML)").required();
    verb.add_option("--jobs", a->jobs, "runs at once (default: as many as processors; 1 in real time)")
        .check(in_range(1, 1024));
    verb.add_option("--samples", a->samples, "faults of each group, instead of what the file says")
        .check(in_range(1, 100'000));
    verb.add_option("--set", a->set, "override a value of the scenario in all runs: --set simulation.duration_s=0.3")
        .repeated();
    verb.add_option("--out", a->out, "folder (default: runs/certify-<name>)");
    verb.add_flag("--dry-run", a->dry_run, "check the case and say what would be run; start nothing");
    verb.add_flag("--keep", a->keep, "keep the folders of runs that passed, too");
    verb.add_flag("--json", a->json, "the certificate as JSON");
    verb.add_flag("--quiet", a->quiet, "print nothing but errors");
    verb.callback([a, &action] { action = [a] { return certify_verb(*a); }; });
}

} // namespace gridspace::cli
