// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/report/run_info.hpp"

#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

struct InfoArguments {
    std::filesystem::path run;
    bool json{false};
};

int info(InfoArguments const& arguments) {
    auto const folder = closed_run(arguments.run);
    if (!folder) {
        return print_error(folder.error());
    }
    auto const found = launcher::run_info(*folder);
    if (!found) {
        return print_error(found.error());
    }
    fmt::print("{}", arguments.json ? found->json : found->text);
    return 0;
}

} // namespace

void add_info(Command app, Action& action) {
    auto const a = std::make_shared<InfoArguments>();
    Command verb = app.add_subcommand("info", "what a run folder holds");
    verb.add_option("RUN", a->run, "run folder, its data.mcap, or latest").required();
    verb.add_flag("--json", a->json, "as JSON");
    verb.callback([a, &action] { action = [a] { return info(*a); }; });
}

} // namespace gridspace::cli
