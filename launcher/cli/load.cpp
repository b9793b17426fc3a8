// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/load.hpp"

#include "launcher/run/closed_folder.hpp"
#include "launcher/run/say.hpp"

#include <fmt/format.h>

namespace gridspace::cli {

void scenario_options(Command verb, ScenarioArguments& a) {
    verb.add_option("SCENARIO", a.file, "scenario file (YAML)").required();
    verb.add_option("--set", a.set, "override a value: --set clock.tick_s=0.25 (may be repeated)")
        .repeated()
        .group("Change the scenario");
    verb.add_option("--speed", a.speed, "simulated seconds per second, or max").group("Change the scenario");
    verb.add_option("--until", a.until, "end at this simulated time: 10s, 5min, 2h").group("Change the scenario");
    verb.add_option("--seed", a.seed, "seed of everything random").group("Change the scenario");
    verb.add_option("--allow-attacks-on", a.allow_attacks_on,
                    "an interface that is not a virtual cable, for an attacker with `interface:`")
        .group("Where it runs");
}

std::unique_ptr<launcher::Scenario> load(ScenarioArguments const& arguments) {
    launcher::LoadOptions options;
    options.set = arguments.set;
    options.until = arguments.until;
    options.seed = arguments.seed;
    options.allow_attacks_on = arguments.allow_attacks_on;
    if (arguments.speed) {
        options.set.push_back("clock.speed=" + *arguments.speed);
    }
    config::Diagnostics diagnostics;
    auto scenario = launcher::load_scenario(arguments.file, options, diagnostics);
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        say(stderr, "{}{}\n", diagnostics.render(), scenario ? "" : "  Nothing was started.");
    }
    return scenario;
}

int print_error(Error const& error) {
    say(stderr, "error: {}{}{}\n", error.message, error.remedy.empty() ? "" : "\n  ", error.remedy);
    return static_cast<int>(error.code);
}

std::filesystem::path run_folder(std::filesystem::path const& written) {
    std::error_code ignored;
    if (!std::filesystem::exists(written / "manifest.json", ignored) &&
        std::filesystem::exists("runs" / written / "manifest.json", ignored)) {
        return "runs" / written;
    }
    return written;
}

Result<std::filesystem::path> closed_run(std::filesystem::path const& written) {
    std::filesystem::path folder = run_folder(written);
    std::error_code ignored;
    if (std::filesystem::is_directory(folder, ignored)) {
        if (auto ok = launcher::check_closed(folder); !ok) {
            return std::unexpected{ok.error()};
        }
    }
    return folder;
}

} // namespace gridspace::cli
