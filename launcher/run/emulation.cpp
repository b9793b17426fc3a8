// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/emulation.hpp"

#include "common/unique_fd.hpp"
#include "launcher/scenario/installation.hpp"
#include "launcher/scenario/run_on.hpp"

#include <array>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <elf.h>
#include <fcntl.h>
#include <fmt/format.h>
#include <fstream>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

constexpr std::string_view kPreload = "libgridspace-qemu-user.so";
constexpr std::string_view kBoardStart = "start_qemu_system.sh";

std::filesystem::path from_environment(char const* name, std::filesystem::path otherwise) {
    char const* const value = std::getenv(name);
    return value != nullptr && *value != 0 ? std::filesystem::absolute(value) : std::move(otherwise);
}

std::filesystem::path emulator() {
    auto const file = system_program("qemu-aarch64-static");
    return file.empty() ? system_program("qemu-aarch64") : file;
}

std::filesystem::path arm64_program(std::string const& program) {
    return program.find('/') != std::string::npos ? std::filesystem::path{program} : arm64_files().programs / program;
}

/// `program` can run under qemu-user.
Result<void> check_qemu_user(std::string const& program) {
    if (emulator().empty()) {
        return fail(ExitCode::environment,
                    "`run_on: qemu-user` needs the emulator qemu-aarch64-static, which is not installed",
                    "apt install qemu-user-static, or ./gridspace arm64 build");
    }
    Arm64Files const files = arm64_files();
    std::filesystem::path const file = arm64_program(program);
    std::string const machine = machine_of(file);
    std::error_code ignored;
    if (!std::filesystem::exists(file, ignored)) {
        return fail(ExitCode::environment, fmt::format("there is no '{}' for ARM64 ({})", program, file.string()),
                    "./gridspace arm64 build makes the programs (GRIDSPACE_ARM64_BIN names another folder)");
    }
    if (machine != "ARM64") {
        return fail(ExitCode::environment,
                    fmt::format("'{}' is {}, and qemu-user runs ARM64", file.string(),
                                machine.empty() ? "no program of any processor" : "a program for " + machine),
                    "`run_on: native`, or ./gridspace arm64 build");
    }
    if (!std::filesystem::exists(files.root / "lib/aarch64-linux-gnu/libc.so.6", ignored)) {
        return fail(ExitCode::environment, fmt::format("the libraries for ARM64 are not in '{}'", files.root.string()),
                    "./gridspace arm64 build fetches them (GRIDSPACE_ARM64_ROOT names another folder)");
    }
    return {};
}

Result<void> check_board() {
    if (system_program("qemu-system-aarch64").empty() || system_program("cpio").empty()) {
        return fail(ExitCode::environment,
                    "`run_on: qemu-system` needs the emulator qemu-system-aarch64 and cpio, which are not installed",
                    "apt install qemu-system-arm cpio, or ./gridspace arm64 image");
    }
    std::filesystem::path const board = arm64_files().board;
    for (std::string_view const file : {std::string_view{"vmlinuz"}, std::string_view{"initramfs"}, kBoardStart}) {
        std::error_code ignored;
        if (!std::filesystem::exists(board / file, ignored)) {
            return fail(
                ExitCode::environment,
                fmt::format("the image of the ARM64 board is not complete: there is no '{}'", (board / file).string()),
                "./gridspace arm64 image makes it (GRIDSPACE_ARM64_BOARD names another folder)");
        }
    }
    if (::geteuid() != 0 || ::access("/dev/net/tun", R_OK | W_OK) != 0) {
        return fail(
            ExitCode::environment,
            "`run_on: qemu-system` plugs the board into the scenario's network by tap devices, for which it needs "
            "root and /dev/net/tun",
            "run as root (modprobe tun, if the device is missing), or `run_on: qemu-user`");
    }
    return {};
}

