// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/child.hpp"
#include "tests/support/temporary_folder.hpp"

#include <csignal>
#include <filesystem>
#include <fstream>
#include <gmock/gmock.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace::launcher {
namespace {

using testing::HasSubstr;
namespace fs = std::filesystem;

class Spawn : public ::testing::Test {
  protected:
    [[nodiscard]] std::string program(std::string const& name, std::string const& content) const {
        std::ofstream{folder_ / name, std::ios::binary} << content;
        fs::permissions(folder_ / name, fs::perms::owner_all);
        return (folder_ / name).string();
    }
    /// The exit code of a user's command, or what stopped it from starting.
    [[nodiscard]] Result<int> run(std::string const& command,
                                  std::map<std::string, std::string> environment = {}) const {
        PlannedProcess process;
        process.name = "p";
        process.program = "exec";
        process.config_file = folder_ / "p.yaml";
        process.log_file = folder_ / "p.log";
        process.command = {command};
        process.environment = std::move(environment);
        auto const child = spawn(process, {});
        if (!child) {
            return std::unexpected{child.error()};
        }
        int status = 0;
        ::waitpid(child->pid, &status, 0);
        for (int const fd : {child->pidfd, child->status_fd, child->control_fd}) {
            ::close(fd);
        }
        return WIFEXITED(status) ? WEXITSTATUS(status) : -1;
    }

    TemporaryFolder temporary_;
    fs::path folder_{temporary_.path()};
};

TEST_F(Spawn, ScriptsAndCommandsOfThePathAreStarted) {
    EXPECT_EQ(run(program("s", "#!/bin/sh\nexit 7\n")), 7);
    EXPECT_EQ(run("true"), 0);
    EXPECT_EQ(run("./s"), 7) << "from the run folder";
    EXPECT_EQ(run("s", {{"PATH", "/nowhere:" + folder_.string()}}), 7);
}

TEST_F(Spawn, AProgramOfAnotherProcessorIsNotGivenToTheShell) {
    std::string elf(64, '\0');
    elf.replace(0, 7,
                std::string{"\x7f"
                            "ELF\x02\x01\x01",
                            7});
    elf[16] = 2;    // executable
    elf[18] = 0x7F; // a machine that is none
    elf[19] = 0x7F;
    for (std::string const& content : {elf, std::string{"exit 0\n"}}) {
        auto const sut = run(program("x", content));
        ASSERT_FALSE(sut) << "it ran, with exit code " << *sut;
        EXPECT_EQ(sut.error().code, ExitCode::environment);
        EXPECT_THAT(sut.error().message, HasSubstr("no program for this machine's processor"));
        EXPECT_FALSE(run("x", {{"PATH", folder_.string()}}));
    }
}

TEST_F(Spawn, ACommandThatIsNowhereIsSaidToBeMissing) {
    for (std::string const command : {"gridspace_no_such_command", "./gridspace_no_such_command"}) {
        auto const sut = run(command);
        ASSERT_FALSE(sut);
        EXPECT_EQ(sut.error().code, ExitCode::environment);
        EXPECT_THAT(sut.error().message, HasSubstr("No such file or directory"));
    }
}

TEST_F(Spawn, NothingStaysOpenOfAProcessThatCannotStart) {
    auto const open_files = [] {
        return std::distance(fs::directory_iterator{"/proc/self/fd"}, fs::directory_iterator{});
    };
    auto const before = open_files();
    EXPECT_FALSE(run("./gridspace_no_such_command"));
    PlannedProcess process;
    process.name = "p";
    process.log_file = folder_ / "no_such_folder" / "p.log";
    EXPECT_FALSE(spawn(process, {}));
    EXPECT_EQ(open_files(), before);
}

TEST_F(Spawn, AStoppedProcessIsToldFromOneThatWaits) {
    pid_t const pid = ::fork();
    if (pid == 0) {
        ::raise(SIGSTOP);
        ::pause();
        ::_exit(0);
    }
    ASSERT_EQ(::waitpid(pid, nullptr, WUNTRACED), pid);
    EXPECT_TRUE(is_stopped(pid));
    ::kill(pid, SIGCONT);
    ASSERT_EQ(::waitpid(pid, nullptr, WCONTINUED), pid);
    EXPECT_FALSE(is_stopped(pid));
    ::kill(pid, SIGKILL);
    ::waitpid(pid, nullptr, 0);
    EXPECT_FALSE(is_stopped(pid)) << "gone";
}

} // namespace
} // namespace gridspace::launcher
