// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/log.hpp"

#include <atomic>
#include <unistd.h>

namespace gridspace::log {
namespace {

std::atomic<Level> g_level{Level::info};
std::atomic<double> g_time{-1.0};

std::string_view name(Level level) {
    switch (level) {
    case Level::debug:
        return "debug";
    case Level::info:
        return "info";
    case Level::warning:
        return "warning";
    case Level::error:
        break;
    }
    return "error";
}

} // namespace

void set_level(Level level) {
    g_level = level;
}
bool enabled(Level level) {
    return level >= g_level.load(std::memory_order_relaxed);
}
void set_time(double seconds) {
    g_time.store(seconds, std::memory_order_relaxed);
}

void write(Level level, std::string_view text) {
    double const t = g_time.load(std::memory_order_relaxed);
    std::string const line = t < 0 ? fmt::format("{:>12}  {:<7}  {}\n", "-", name(level), text)
                                   : fmt::format("{:>10.4f} s  {:<7}  {}\n", t, name(level), text);
    // One write() per line, so that lines of several threads do not mix. A full or closed log loses the line, not the
    // run.
    [[maybe_unused]] auto const written = ::write(STDERR_FILENO, line.data(), line.size());
}

} // namespace gridspace::log
