// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/line_output.hpp"

#include <csignal>
#include <fcntl.h>
#include <gtest/gtest.h>
#include <pty.h>
#include <sys/socket.h>
#include <termios.h>
#include <unistd.h>

namespace gridspace {
namespace {

using namespace std::chrono_literals;

/// A way from `in` to `out` that is read by nobody but the test. A `sut` that waits for it hangs.
struct Way {
    explicit Way(std::string const& kind) {
        int fds[2] = {-1, -1};
        if (kind == "pipe") {
            EXPECT_EQ(::pipe2(fds, O_CLOEXEC), 0);
        } else if (kind == "socket") {
            EXPECT_EQ(::socketpair(AF_UNIX, SOCK_STREAM | SOCK_CLOEXEC, 0, fds), 0);
        } else {
            termios raw{};
            ::cfmakeraw(&raw);
            EXPECT_EQ(::openpty(&fds[0], &fds[1], nullptr, &raw, nullptr), 0);
        }
        out = UniqueFd{fds[0]};
        in = UniqueFd{fds[1]};
        ::fcntl(out.get(), F_SETFL, O_NONBLOCK);
    }
    /// What is there.
    std::string read() const {
        std::string text;
        char buffer[65536];
        for (ssize_t size = 0; (size = ::read(out.get(), buffer, sizeof buffer)) > 0;) {
            text.append(buffer, static_cast<std::size_t>(size));
        }
        return text;
    }
    UniqueFd in, out;
};

class EveryLineOutput : public testing::TestWithParam<std::string> {};

TEST_P(EveryLineOutput, NeverWaitsAndKeepsTheOrder) {
    Way const way{GetParam()};
    LineOutput sut{way.in.get()};
    std::string expected;
    for (int i = 0; i < 9000; ++i) { // more than any of them takes
        std::string const line = "line " + std::to_string(i) + std::string(40, '.') + "\n";
        sut.put(line);
        expected += line;
    }
    EXPECT_TRUE(sut.waits());
    EXPECT_EQ(sut.left_out(), 0U);
    std::string got;
    while (got.size() < expected.size()) {
        std::string const more = way.read();
        ASSERT_TRUE(!more.empty() || sut.waits());
        got += more;
        sut.flush();
    }
    EXPECT_EQ(got, expected);
    EXPECT_FALSE(sut.waits());
    EXPECT_EQ(::fcntl(way.in.get(), F_GETFL) & O_NONBLOCK, 0) << "others write to it too";
}

INSTANTIATE_TEST_SUITE_P(To, EveryLineOutput, testing::Values("pipe", "socket", "terminal"),
                         [](auto const& parameter) { return parameter.param; });

TEST(LineOutput, OfLinesThatReplaceEachOtherOnlyTheNewestWaits) {
    Way const way{"pipe"};
    LineOutput sut{way.in.get()};
    while (!sut.waits()) {
        sut.put(std::string(4096, ' '));
    }
    sut.put("\n");
    for (int i = 0; i < 1000; ++i) {
        sut.put_latest("at " + std::to_string(i) + "\n");
    }
    sut.put("event\n");
    sut.put_latest("at the end\n");
    std::string got;
    for (; sut.waits(); sut.flush()) {
        got += way.read();
    }
    got += way.read();
    EXPECT_EQ(got.substr(got.find('\n')), "\nat 999\nevent\nat the end\n");
}

TEST(LineOutput, KeepsNoMoreThanItsBoundAndCountsTheRest) {
    Way const way{"pipe"};
    LineOutput sut{way.in.get(), 10'000};
    while (!sut.waits()) {
        sut.put(std::string(4096, ' '));
    }
    for (int i = 0; i < 200; ++i) {
        sut.put(std::string(100, 'x'));
    }
    EXPECT_GT(sut.left_out(), 100U);
    EXPECT_LE(sut.take().size(), 10'000U);
    EXPECT_FALSE(sut.waits());
}

TEST(LineOutput, DrainsWhileSomebodyReadsAndGivesUpOtherwise) {
    std::signal(SIGPIPE, SIG_IGN);
    Way way{"pipe"};
    LineOutput sut{way.in.get()};
    while (!sut.waits()) {
        sut.put(std::string(4096, ' '));
    }
    sut.drain(20ms);
    EXPECT_TRUE(sut.waits());
    (void)way.read();
    sut.drain(std::nullopt);
    EXPECT_FALSE(sut.waits());
    while (!sut.waits()) {
        sut.put(std::string(4096, ' '));
    }
    way.out.reset(); // nobody will ever read it
    sut.drain(std::nullopt);
    EXPECT_FALSE(sut.waits());
}

TEST(LineOutput, WithoutADescriptorDoesNothing) {
    LineOutput sut{-1};
    sut.put("x");
    sut.put_latest("y");
    EXPECT_FALSE(sut.waits());
}

} // namespace
} // namespace gridspace
