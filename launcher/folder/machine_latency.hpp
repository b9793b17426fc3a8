// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/lateness.hpp"
#include "common/result.hpp"

#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// What `gridspace doctor --latency` found last on this machine: how late it wakes a process up, for each way to wait.
struct MachineLatency {
    std::string measured; ///< when, UTC
    std::string load;     ///< of the machine meanwhile
    struct Way {
        std::string name;
        Lateness::Summary lateness;
    };
    std::vector<Way> ways; ///< those that were permitted
};

/// Keeps the doctor's JSON for the reports of later runs, in the user's cache. The file.
[[nodiscard]] Result<std::filesystem::path> keep_machine_latency(nlohmann::ordered_json const& measured);
/// What was kept, if it was measured on this machine with this kernel.
[[nodiscard]] std::optional<nlohmann::ordered_json> kept_machine_latency();
[[nodiscard]] std::optional<MachineLatency> machine_latency_of(nlohmann::ordered_json const& kept);

} // namespace gridspace::launcher
