// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/privileges/call_filter.hpp"

#include "common/privileges/capabilities.hpp"

#include <cerrno>
#include <csignal>
#include <fstream>
#include <gtest/gtest.h>
#include <sched.h>
#include <sys/mount.h>
#include <sys/socket.h>
#include <sys/syscall.h>
#include <thread>
#include <unistd.h>

namespace gridspace {
namespace {

std::string status_of_this_process(std::string const& key) {
    std::ifstream status{"/proc/thread-self/status"};
    for (std::string word, value; status >> word;) {
        if (word == key + ":" && status >> value) {
            return value;
        }
    }
    return "";
}

// Each in a process of its own (a "death test"), since nothing of this can be taken back.
class Privileges : public ::testing::Test {
  protected:
    void SetUp() override { GTEST_FLAG_SET(death_test_style, "threadsafe"); }
};

TEST_F(Privileges, OfTheCapabilitiesOnlyTheGivenOnesAreLeft) {
    EXPECT_EXIT(
        {
            keep_only_capabilities(kMayOpenRawSockets);
            std::string const held = status_of_this_process("CapEff");
            std::string const bound = status_of_this_process("CapBnd");
            bool const nothing_else = (std::stoull(held, nullptr, 16) & ~kMayOpenRawSockets) == 0;
            bool const for_good = ::geteuid() != 0 || std::stoull(bound, nullptr, 16) == kMayOpenRawSockets;
            ::_exit(nothing_else && for_good && status_of_this_process("NoNewPrivs") == "1" ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
}

TEST_F(Privileges, AForbiddenCallEndsTheProcessAndIsNamed) {
    EXPECT_EXIT(
        {
            allow_only_known_calls();
            ::unshare(CLONE_NEWNS);
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "forbidden: this process called unshare");
    EXPECT_EXIT(
        {
            allow_only_known_calls();
            ::mount("none", "/nowhere", "tmpfs", 0, nullptr);
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "called mount .system call [0-9]+.,");
}

TEST_F(Privileges, WhatIsNotOnTheListEndsTheProcessAndACallOfANewerKernelIsNotThere) {
    EXPECT_EXIT(
        {
            allow_only_known_calls();
            bool const newer_is_absent = ::syscall(4000) == -1 && errno == ENOSYS;
            if (!newer_is_absent) {
                ::_exit(1);
            }
            ::syscall(SYS_keyctl, 0, 0, 0, 0, 0); // harmless, and on no list
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "called keyctl .system call [0-9]+.");
}

TEST_F(Privileges, NothingIsStartedInANewNamespaceAndThreadsAreStarted) {
    EXPECT_EXIT(
        {
            allow_only_known_calls();
            std::thread{[] {}}.join();
            bool const gone = ::syscall(SYS_clone3, nullptr, 0) == -1 && errno == ENOSYS;
            if (!gone) {
                ::_exit(1);
            }
            ::syscall(SYS_clone, CLONE_NEWUSER | SIGCHLD, nullptr, nullptr, nullptr, nullptr);
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "called clone .into a new namespace. ");
}

TEST_F(Privileges, AThreadThatRunsAlreadyIsBoundToo) {
    EXPECT_EXIT(
        {
            std::thread{[] {
                std::thread{[] { allow_only_known_calls(); }}.join();
                ::unshare(CLONE_NEWNS);
            }}.join();
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "called unshare");
}

TEST_F(Privileges, RawSocketsAreForbiddenAndOthersAreNot) {
    EXPECT_EXIT(
        {
            forbid_raw_sockets();
            bool const ok = ::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC, 0) >= 0 &&
                            ::socket(AF_NETLINK, SOCK_RAW | SOCK_CLOEXEC, 0) >= 0 &&
                            ::socket(AF_UNIX, SOCK_STREAM, 0) >= 0;
            ::_exit(ok ? 0 : 1);
        },
        testing::ExitedWithCode(0), "");
    EXPECT_EXIT(
        {
            forbid_raw_sockets();
            ::socket(AF_PACKET, SOCK_DGRAM | SOCK_CLOEXEC, 0);
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "called socket \\(raw\\)");
    EXPECT_EXIT(
        {
            forbid_raw_sockets();
            ::socket(AF_INET, SOCK_RAW | SOCK_CLOEXEC, 1);
            ::_exit(0);
        },
        testing::KilledBySignal(SIGSYS), "called socket \\(raw\\)");
}

} // namespace
} // namespace gridspace
