// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/cli/ids_verbs.hpp"
#include "launcher/cli/verb_groups.hpp"

namespace gridspace::cli {
namespace {

void add_ids(Command app, Action& action) {
    Command ids = app.add_subcommand(
        "ids", "the intrusion detector: train and judge forecasters, scan captures, score detectors, make data sets");
    ids.require_subcommand();
    for (auto* const add :
         {add_ids_train, add_ids_evaluate, add_ids_study, add_ids_scan, add_ids_score, add_ids_export, add_ids_sweep}) {
        add(ids, action);
    }
}

} // namespace

std::vector<VerbGroup> verb_groups() {
    return {{"Run", {add_run, add_sweep, add_certify, add_validate, add_signals, add_timebox}},
            {"Look at a run", {add_monitor, add_report, add_info, add_compare, add_export, add_play}},
            {"While it runs", {add_graph, add_topic, add_control}},
            {"A network alone", {add_powerflow, add_simulate}},
            {"Devices and other tools", {add_wire, add_scl, add_fmu, add_bundle, add_router, add_keys, add_ids}},
            {"Write your own", {add_new, add_types}},
            {"This machine", {add_doctor, add_completion, add_schema, add_sweep_task}}};
}

} // namespace gridspace::cli