/// Opened, because who may is for the kernel to say.
Result<void> check_taps() {
    if (UniqueFd const tun{::open("/dev/net/tun", O_RDWR | O_CLOEXEC)}; tun) {
        return {};
    }
    int const why = errno;
    return fail(
        ExitCode::environment,
        fmt::format("a guest is plugged in by tap devices, and /dev/net/tun cannot be opened: {}", std::strerror(why)),
        why == EACCES ? "as root: chmod 666 /dev/net/tun, as it usually is; or run as root"
                      : "as root: modprobe tun; in a container, start that with --device /dev/net/tun");
}

} // namespace

Arm64Files arm64_files() {
    // build/PRESET/bin/gridspace, or PREFIX/bin/gridspace with PREFIX/lib/gridspace-arm64/{bin,root}
    std::filesystem::path const here = program_file("gridspace").parent_path();
    std::filesystem::path const installed = here.parent_path() / "lib/gridspace-arm64";
    std::error_code ignored;
    bool const is_installed = std::filesystem::exists(installed, ignored);
    std::filesystem::path const builds = here.parent_path().parent_path();
    return {from_environment("GRIDSPACE_ARM64_BIN", is_installed ? installed / "bin" : builds / "arm64/bin"),
            from_environment("GRIDSPACE_ARM64_ROOT", is_installed ? installed / "root" : builds / "arm64-sysroot"),
            from_environment("GRIDSPACE_ARM64_BOARD", is_installed ? installed / "board" : builds / "arm64-board")};
}

std::vector<std::string> qemu_user_command(std::vector<std::string> command) {
    Arm64Files const files = arm64_files();
    std::vector<std::string> words{emulator().string(), "-L", files.root.string(), "-E",
                                   fmt::format("LD_PRELOAD={}", (files.programs / kPreload).string())};
    command.front() = arm64_program(command.front()).string();
    words.insert(words.end(), command.begin(), command.end());
    return words;
}

std::vector<std::string> qemu_system_command(std::vector<std::string> const& command,
                                             std::filesystem::path const& config_file, std::vector<Port> const& ports,
                                             std::string const& host) {
    std::filesystem::path const board = arm64_files().board;
    std::vector<std::string> words{"sh", (board / kBoardStart).string(), board.string(), config_file.string()};
    for (Port const& port : ports) {
        if (port.host == host) {
            words.push_back(fmt::format("{},{},{}", port.interface, port.mac,
                                        port.address.empty() ? "-" : fmt::format("{}/{}", port.address, port.prefix)));
        }
    }
    words.emplace_back("--");
    words.insert(words.end(), command.begin(), command.end());
    return words;
}

std::string machine_of(std::filesystem::path const& file) {
    std::array<char, sizeof(Elf64_Ehdr)> head{};
    std::ifstream stream{file, std::ios::binary};
    if (!stream.read(head.data(), head.size()) ||
        std::string_view{head.data(), SELFMAG} != std::string_view{ELFMAG, SELFMAG}) {
        return {};
    }
    // e_machine has the same place in 32 and 64 bits; both orders of octets exist
    bool const little = head[EI_DATA] != ELFDATA2MSB;
    auto const low = static_cast<unsigned char>(head[little ? 18 : 19]),
               high = static_cast<unsigned char>(head[little ? 19 : 18]);
    int const machine = high * 256 + low;
    return machine == EM_X86_64 ? "x86-64" : machine == EM_AARCH64 ? "ARM64" : fmt::format("ELF machine {}", machine);
}

Result<void> check_emulators(Scenario const& scenario) {
    for (Process const& process : scenario.processes) {
        RunOn const run_on = parse_run_on(process.run_on).value_or(RunOn{});
        auto const own = process.settings->command();
        auto const ok = process.settings->is_guest() ? check_taps()
                        : run_on.kind == RunOn::Kind::qemu_user
                            ? check_qemu_user(own.empty() ? process.program.name : own.front())
                        : run_on.kind == RunOn::Kind::qemu_system ? check_board()
                                                                  : Result<void>{};
        if (!ok) {
            return fail(ok.error().code, fmt::format("process '{}': {}", process.name.name, ok.error().message),
                        ok.error().remedy);
        }
    }
    return {};
}

} // namespace gridspace::launcher
