// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/thread_ids.hpp"

#include <cerrno>
#include <gtest/gtest.h>
#include <sys/syscall.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

namespace gridspace::bus {
namespace {

TEST(ThreadIds, AreThoseOfTheKernelInEveryThread) {
    remember_thread_ids();
    for (int again = 0; again < 2; ++again) {
        EXPECT_EQ(::syscall(SYS_gettid), ::gettid());
        std::thread{[] {
            EXPECT_EQ(::syscall(SYS_gettid), ::gettid());
            EXPECT_NE(::syscall(SYS_gettid), ::getpid());
        }}.join();
    }
}

TEST(ThreadIds, AreNewInAForkedProcess) {
    remember_thread_ids();
    (void)::syscall(SYS_gettid);
    pid_t const child = ::fork();
    if (child == 0) {
        ::_exit(::syscall(SYS_gettid) == ::getpid() ? 0 : 1);
    }
    int status = -1;
    ASSERT_EQ(::waitpid(child, &status, 0), child);
    EXPECT_EQ(status, 0);
}

TEST(ThreadIds, LeaveOtherCallsAsTheyAre) {
    remember_thread_ids();
    EXPECT_EQ(::syscall(SYS_getpid), ::getpid());
    EXPECT_EQ(::syscall(SYS_close, -1), -1);
    EXPECT_EQ(errno, EBADF);
}

} // namespace
} // namespace gridspace::bus
