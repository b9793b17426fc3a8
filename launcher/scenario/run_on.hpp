// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <optional>
#include <string>
#include <string_view>

namespace gridspace::launcher {

struct Scenario;

/// Where a process runs: `run_on:` of a scenario.
struct RunOn {
    enum class Kind {
        native,      ///< on this machine
        qemu_user,   ///< the program for ARM64, emulated instruction by instruction on this machine's kernel
        qemu_system, ///< an emulated ARM64 board with a kernel of its own, which takes the place of the host
    } kind{Kind::native};

    [[nodiscard]] bool is_emulated() const { return kind != Kind::native; }
};

/// Nothing for a text that means none of them.
[[nodiscard]] std::optional<RunOn> parse_run_on(std::string_view text);

/// By how much waits for processes are longer: an emulated one takes several times as long for everything.
[[nodiscard]] double patience(Scenario const& scenario);

/// Every `run_on` is a word that means something, and something that its program can do.
void check_run_on(Scenario const& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
