// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/yaml.hpp"
#include "launcher/certify/certify_case.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/sweep/study_plan.hpp"
#include "sim/network/network_config.hpp"
#include "sim/powerflow/power_flow.hpp"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

struct ValidateArguments {
    std::vector<std::filesystem::path> files;
    std::vector<std::string> set;
    std::string format{"text"}; ///< or json
};

Json to_json(config::Diagnostics const& diagnostics) {
    Json out = Json::array();
    for (config::Diagnostic const& d : diagnostics.sorted()) {
        out.push_back({{"severity", d.severity == config::Severity::error ? "error" : "warning"},
                       {"file", d.where.source == nullptr ? "" : d.where.source->name},
                       {"line", d.where.line},
                       {"column", d.where.column},
                       {"message", d.message},
                       {"hint", d.hint}});
    }
    return out;
}

int validate(ValidateArguments const& arguments) {
    bool all_valid = true;
    bool const as_json = arguments.format == "json";
    Json json = Json::array();
    for (std::filesystem::path const& file : arguments.files) {
        config::Diagnostics diagnostics;
        // A network file is told by its own version key.
        config::Diagnostics probe;
        auto const root = file.extension() == ".m" ? std::nullopt : config::load_yaml(file, probe);
        bool const is_network = file.extension() == ".m" || (root && root->find("gridspace_network") != nullptr);
        bool const is_study = root && root->find("gridspace_study") != nullptr;
        bool const is_case = root && root->find("gridspace_certify") != nullptr;
        std::string const kind = is_network ? "network" : is_study ? "study" : is_case ? "case" : "scenario";
        std::string summary;
        if (is_study) {
            auto const study = launcher::load_study(file, diagnostics);
            if (auto const plan = study ? launcher::plan_study(*study, diagnostics) : std::nullopt) {
                summary = fmt::format("{} runs of {}", plan->runs.size(), plan->scenario);
            }
        } else if (is_case) {
            auto const all = launcher::load_certify_case(file, diagnostics);
            if (auto const groups = all ? launcher::plan_case(*all, 0, diagnostics) : std::nullopt) {
                summary = fmt::format("{} groups of faults", groups->size());
            }
        } else if (is_network) {
            if (auto const network = sim::load_network(file, diagnostics)) {
                auto const flow = solve_power_flow(*network, sim::SwitchState{*network});
                if (!flow) {
                    diagnostics.error(network->where, flow.error().message, flow.error().remedy);
                } else {
                    summary = fmt::format("{} buses", network->buses.size());
                }
            }
        } else if (auto const scenario = launcher::load_scenario(file, {.set = arguments.set}, diagnostics)) {
            summary = fmt::format("{} processes on {} hosts", scenario->processes.size(), scenario->hosts.size());
        }
        all_valid = all_valid && diagnostics.ok();
        if (as_json) {
            json.push_back({{"file", file.string()},
                            {"kind", kind},
                            {"valid", diagnostics.ok()},
                            {"diagnostics", to_json(diagnostics)}});
            continue;
        }
        if (diagnostics.errors() + diagnostics.warnings() > 0) {
            fmt::print(stderr, "{}\n", diagnostics.render());
        }
        if (diagnostics.ok()) {
            fmt::print("{}: valid {}, {}\n", file.string(), kind, summary);
        }
    }
    if (as_json) {
        fmt::print("{}\n", json.dump(2));
    }
    return all_valid ? 0 : static_cast<int>(ExitCode::usage);
}

} // namespace

void add_validate(Command app, Action& action) {
    auto const a = std::make_shared<ValidateArguments>();
    Command verb = app.add_subcommand("validate", "check scenario, network and study files and cases; start nothing");
    verb.add_option("FILE", a->files, "scenario, network (YAML or MATPOWER), study or case").required();
    verb.add_option("--set", a->set, "override a value of a scenario: --set clock.tick_s=0.25 (may be repeated)")
        .repeated();
    verb.add_option("--format", a->format, "text or json").check(one_of({"text", "json"}));
    verb.callback([a, &action] { action = [a] { return validate(*a); }; });
}

} // namespace gridspace::cli
