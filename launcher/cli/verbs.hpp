// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

/// The verbs of `gridspace`, as functions that return an exit code. The command line is parsed in main.cpp.
namespace gridspace::cli {

struct ScenarioArguments {
    std::filesystem::path file;
    std::vector<std::string> set;
    std::optional<std::string> speed, until, seed;
    std::string allow_attacks_on;
};

struct RunArguments {
    ScenarioArguments scenario;
    bool dry_run{false}, json{false}, quiet{false}, no_namespaces{false}, no_deadlines{false}, allow_control{false};
    std::filesystem::path out, parent{"runs"}, junit;
    std::string log_level{"info"};
};
int run(RunArguments const& arguments);

struct ValidateArguments {
    std::vector<std::filesystem::path> files;
    std::vector<std::string> set;
    bool json{false};
};
int validate(ValidateArguments const& arguments);

int signals(ScenarioArguments const& arguments, bool json);

struct CompareArguments {
    std::filesystem::path a, b;
    double tolerance{0};
    std::vector<std::string> signals;
};
int compare(CompareArguments const& arguments);

struct PowerFlowArguments {
    std::filesystem::path network;
    bool json{false}, enforce_q_limits{false}, three_phase{false};
};
int powerflow(PowerFlowArguments const& arguments);

struct SimulateArguments {
    std::filesystem::path network, events, csv, comtrade;
    std::string solver{"emt"}, until{"1"}, step;
    bool fixed_step{false};
    std::vector<std::string> signals; ///< patterns; empty: the usual ones
    std::int64_t every{1};
    bool timing{false}, quiet{false}, list_signals{false};
};
int simulate(SimulateArguments const& arguments);

struct MonitorArguments {
    std::filesystem::path run{"latest"};
    std::optional<int> domain;                       ///< a DDS domain instead of a run
    std::vector<std::string> addresses{"127.0.0.1"}; ///< of this machine, where it joins the domain
    std::string listen{"127.0.0.1:0"};
    std::filesystem::path token_file, tls_cert, tls_key, idl;
};
int monitor(MonitorArguments const& arguments);

struct RouterArguments {
    std::filesystem::path config;
    bool check{false}, json{false};
};
int router(RouterArguments const& arguments);

int report(std::filesystem::path const& run, bool json);

int info(std::filesystem::path const& run, bool json);

struct ExportArguments {
    std::filesystem::path run, out;
    bool csv{false}, comtrade{false};
    std::string trigger; ///< comtrade: these override what the scenario says
    std::optional<double> before_ms, after_ms;
    std::vector<std::string> signals;
};
int export_run(ExportArguments const& arguments);

/// Writes configs/schema/*.json and docs/reference/config.md below `root`.
int schema(std::filesystem::path const& root);

int doctor(bool json);
int version(bool json);

} // namespace gridspace::cli
