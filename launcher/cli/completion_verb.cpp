// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/checks.hpp"
#include "launcher/cli/completion.hpp"
#include "launcher/cli/verbs.hpp"

#include <CLI/CLI.hpp>
#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

/// The verbs that were added to `app`, with their options: the completion scripts cannot forget one.
std::vector<VerbOptions> verbs_of(CLI::App const& app) {
    std::vector<VerbOptions> out;
    for (CLI::App const* verb : app.get_subcommands([](CLI::App const*) { return true; })) {
        VerbOptions entry{verb->get_name(), verb->get_description(), {}};
        for (CLI::Option const* option : verb->get_options()) {
            for (std::string const& name : option->get_lnames()) {
                entry.options.push_back("--" + name);
            }
        }
        out.push_back(std::move(entry));
    }
    return out;
}

} // namespace

void add_completion(Command app, Action& action) {
    auto const shell = std::make_shared<std::string>();
    Command verb = app.add_subcommand("completion", "print a completion script");
    verb.add_option("SHELL", *shell, "bash, zsh or fish").required().check(one_of({"bash", "zsh", "fish"}));
    verb.callback([shell, app, &action] {
        action = [shell, app] {
            fmt::print("{}", completion_script(*shell, verbs_of(app.library())));
            return 0;
        };
    });
}

} // namespace gridspace::cli
