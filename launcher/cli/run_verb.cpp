// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/report/comtrade_output.hpp"
#include "launcher/report/html_report.hpp"
#include "launcher/report/results.hpp"
#include "launcher/run/run.hpp"

#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace gridspace::cli {
namespace {

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

/// The cause comes first: what ended the run, and the log of whoever it names.
void print_cause(FinishedRun const& finished) {
    RunOutcome const& outcome = finished.outcome;
    if (outcome.exit_code == 0) {
        return;
    }
    fmt::print(stderr, "the run ended early: {}{}{}\n", outcome.cause, outcome.remedy.empty() ? "" : "; ", outcome.remedy);
    for (RunOutcome::ProcessEnd const& end : outcome.ends) {
        if (outcome.cause.find(end.process) != std::string::npos) {
            std::filesystem::path const log = finished.folder / "logs" / (end.process + ".log");
            if (std::string const tail = log_tail(log, 8); !tail.empty()) {
                fmt::print(stderr, "  {}:\n{}", log.string(), tail);
            }
        }
    }
}

} // namespace

int run(RunArguments const& arguments) {
    ScenarioArguments scenario_arguments = arguments.scenario;
    if (arguments.no_deadlines) {
        scenario_arguments.set.insert(scenario_arguments.set.end(), {"clock.member_timeout_s=0", "clock.start_timeout_s=0"});
    }
    auto const scenario = load(scenario_arguments);
    if (!scenario) {
        return static_cast<int>(ExitCode::usage);
    }
    if (arguments.dry_run) {
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
    auto const finished = run_scenario(*scenario, options);
    if (!finished) {
        return print_error(finished.error());
    }
    print_cause(*finished);
    auto results = read_results(finished->folder);
    if (!results) {
        return print_error(results.error());
    }
    auto const comtrade = write_comtrade_of_run(*results);
    if (!comtrade) {
        return print_error(comtrade.error());
    }
    for (std::filesystem::path const& file : comtrade->files) {
        results->comtrade.push_back(file.filename().string());
    }
    results->notes.insert(results->notes.end(), comtrade->notes.begin(), comtrade->notes.end());
    if (auto ok = write_summary(*results); !ok) {
        return print_error(ok.error());
    }
    auto const html = write_html_report(*results);
    if (!html) {
        return print_error(html.error());
    }
    if (!arguments.junit.empty()) {
        std::ofstream{arguments.junit} << to_junit(*results);
    }
    if (arguments.json) {
        std::ifstream summary{finished->folder / "report/summary.json"};
        fmt::print("{}", std::string{std::istreambuf_iterator<char>{summary}, {}});
    } else if (!arguments.quiet) {
        fmt::print("{}report: {}\n", to_text(*results, ::isatty(STDOUT_FILENO) != 0), html->string());
    }
    return results->exit_code();
}

} // namespace gridspace::cli
