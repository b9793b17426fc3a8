// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "launcher/scenario/addresses.hpp"
#include "launcher/scenario/scenario.hpp"

#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// What ARM64 programs and their libraries are needed from, on the machine that runs a scenario.
struct Arm64Files {
    std::filesystem::path programs; ///< GRIDSPACE_ARM64_BIN, or build/arm64/bin next to this build
    std::filesystem::path root;     ///< GRIDSPACE_ARM64_ROOT, or build/arm64-sysroot: an ARM64 root file system
    std::filesystem::path
        board; ///< GRIDSPACE_ARM64_BOARD, or build/arm64-board: kernel, initramfs and start script of the board
};
[[nodiscard]] Arm64Files arm64_files();

/// The command that runs an ARM64 program with its arguments under qemu-user. The program is found in arm64_files()
/// unless its name has a slash. Nothing is checked.
[[nodiscard]] std::vector<std::string> qemu_user_command(std::vector<std::string> command);

/// The command that runs a program of ours on an emulated board, which takes over the interfaces of the host: to be
/// started in the host's network namespace, as root.
[[nodiscard]] std::vector<std::string> qemu_system_command(std::vector<std::string> const& command,
                                                           std::filesystem::path const& config_file,
                                                           std::vector<Port> const& ports, std::string const& host);

/// Emulators, programs, libraries and devices that the scenario's processes run on are there; if not, what is missing
/// and what makes it.
[[nodiscard]] Result<void> check_emulators(Scenario const& scenario);

/// The processor that an executable file is for: "x86-64", "ARM64", another's number; empty for what is no ELF file.
[[nodiscard]] std::string machine_of(std::filesystem::path const& file);

} // namespace gridspace::launcher
