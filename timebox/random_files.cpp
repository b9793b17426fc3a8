// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Octets that the kernel would draw: they come from the seed.
#include "timebox/call_table.hpp"

#include <algorithm>
#include <cerrno>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <sys/sysmacros.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kMostAtOnce = 1U << 20U;

/// /dev/random and /dev/urandom, by whatever name (random(4)).
bool is_random(UniqueFd const& file) {
    constexpr unsigned kMemory = 1, kRandom = 8, kUrandom = 9;
    struct stat about{};
    return file && ::fstat(file.get(), &about) == 0 && S_ISCHR(about.st_mode) && major(about.st_rdev) == kMemory &&
           (minor(about.st_rdev) == kRandom || minor(about.st_rdev) == kUrandom);
}

} // namespace

std::vector<std::uint8_t> CallTable::draw(std::size_t octets) {
    std::vector<std::uint8_t> out(std::min(octets, kMostAtOnce));
    std::generate(out.begin(), out.end(), [&] { return static_cast<std::uint8_t>(random_.next()); });
    return out;
}

std::array<std::uint8_t, 16> CallTable::random_octets() {
    std::array<std::uint8_t, 16> out{};
    std::ranges::copy(draw(out.size()), out.begin());
    return out;
}

CallTable::Next CallTable::get_random(Thread const& t) {
    std::vector<std::uint8_t> const octets = draw(t.call.arguments[1]);
    bool const there = octets.empty() || write_memory(t.tid, t.call.arguments[0], octets.data(), octets.size());
    answer(t.tid, there ? static_cast<std::int64_t>(octets.size()) : -EFAULT);
    return Next::go;
}

bool CallTable::read_random(Thread const& t, UniqueFd const& file) {
    if ((t.call.number != SYS_read && t.call.number != SYS_readv) || !is_random(file)) {
        return false;
    }
    Message const message = messages_of(t.tid, t.call).front();
    std::vector<std::uint8_t> const octets = draw(room_of(message));
    answer(t.tid, scatter(t.tid, message, octets) ? static_cast<std::int64_t>(octets.size()) : -EFAULT);
    return true;
}

} // namespace gridspace::timebox
