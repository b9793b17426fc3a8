// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/folder/write_file.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/report/comtrade_output.hpp"
#include "launcher/report/figures.hpp"
#include "launcher/report/html_report.hpp"
#include "launcher/report/summary.hpp"
#include "launcher/run/run.hpp"
#include "launcher/run/say.hpp"

#include <csignal>
#include <fmt/format.h>
#include <fstream>
#include <memory>
#include <set>
#include <unistd.h>

namespace gridspace::cli {
namespace {

struct RunArguments {
    ScenarioArguments scenario;
    bool dry_run{false}, programs{false}, json{false}, quiet{false}, no_namespaces{false}, no_deadlines{false},
        allow_control{false};
    std::filesystem::path out, parent{"runs"}, junit;
    std::string log_level{"info"};
};

using namespace launcher;

/// The end of a process's log, which usually says more than its exit code.
std::string log_tail(std::filesystem::path const& file, std::size_t lines) {
    std::ifstream stream{file};
    std::vector<std::string> last;
    for (std::string line; std::getline(stream, line);) {
        last.push_back(std::move(line));
        if (last.size() > lines) {
            last.erase(last.begin());
        }
    }
    std::string out;
    for (std::string const& line : last) {
        out += "    " + line + "\n";
    }
    return out;
}

/// The cause comes first: what ended the run, and the log of the process that it names.
void print_cause(FinishedRun const& finished) {
    RunOutcome const& outcome = finished.outcome;
    if (outcome.exit_code == 0) {
        return;
    }
    say(stderr, "the run ended early: {}{}{}\n", outcome.cause, outcome.remedy.empty() ? "" : "; ", outcome.remedy);
    for (RunOutcome::ProcessEnd const& end : outcome.ends) {
        if (outcome.cause.find(end.process) != std::string::npos) {
            std::filesystem::path const log = finished.folder / "logs" / (end.process + ".log");
            if (std::string const tail = log_tail(log, 8); !tail.empty()) {
                say(stderr, "  {}:\n{}", log.string(), tail);
            }
        }
    }
}

bool lies_in(std::filesystem::path const& file, std::filesystem::path const& folder) {
    auto const plain = [](std::filesystem::path const& path) {
        return std::filesystem::absolute(path).lexically_normal();
    };
    std::filesystem::path const relative = folder.empty() ? folder : plain(file).lexically_relative(plain(folder));
    return !relative.empty() && *relative.begin() != "..";
}

/// Judges the run, writes its report and prints the results. What cannot be written is said after what is known: a full
/// disk keeps no result back.
int conclude(FinishedRun const& finished, RunArguments const& arguments) {
    bool const is_read = finished.unread.empty();
    if (is_read) {
        print_cause(finished);
    }
    auto results = read_results(finished.folder, &finished.outcome, unasked_figures);
    auto const print_late =
        [&] { // where nobody has read what was said so far, nothing more is said before the report is there
            if (!is_read) {
                say(stderr, "{}", finished.unread);
                print_cause(finished);
            }
        };
    if (!results) {
        print_late();
        int const code = print_error(results.error());
        return finished.outcome.exit_code != 0 ? finished.outcome.exit_code : code;
    }
    std::vector<Error> unwritten;
    if (finished.unwritten) {
        unwritten.push_back(*finished.unwritten);
    }
    if (auto const comtrade = write_comtrade_of_run(*results)) {
        for (std::filesystem::path const& file : comtrade->files) {
            results->comtrade.push_back(file.filename().string());
        }
        results->notes.insert(results->notes.end(), comtrade->notes.begin(), comtrade->notes.end());
    } else {
        unwritten.push_back(comtrade.error());
    }
    if (auto ok = write_summary(*results); !ok) {
        unwritten.push_back(ok.error());
    }
    auto const html = write_html_report(*results);
    if (!html) {
        unwritten.push_back(html.error());
    }
    if (!arguments.junit.empty()) {
        if (auto ok = write_file(arguments.junit, to_junit(*results)); !ok) {
            unwritten.push_back(ok.error());
        }
    }
    print_late();
    if (arguments.json) {
        say(stdout, "{}", summary_json(*results));
    } else if (!arguments.quiet) {
        say(stdout, "{}{}", to_text(*results, ::isatty(STDOUT_FILENO) != 0),
            html ? fmt::format("report: {}\n", html->string()) : "");
    }
    int code = results->exit_code();
    for (Error const& error : unwritten) {
        int const own = print_error(error);
        code = code == 0 ? own : code;
    }
    return code;
}

/// Programs of somebody else may need anything of ours: `programs`, the target that builds all.
std::string programs_of(Scenario const& scenario) {
    std::set<std::string> names;
    for (Process const& process : scenario.processes) {
        names.insert(process.is_foreign() ? "programs" : process.program.name);
    }
    return fmt::format("{}\n", fmt::join(names, "\n"));
}

int run(RunArguments const& arguments) {
    ScenarioArguments scenario_arguments = arguments.scenario;
    if (arguments.no_deadlines) {
        scenario_arguments.set.insert(scenario_arguments.set.end(),
                                      {"clock.member_timeout_s=0", "clock.start_timeout_s=0"});
    }
    auto const scenario = load(scenario_arguments);
    if (!scenario) {
        return static_cast<int>(ExitCode::usage);
    }
    if (arguments.programs) {
        fmt::print("{}", programs_of(*scenario));
        return 0;
    }
    if (arguments.dry_run) {
        if (auto ok = check_isolation(*scenario, !arguments.no_namespaces); !ok) {
            return print_error(ok.error());
        }
        PlanOptions options;
        options.folder = "RUN";
        options.namespaces = !arguments.no_namespaces;
        fmt::print("{}", to_text(make_plan(*scenario, options)));
        return 0;
    }
    RunOptions options;
    options.parent = arguments.parent;
    options.out = arguments.out;
    options.namespaces = !arguments.no_namespaces;
    options.log_level = arguments.log_level;
    options.allow_control = arguments.allow_control;
    options.allow_attacks_on = scenario->allow_attacks_on;
    options.style = arguments.quiet                ? Progress::Style::quiet
                    : arguments.json               ? Progress::Style::json
                    : ::isatty(STDERR_FILENO) != 0 ? Progress::Style::terminal
                                                   : Progress::Style::plain;
    if (!arguments.junit.empty() && !lies_in(arguments.junit, arguments.out)) { // the folder of --out is not there yet
        if (auto ok = check_writable(arguments.junit); !ok) {
            return print_error({ok.error().code, "--junit: " + ok.error().message, "nothing was started"});
        }
    }
    std::signal(SIGPIPE, SIG_IGN); // whoever reads what is printed may leave; the run and its report go on
    InterruptWatch interrupts;
    auto const finished = run_scenario(*scenario, options, interrupts);
    if (!finished) {
        return print_error(finished.error());
    }
    interrupts.let_finish();
    int const code = conclude(*finished, arguments);
    return interrupts.came_late() && finished->outcome.exit_code == 0 ? static_cast<int>(ExitCode::interrupted) : code;
}

} // namespace

void add_run(Command app, Action& action) {
    auto const a = std::make_shared<RunArguments>();
    Command verb = app.add_subcommand("run", "run a scenario: start, watch, record, judge, report");
    scenario_options(verb, a->scenario);
    verb.add_flag("--no-namespaces", a->no_namespaces, "everything on the loopback interface").group("Where it runs");
    verb.add_option("--out", a->out, "run folder (default: runs/<scenario>-<utc>)").group("What comes out");
    verb.add_option("--junit", a->junit, "write the expectations as JUnit XML").group("What comes out");
    verb.add_flag("--json", a->json, "progress as JSON lines, the summary as JSON").group("What comes out");
    verb.add_flag("--quiet", a->quiet, "print nothing but errors").group("What comes out");
    verb.add_flag("--dry-run", a->dry_run, "show what would be started; start nothing").group("Look into it");
    verb.add_flag("--programs", a->programs, "list the programs of Gridspace that it needs, a line each; start nothing")
        .group("Look into it");
    verb.add_flag("--allow-control", a->allow_control,
                  "pause, continue, step and stop it from the dashboard and the command line")
        .group("Look into it");
    verb.add_flag("--no-deadlines", a->no_deadlines, "wait for ever (a debugger is attached)").group("Look into it");
    verb.add_option("--log-level", a->log_level, "of the processes")
        .group("Look into it")
        .check(one_of({"debug", "info", "warning", "error"}));
    verb.callback([a, &action] { action = [a] { return run(*a); }; });
}

} // namespace gridspace::cli
