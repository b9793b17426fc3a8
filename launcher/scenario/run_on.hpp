// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <filesystem>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace::launcher {

struct Process;
struct Scenario;

/// Where a process runs: `run_on:` of a scenario.
struct RunOn {
    enum class Kind {
        native,      ///< on this machine
        qemu_user,   ///< the program for ARM64, emulated instruction by instruction on this machine's kernel
        qemu_system, ///< an emulated ARM64 board with a kernel of its own, which takes the place of the host
        ssh,         ///< a real board, which takes the place of the host
        external,    ///< somebody else starts it, on the host or on what is plugged in its place
    } kind{Kind::native};
    std::string user, host; ///< of ssh; the user may be empty: ssh's configuration says who
    int port{0};            ///< of ssh; 0: its configuration says which

    [[nodiscard]] bool is_emulated() const { return kind == Kind::qemu_user || kind == Kind::qemu_system; }
    /// "user@host:port", as it was written
    [[nodiscard]] std::string place() const;
};

/// How a board is reached: `ssh:` of a process. What is not given is taken from ssh's own configuration.
struct SshSettings {
    std::filesystem::path identity; ///< private key
    std::filesystem::path config;   ///< instead of ~/.ssh/config
    std::string installed;          ///< folder of a bundle on the board; empty: it is copied there
};
void describe(config::Fields& f, SshSettings& ssh);

/// Nothing for a text that means none of them.
[[nodiscard]] std::optional<RunOn> parse_run_on(std::string_view text);

/// Somebody else starts it.
[[nodiscard]] bool is_external(Process const& process);

/// By how much waits for processes are longer: an emulated one takes several times as long for everything.
[[nodiscard]] double patience(Scenario const& scenario);

/// Every `run_on` is a word that means something, and something that its program can do.
void check_run_on(Scenario const& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
