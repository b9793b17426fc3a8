// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/board/board.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <cstring>
#include <ctime>
#include <fmt/format.h>
#include <linux/futex.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace gridspace::bus {

struct Board::Place {
    alignas(64) std::atomic<std::uint64_t> written; ///< octets, ever; behind complete messages only
    alignas(64) std::atomic<std::uint32_t> bell;
    std::atomic<std::uint32_t> sleeps;
    std::atomic<std::int32_t> expected;
    alignas(64) std::byte ring[kRing];
};

namespace {

static_assert(std::atomic<std::uint64_t>::is_always_lock_free && std::atomic<std::uint32_t>::is_always_lock_free);

struct Head {
    std::uint64_t size;
    std::int64_t time_ns;
    std::uint64_t number;
};

void copy_in(std::byte* ring, std::uint64_t at, void const* from, std::size_t size) {
    std::size_t const begin = at % Board::kRing, first = std::min(size, Board::kRing - begin);
    std::memcpy(ring + begin, from, first);
    std::memcpy(ring, static_cast<std::byte const*>(from) + first, size - first);
}

void copy_out(std::byte const* ring, std::uint64_t at, void* to, std::size_t size) {
    std::size_t const begin = at % Board::kRing, first = std::min(size, Board::kRing - begin);
    std::memcpy(to, ring + begin, first);
    std::memcpy(static_cast<std::byte*>(to) + first, ring, size - first);
}

std::uint32_t* word(std::atomic<std::uint32_t>& value) {
    return reinterpret_cast<std::uint32_t*>(&value);
}

} // namespace

Result<UniqueFd> Board::create(std::size_t places) {
    UniqueFd memory{::memfd_create("gridspace board", MFD_CLOEXEC)};
    if (!memory || ::ftruncate(memory.get(), static_cast<off_t>(places * sizeof(Place))) != 0) {
        return fail(ExitCode::environment, fmt::format("no shared memory for the clock: {}", std::strerror(errno)),
                    "clock: {shared_memory: false} goes without");
    }
    return memory;
}

Result<std::unique_ptr<Board>> Board::join(UniqueFd memory, std::vector<std::string> processes,
                                           std::string const& self) {
    auto out = std::unique_ptr<Board>{new Board};
    out->processes_ = std::move(processes);
    out->self_ = out->place_of(self);
    out->read_until_.resize(out->size());
    std::size_t const octets = out->size() * sizeof(Place);
    struct stat status{};
    bool const is_ours = ::fstat(memory.get(), &status) == 0 && static_cast<std::size_t>(status.st_size) == octets;
    void* const mapped =
        is_ours ? ::mmap(nullptr, octets, PROT_READ | PROT_WRITE, MAP_SHARED, memory.get(), 0) : MAP_FAILED;
    if (mapped == MAP_FAILED || out->self_ == out->size()) {
        return fail(ExitCode::environment, "the shared memory of the clock is not that of this run",
                    "GRIDSPACE_BOARD is set by `gridspace run` alone");
    }
    out->places_ = static_cast<Place*>(mapped);
    out->mapped_ = octets;
    return out;
}

Board::Place& Board::at(std::size_t place) const {
    return places_[place];
}

Board::~Board() {
    if (places_ != nullptr) {
        ::munmap(places_, mapped_);
    }
}

std::size_t Board::place_of(std::string const& process) const {
    return static_cast<std::size_t>(std::ranges::find(processes_, process) - processes_.begin());
}

bool Board::post(std::span<std::byte const> message, std::int64_t time_ns, std::uint64_t number) {
    if (message.size() > kLongest) {
        return false;
    }
    Place& place = at(self_);
    std::uint64_t const begin = place.written.load(std::memory_order_relaxed);
    Head const head{message.size(), time_ns, number};
    copy_in(place.ring, begin, &head, sizeof head);
    copy_in(place.ring, begin + sizeof head, message.data(), message.size());
    place.written.store(begin + sizeof head + message.size(), std::memory_order_release);
    return true;
}

bool Board::read(std::size_t place, std::function<void(Message const&)> const& take) {
    Place& of = at(place);
    std::uint64_t& position = read_until_[place];
    while (position != of.written.load(std::memory_order_acquire)) {
        Head head{};
        copy_out(of.ring, position, &head, sizeof head);
        if (head.size <= kLongest) {
            message_.resize(head.size);
            copy_out(of.ring, position + sizeof head, message_.data(), message_.size());
        }
        std::atomic_thread_fence(std::memory_order_acquire);
        // While it was copied the writer may have come round: what is being written lies up to a longest message ahead.
        if (head.size > kLongest ||
            of.written.load(std::memory_order_acquire) + sizeof head + kLongest - position > kRing) {
            return false;
        }
        position += sizeof head + head.size;
        take({message_, head.time_ns, head.number});
    }
    return true;
}

void Board::skip(std::size_t place) {
    read_until_[place] = at(place).written.load(std::memory_order_acquire);
}

void Board::expect(std::size_t place, std::int32_t things) {
    at(place).expected.store(things);
}

void Board::ring(std::size_t place) {
    if (at(place).expected.fetch_sub(1) == 1) {
        wake(place);
    }
}

void Board::wake(std::size_t place) {
    Place& of = at(place);
    of.bell.fetch_add(1);
    if (of.sleeps.load() != 0) {
        ::syscall(SYS_futex, word(of.bell), FUTEX_WAKE, INT_MAX, nullptr, nullptr, 0);
    }
}

std::uint32_t Board::bell() const {
    return at(self_).bell.load();
}

void Board::wait(std::uint32_t heard, std::chrono::nanoseconds longest) {
    Place& own = at(self_);
    auto const ns = std::max<std::int64_t>(0, longest.count());
    timespec const span{ns / 1'000'000'000, ns % 1'000'000'000};
    own.sleeps.store(1);
    if (own.bell.load() == heard) {
        ::syscall(SYS_futex, word(own.bell), FUTEX_WAIT, heard, &span, nullptr, 0);
    }
    own.sleeps.store(0);
}

} // namespace gridspace::bus
