// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/report/figures.hpp"
#include "launcher/report/html_report.hpp"
#include "launcher/report/summary.hpp"

#include <fmt/format.h>
#include <memory>
#include <unistd.h>

namespace gridspace::cli {
namespace {

struct ReportArguments {
    std::filesystem::path run;
    bool json{false};
};

int report(ReportArguments const& arguments) {
    auto const folder = closed_run(arguments.run);
    if (!folder) {
        return print_error(folder.error());
    }
    auto const results = launcher::read_results(*folder, nullptr, launcher::unasked_figures);
    if (!results) {
        return print_error(results.error());
    }
    if (auto ok = write_summary(*results); !ok) {
        return print_error(ok.error());
    }
    auto const html = launcher::write_html_report(*results);
    if (!html) {
        return print_error(html.error());
    }
    if (arguments.json) {
        fmt::print("{}", summary_json(*results));
    } else {
        fmt::print("{}report: {}\n", to_text(*results, ::isatty(STDOUT_FILENO) != 0), html->string());
    }
    return results->exit_code();
}

} // namespace

void add_report(Command app, Action& action) {
    auto const a = std::make_shared<ReportArguments>();
    Command verb = app.add_subcommand("report", "judge a recorded run again and rewrite its report");
    verb.add_option("RUN", a->run, "run folder, or latest").required();
    verb.add_flag("--json", a->json, "the summary as JSON");
    verb.callback([a, &action] { action = [a] { return report(*a); }; });
}

} // namespace gridspace::cli
