// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <chrono>
#include <filesystem>
#include <string>

namespace gridspace::launcher {

/// Where a monitor serves, and what it takes to be let in.
struct MonitorAddress {
    std::string address;               ///< "127.0.0.1:8080"
    std::filesystem::path certificate; ///< that it shows; empty: no TLS
    std::filesystem::path token_file;  ///< empty: it asks for none
    [[nodiscard]] std::string url() const { return (certificate.empty() ? "http://" : "https://") + address; }
};

/// Notes in the run folder where the monitor of the run serves, in a file of this user alone. As long as the result is
/// kept (also by a child process), the file is locked: so others of this user know that the run is under way.
[[nodiscard]] Result<UniqueFd> note_monitor(std::filesystem::path const& folder, MonitorAddress const& monitor);

/// The run's monitor: as it is when `run` is an address or URL already; otherwise from the folder, and only where this
/// user's own run wrote it and is still running. Nobody else can have locked a file that only its owner may open.
[[nodiscard]] Result<MonitorAddress> monitor_address(std::filesystem::path const& run);

/// Makes the secret of a run that may be controlled: RUN/control.token, for its owner only.
[[nodiscard]] Result<void> write_control_token(std::filesystem::path const& folder);

/// Asks the monitor of a run to pause, continue, "step 3" or stop it.
[[nodiscard]] Result<void> control_run(std::filesystem::path const& folder, std::string const& action);

/// The body of GET `path`. An error names the address when nobody answers, and what the monitor said when it refuses.
/// One that says nothing for so long is named too.
constexpr std::chrono::milliseconds kMonitorPatience{30'000};
[[nodiscard]] Result<std::string> ask_monitor(MonitorAddress const& monitor, std::string const& path,
                                              std::chrono::milliseconds patience = kMonitorPatience);

} // namespace gridspace::launcher
