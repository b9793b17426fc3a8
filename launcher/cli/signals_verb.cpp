// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

struct SignalsArguments {
    ScenarioArguments scenario;
    bool json{false};
};

int signals(SignalsArguments const& arguments) {
    auto const scenario = load(arguments.scenario);
    if (!scenario) {
        return static_cast<int>(ExitCode::usage);
    }
    Json list = Json::array();
    for (launcher::Process const& process : scenario->processes) {
        for (launcher::SignalUse const& s : process.settings->signals(*scenario, process)) {
            if (arguments.json) {
                list.push_back(
                    {{"name", s.name}, {"unit", s.unit}, {"rate_hz", s.rate_hz}, {"process", process.name.name}});
            } else {
                fmt::print("{:<36} {:<8} {}\n", s.name, s.unit.empty() ? "-" : s.unit,
                           s.rate_hz > 0 ? fmt::format("{:.6g} Hz", s.rate_hz) : "on change");
            }
        }
    }
    if (arguments.json) {
        fmt::print("{}\n", list.dump(2));
    }
    return 0;
}

} // namespace

void add_signals(Command app, Action& action) {
    auto const a = std::make_shared<SignalsArguments>();
    Command verb = app.add_subcommand("signals", "list the signals of a scenario: name, unit, rate");
    scenario_options(verb, a->scenario);
    verb.add_flag("--json", a->json, "as JSON");
    verb.callback([a, &action] { action = [a] { return signals(*a); }; });
}

} // namespace gridspace::cli
