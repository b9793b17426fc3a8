// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

namespace CLI { // NOLINT(readability-identifier-naming): the library's
class App;
}

/// The verbs of `gridspace`. Each is a file that adds it to the command line and holds what it does; main.cpp has the
/// table of them.
namespace gridspace::cli {

using Action = std::function<int()>; ///< what the command line asks for; returns the exit code

struct ScenarioArguments {
    std::filesystem::path file;
    std::vector<std::string> set;
    std::optional<std::string> speed, until, seed;
    std::string allow_attacks_on;
};
/// SCENARIO and the options that change it.
void scenario_options(CLI::App* verb, ScenarioArguments& arguments);

/// The dashboard of a finished run or of a domain; `play` shows it too.
struct MonitorArguments {
    std::filesystem::path run{"latest"};
    std::optional<int> domain;                       ///< a DDS domain instead of a run
    std::vector<std::string> addresses{"127.0.0.1"}; ///< of this machine, where it joins the domain
    std::string listen{"127.0.0.1:0"};
    std::filesystem::path token_file, tls_cert, tls_key, idl;
};
int monitor(MonitorArguments const& arguments);

void add_bundle(CLI::App& app, Action& action);
void add_certify(CLI::App& app, Action& action);
void add_compare(CLI::App& app, Action& action);
void add_completion(CLI::App& app, Action& action);
void add_control(CLI::App& app, Action& action); ///< pause, continue, step, stop
void add_doctor(CLI::App& app, Action& action);
void add_export(CLI::App& app, Action& action);
void add_fmu(CLI::App& app, Action& action);
void add_graph(CLI::App& app, Action& action);
void add_ids_evaluate(CLI::App& ids, Action& action);
void add_ids_study(CLI::App& ids, Action& action);
void add_ids_train(CLI::App& ids, Action& action);
void add_info(CLI::App& app, Action& action);
void add_keys(CLI::App& app, Action& action); ///< init, issue, revoke, list
void add_monitor(CLI::App& app, Action& action);
void add_new(CLI::App& app, Action& action); ///< agent, scenario, network
void add_play(CLI::App& app, Action& action);
void add_powerflow(CLI::App& app, Action& action);
void add_report(CLI::App& app, Action& action);
void add_router(CLI::App& app, Action& action);
void add_run(CLI::App& app, Action& action);
void add_schema(CLI::App& app, Action& action);
void add_scl(CLI::App& app, Action& action);
void add_signals(CLI::App& app, Action& action);
void add_simulate(CLI::App& app, Action& action);
void add_sweep(CLI::App& app, Action& action);
void add_sweep_task(CLI::App& app, Action& action);
void add_timebox(CLI::App& app, Action& action);
void add_topic(CLI::App& app, Action& action);
void add_types(CLI::App& app, Action& action); ///< structs of C for IDL
void add_validate(CLI::App& app, Action& action);
void add_wire(CLI::App& app, Action& action);

} // namespace gridspace::cli
