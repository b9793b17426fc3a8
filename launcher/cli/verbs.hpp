// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/command_line/command.hpp"

#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

/// The verbs of `gridspace`. Each is a file that adds it to the command line and holds what it does; all_verbs.cpp has
/// the table of them.
namespace gridspace::cli {

using command_line::Command;
using command_line::Option;
using Action = std::function<int()>; ///< what the command line asks for; returns the exit code

struct ScenarioArguments {
    std::filesystem::path file;
    std::vector<std::string> set;
    std::optional<std::string> speed, until, seed;
    std::string allow_attacks_on;
};
/// SCENARIO and the options that change it.
void scenario_options(Command verb, ScenarioArguments& arguments);

/// The dashboard of a finished run or of a domain; `play` shows it too.
struct MonitorArguments {
    std::filesystem::path run{"latest"};
    std::optional<int> domain;                       ///< a DDS domain instead of a run
    std::vector<std::string> addresses{"127.0.0.1"}; ///< of this machine, where it joins the domain
    std::string listen{"127.0.0.1:0"};
    std::filesystem::path token_file, tls_cert, tls_key, idl;
};
int monitor(MonitorArguments const& arguments);

void add_bundle(Command app, Action& action);
void add_certify(Command app, Action& action);
void add_compare(Command app, Action& action);
void add_completion(Command app, Action& action);
void add_control(Command app, Action& action); ///< pause, continue, step, stop
void add_doctor(Command app, Action& action);
void add_export(Command app, Action& action);
void add_fmu(Command app, Action& action);
void add_fmu_export(Command fmu, Action& action);
void add_graph(Command app, Action& action);
void add_ids_evaluate(Command ids, Action& action);
void add_ids_study(Command ids, Action& action);
void add_ids_train(Command ids, Action& action);
void add_info(Command app, Action& action);
void add_keys(Command app, Action& action); ///< init, issue, revoke, list
void add_monitor(Command app, Action& action);
void add_new(Command app, Action& action); ///< agent, scenario, network
void add_play(Command app, Action& action);
void add_powerflow(Command app, Action& action);
void add_report(Command app, Action& action);
void add_router(Command app, Action& action);
void add_run(Command app, Action& action);
void add_schema(Command app, Action& action);
void add_scl(Command app, Action& action);
void add_signals(Command app, Action& action);
void add_simulate(Command app, Action& action);
void add_sweep(Command app, Action& action);
void add_sweep_task(Command app, Action& action);
void add_timebox(Command app, Action& action);
void add_topic(Command app, Action& action);
void add_types(Command app, Action& action); ///< structs of C for IDL
void add_validate(Command app, Action& action);
void add_wire(Command app, Action& action);

} // namespace gridspace::cli
