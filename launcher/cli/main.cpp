// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace: the command line. Parses; the verbs do the work.
#include "common/exit_code.hpp"
#include "common/text.hpp"
#include "common/version.hpp"
#include "launcher/cli/help.hpp"
#include "launcher/cli/verb_groups.hpp"
#include "launcher/run/say.hpp"
#include "launcher/scenario/installation.hpp"

#include <CLI/CLI.hpp>
#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <unistd.h>
#include <vector>

namespace gridspace::cli {
namespace {

/// Adds all verbs. A verb that has no group yet gets that of its row.
void add_verbs(CLI::App& app, Action& action) {
    auto const has_none = [](CLI::App* verb) { return verb->get_group() == "Subcommands"; };
    for (VerbGroup const& group : verb_groups()) {
        for (auto* const add : group.add) {
            add(Command{app}, action);
        }
        for (CLI::App* const verb : app.get_subcommands(has_none)) {
            verb->group(group.title);
            for (CLI::App* const below : verb->get_subcommands(has_none)) {
                below->group("Verbs");
            }
        }
    }
}

int version(bool json) {
    Version const& v = gridspace::version();
    if (json) {
        fmt::print("{}\n",
                   nlohmann::ordered_json{
                       {"version", v.version}, {"commit", v.commit}, {"build", v.build_type}, {"compiler", v.compiler}}
                       .dump());
    } else {
        fmt::print("{}\n", version_text("gridspace"));
    }
    return 0;
}

/// What is said about a command line that cannot be read: the word that is no verb by its name, with those that are
/// near.
std::string mistake(CLI::App const* app, CLI::Error const& error) {
    CLI::App const* verb = app;
    std::string path = app->get_name();
    while (!verb->get_subcommands().empty()) {
        verb = verb->get_subcommands().front();
        path += " " + verb->get_name();
    }
    std::vector<std::string> verbs;
    for (CLI::App const* known : verb->get_subcommands([](CLI::App const* sub) { return !sub->get_group().empty(); })) {
        verbs.push_back(known->get_name());
    }
    std::vector<std::string> const rest = app->remaining(true);
    std::string const said =
        !verbs.empty() && !rest.empty() && !rest.front().starts_with("-")
            ? fmt::format("`{}` has no verb '{}'\n  {}", path, rest.front(), spelling_hint(rest.front(), verbs))
            : error.what();
    return fmt::format("error: {}\n  `{} --help` shows what there is\n", said, path);
}

int main_function(int argc, char** argv) {
    CLI::App app{"Gridspace: smart-grid co-simulation over DDS and IEC 61850", "gridspace"};
    app.require_subcommand(0, 1);
    app.formatter(help_formatter());
    app.set_help_all_flag("--help-all", "help of all verbs");
    bool show_version = false, version_json = false;
    app.add_flag("--version", show_version, "version of this build");
    app.add_flag("--json", version_json, "with --version: as JSON");
    Action action;
    add_verbs(app, action);
    app.footer("`gridspace VERB --help` shows the options of a verb, `gridspace --help-all` those of all.");
    app.failure_message(mistake);
    try {
        app.parse(argc, argv);
    } catch (CLI::ParseError const& e) {
        return app.exit(e) == 0 ? 0 : static_cast<int>(ExitCode::usage);
    }
    if (show_version) {
        return version(version_json);
    }
    if (!action) {
        fmt::print(stderr, "{}", first_help());
        return static_cast<int>(ExitCode::usage);
    }
    launcher::offer_agent_libraries();
    return action();
}

/// `2>&-`: what is opened first must not get the number of a standard stream, and its prints with it. Where there is no
/// standard output, printing is to fail.
void open_standard_descriptors() {
    for (int const fd : {STDIN_FILENO, STDOUT_FILENO, STDERR_FILENO}) {
        if (::fcntl(fd, F_GETFD) < 0) {
            (void)::open("/dev/null", fd == STDOUT_FILENO ? O_RDONLY : O_RDWR); // gets the lowest number that is free
        }
    }
}

/// What was printed must have arrived: a full disk is no success.
int check_output(int code) {
    errno = 0;
    if (std::fflush(stdout) == 0 && std::ferror(stdout) == 0) {
        return code;
    }
    say(stderr, "error: standard output cannot be written{}{}\n", errno == 0 ? "" : ": ",
        errno == 0 ? "" : std::strerror(errno));
    return code == 0 ? static_cast<int>(ExitCode::environment) : code;
}

} // namespace
} // namespace gridspace::cli

int main(int argc, char** argv) {
    gridspace::cli::open_standard_descriptors();
    int code = static_cast<int>(gridspace::ExitCode::environment);
    try {
        code = gridspace::cli::main_function(argc, argv);
    } catch (std::exception const& e) {
        gridspace::say(stderr, "error: {}\n", e.what());
    }
    return gridspace::cli::check_output(code);
}
