// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/pacer.hpp"
#include "common/realtime.hpp"

#include <fcntl.h>
#include <fstream>
#include <gmock/gmock.h>
#include <sched.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

namespace gridspace {
namespace {

/// Runs `body` in a process of its own, which it may spoil; its exit code.
template <class Body>
int in_a_child(Body&& body) {
    pid_t const child = ::fork();
    if (child == 0) {
        ::_exit(body());
    }
    int status = 0;
    ::waitpid(child, &status, 0);
    return WIFEXITED(status) ? WEXITSTATUS(status) : 128;
}

TEST(Realtime, AskingWhetherItIsPermittedChangesNothingHere) {
    int const before = ::sched_getscheduler(0);
    bool const permitted = may_schedule_fifo(1);
    EXPECT_EQ(::sched_getscheduler(0), before);
    EXPECT_EQ(in_a_child([] { return schedule_fifo(1) ? 0 : 1; }) == 0, permitted) << "the answer is what happens then";
}

TEST(Realtime, TheComputingThreadStepsBelowTheOthersOnlyWhereThereIsAnOrder) {
    EXPECT_EQ(in_a_child([] {
                  step_below_the_others();
                  return scheduling_text() == "SCHED_OTHER" ? 0 : 1;
              }),
              0);
    if (!may_schedule_fifo(30)) {
        EXPECT_EQ(scheduling_text(), "SCHED_OTHER");
        return; // that is all that can be seen here
    }
    EXPECT_EQ(in_a_child([] {
                  schedule_fifo(30);
                  step_below_the_others();
                  return scheduling_text() == "SCHED_FIFO 29" ? 0 : 1;
              }),
              0);
}

TEST(Realtime, MemoryIsLockedOnlyWhereThatCannotFailLater) {
    // With a limit and without the capability, mlockall would succeed now and an allocation fail later.
    EXPECT_EQ(in_a_child([] {
                  rlimit const small{1 << 20, 1 << 20};
                  ::setrlimit(RLIMIT_MEMLOCK, &small);
                  bool const dropped = ::setresuid(65534, 65534, 65534) == 0; // nobody, where this is root
                  std::string const why = lock_memory();
                  return !dropped || why.find("RLIMIT_MEMLOCK is 1024 kB") != std::string::npos ? 0 : 1;
              }),
              0);
}

TEST(Realtime, ProcessorsStayAwakeWhereTheDeviceMayBeWritten) {
    auto const kept = keep_processors_awake();
    std::string driver;
    std::ifstream{"/sys/devices/system/cpu/cpuidle/current_driver"} >> driver;
    bool const permitted = driver != "none" && ::access("/dev/cpu_dma_latency", W_OK) == 0;
    ASSERT_EQ(kept.has_value(), permitted) << (kept ? "" : describe(kept.error()));
    if (permitted) { // it says what the strictest request is, and somebody else may have one too
        UniqueFd const device{::open("/dev/cpu_dma_latency", O_RDONLY | O_CLOEXEC)};
        std::int32_t latency_us = 1000;
        ASSERT_EQ(::read(device.get(), &latency_us, sizeof latency_us), ssize_t{sizeof latency_us});
        EXPECT_LE(latency_us, 2);
    }
    std::string const why = driver == "none" ? "the kernel has no driver" : "/dev/cpu_dma_latency: ";
    EXPECT_EQ(in_a_child([&] {
                  if (::setresuid(65534, 65534, 65534) != 0 || ::access("/dev/cpu_dma_latency", W_OK) == 0) {
                      return 0;
                  }
                  auto const refused = keep_processors_awake();
                  return !refused && refused.error().message.starts_with(why) ? 0 : 1;
              }),
              0);
}

TEST(Pacer, CountsWhatWasDueAlready) {
    Pacer sut{1e12}; // everything is due at once
    std::atomic<bool> stop{false};
    sut.start();
    EXPECT_FALSE(sut.wait(0, stop));
    EXPECT_EQ(sut.overruns(), 1U);
    EXPECT_GE(sut.worst(), sut.late());
    stop = true;
    Pacer slow{1e-9}; // due in years
    slow.start();
    (void)slow.wait(1, stop); // returns, because the run is over
    EXPECT_EQ(slow.overruns(), 0U);
}

TEST(Pacer, BeginsOnAWholeSecondOfUtcThatHasCome) {
    Pacer sut{1};
    std::atomic<bool> const stop{false};
    std::int64_t const second = sut.start_on_utc_second(stop);
    EXPECT_EQ(second % 1'000'000'000, 0);
    auto const now = std::chrono::nanoseconds{std::chrono::system_clock::now().time_since_epoch()}.count();
    EXPECT_GE(now, second - 1'000'000); // the clock may be slewed while we wait
    EXPECT_FALSE(sut.wait(-1e-9, stop)) << "what was due at that second is late by now";
}

} // namespace
} // namespace gridspace
