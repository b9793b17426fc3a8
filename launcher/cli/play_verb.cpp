// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace play RUN: gridspace-player takes the place of this process.
#include "launcher/cli/become.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/play/play_options.hpp"

#include <fmt/format.h>
#include <memory>

namespace gridspace::cli {
namespace {

int play(play::PlayOptions options) {
    auto const run = closed_run(options.run);
    if (!run) {
        return print_error(run.error());
    }
    std::filesystem::path const& folder = *run;
    std::error_code ignored;
    bool const is_run = std::filesystem::is_directory(folder, ignored);
    if (!std::filesystem::exists(is_run ? folder / "data.mcap" : folder, ignored) && !options.no_samples) {
        return print_error({ExitCode::usage,
                            is_run ? fmt::format("the run '{}' has no data.mcap", folder.string())
                                   : fmt::format("there is no '{}'", folder.string()),
                            is_run ? "only a run that was recorded (program: gridspace-recorder) can be played"
                                   : "give a run folder, its data.mcap, or latest"});
    }
    options.run = folder;
    return become("gridspace-player", "player", to_words(options));
}

} // namespace

void add_play(Command app, Action& action) {
    Command verb =
        app.add_subcommand("play", "put a recorded run back onto the bus and the wire, or into the dashboard");
    auto const options = std::make_shared<play::PlayOptions>();
    add_options(verb, *options);
    auto const dashboard = std::make_shared<MonitorArguments>();
    auto const in_dashboard = std::make_shared<bool>(false);
    verb.add_flag("--dashboard", *in_dashboard, "only into the dashboard: nothing is sent (as gridspace monitor RUN)")
        .group("Dashboard");
    verb.add_option("--listen", dashboard->listen, "address and port of the dashboard (port 0: a free one)")
        .needs("--dashboard")
        .group("Dashboard");
    verb.final_callback([&action, options, dashboard, in_dashboard] {
        action = [options, dashboard, in_dashboard] {
            if (*in_dashboard) {
                dashboard->run = options->run;
                return monitor(*dashboard);
            }
            return play(*options);
        };
    });
}

} // namespace gridspace::cli
