// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/attack_config.hpp"
#include "common/result.hpp"
#include "gateways/streams/stream.hpp"
#include "launcher/ids/export/label_table.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace gridspace::dataset {

/// A finished run, and what is true of it.
struct RunSource {
    std::string id; ///< its folder in the data set
    std::filesystem::path folder;
    std::string scenario, started_with; ///< name; hash of the resolved scenario
    std::string grid, network_sha256;   ///< file name of the network without its extension
    std::string version, commit;        ///< what made the run
    std::int64_t seed{0}, epoch_ns{0};
    double simulated_s{0}, frequency_hz{60};
    bool lockstep{true};
    std::vector<streams::Stream> streams;
    std::vector<attacker::AttackConfig> attacks;
    std::map<std::string, std::string> host_of; ///< by process
    LabelTable labels;

    /// The kinds of its attacks, sorted, each once; empty: nobody attacks.
    [[nodiscard]] std::vector<std::string> kinds() const;
};

/// The run folders below what the user named: a study's folder, a folder of runs, a run. Sorted by id, each id once.
[[nodiscard]] Result<std::vector<RunSource>> find_runs(std::vector<std::filesystem::path> const& named);

/// Fills in all but id and folder. Fails when the run did not come to its end, when its recording or its capture is not
/// there or was cut, and when an attack of its scenario has no labels.
[[nodiscard]] Result<void> read_run(RunSource& run);

} // namespace gridspace::dataset
