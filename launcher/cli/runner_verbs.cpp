// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// gridspace-runner: the verbs of a first run from a checkout, without what takes long to compile and is not needed for
// them (scripts/build.sh).
#include "launcher/cli/verb_groups.hpp"

namespace gridspace::cli {

std::vector<VerbGroup> verb_groups() {
    return {{"Run", {add_run}},
            {"Look at a run", {add_monitor, add_report, add_info}},
            {"While it runs", {add_graph, add_topic, add_control}}};
}

} // namespace gridspace::cli
