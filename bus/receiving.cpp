// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/receiving.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <ctime>
#include <poll.h>
#include <sys/epoll.h>
#include <sys/eventfd.h>
#include <unistd.h>

namespace gridspace::bus {
namespace {

constexpr std::chrono::milliseconds kBeside{20}; ///< how often the other thread looks while the process's own works
constexpr std::chrono::milliseconds kNotMine{5}; ///< how long to wait for somebody else's turn before asking again
constexpr std::chrono::hours kLong{1};

} // namespace

Receiving& Receiving::of_process() {
    static Receiving receiving;
    return receiving;
}

Receiving::Receiving() : epoll_{::epoll_create1(EPOLL_CLOEXEC)}, bell_{::eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)} {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.ptr = nullptr;
    (void)::epoll_ctl(epoll_.get(), EPOLL_CTL_ADD, bell_.get(), &event);
}

Receiving::~Receiving() {
    stop_ = true;
    std::uint64_t const one = 1;
    (void)!::write(bell_.get(), &one, sizeof one);
    if (thread_.joinable()) {
        thread_.join();
    }
}

void Receiving::start_thread() {
    std::call_once(started_, [this] { thread_ = std::thread{[this] { run(); }}; });
}

void Receiving::run() {
    while (!stop_) {
        if (has_worker_) {
            std::this_thread::sleep_for(kBeside);
            if (has_turn_) {
                continue;
            }
        }
        std::unique_lock looking{looking_, std::try_to_lock};
        if (looking.owns_lock()) {
            look(has_worker_ ? std::chrono::nanoseconds{0} : std::chrono::nanoseconds{kLong});
        } else if (!has_worker_) {
            std::this_thread::sleep_for(kBeside);
        }
        looking = {};
        let_go();
    }
}

/// Sleeps and does not yield: under SCHED_FIFO who waits may be below this thread.
void Receiving::let_go() const {
    constexpr std::chrono::microseconds kMoment{100};
    while (waiting_to_go_ > 0) {
        std::this_thread::sleep_for(kMoment);
    }
}

void Receiving::look(std::chrono::nanoseconds longest) {
    std::array<epoll_event, 16> events{};
    auto const ready = [&](int ms) {
        return ::epoll_wait(epoll_.get(), events.data(), static_cast<int>(events.size()), ms);
    };
    auto const ms = std::max<std::int64_t>(0, std::chrono::floor<std::chrono::milliseconds>(longest).count());
    int count = ready(static_cast<int>(ms));
    if (count <= 0 && ms == 0 && longest.count() > 0) { // epoll_wait counts in milliseconds
        timespec const span{0, static_cast<long>(longest.count())};
        pollfd entry{epoll_.get(), POLLIN, 0};
        count = ::ppoll(&entry, 1, &span, nullptr) > 0 ? ready(0) : 0;
    }
    constexpr int kRounds = 16; // of who does not wait, but takes what there is
    int const rounds = longest.count() == 0 ? kRounds : 1;
    for (int round = 1; count > 0; ++round) {
        for (int i = 0; i < count; ++i) {
            auto* const source = static_cast<Source*>(events[static_cast<std::size_t>(i)].data.ptr);
            if (source != nullptr) {
                source->take_();
                continue;
            }
            std::uint64_t rings = 0;
            (void)!::read(bell_.get(), &rings, sizeof rings);
        }
        count = round < rounds ? ready(0) : 0;
    }
}

void Receiving::wake() {
    if (has_turn_ && worker_.load() != std::this_thread::get_id()) {
        std::uint64_t const one = 1;
        (void)!::write(bell_.get(), &one, sizeof one);
    }
}

Receiving::Source::Source(Receiving& receiving, int fd, Take take)
    : receiving_{receiving}, fd_{fd}, take_{std::move(take)} {
    epoll_event event{};
    event.events = EPOLLIN;
    event.data.ptr = this;
    (void)::epoll_ctl(receiving_.epoll_.get(), EPOLL_CTL_ADD, fd_, &event);
    receiving_.start_thread();
}

Receiving::Source::~Source() {
    (void)::epoll_ctl(receiving_.epoll_.get(), EPOLL_CTL_DEL, fd_, nullptr);
    ++receiving_.waiting_to_go_;
    std::uint64_t const one = 1;
    (void)!::write(receiving_.bell_.get(), &one, sizeof one);
    {
        std::lock_guard const nobody_looks{receiving_.looking_};
    }
    --receiving_.waiting_to_go_;
}

Receiving::Turn::Turn(Receiving& receiving) : receiving_{receiving} {
    take_turn();
}

Receiving::Turn::~Turn() {
    if (mine_) {
        receiving_.has_turn_ = false;
    }
}

void Receiving::Turn::take_turn() {
    if (mine_ || receiving_.has_turn_.exchange(true)) {
        return;
    }
    mine_ = true;
    receiving_.worker_ = std::this_thread::get_id();
    if (!receiving_.has_worker_.exchange(true)) { // the other thread may be in a long look
        std::uint64_t const one = 1;
        (void)!::write(receiving_.bell_.get(), &one, sizeof one);
    }
}

void Receiving::Turn::wait(std::unique_lock<std::mutex>& lock, std::condition_variable& changed,
                           std::chrono::nanoseconds longest) {
    take_turn();
    if (!mine_) {
        changed.wait_for(lock, std::min<std::chrono::nanoseconds>(longest, kNotMine));
        return;
    }
    lock.unlock();
    receiving_.let_go();
    {
        std::lock_guard const looking{receiving_.looking_};
        receiving_.look(longest);
    }
    lock.lock();
}

} // namespace gridspace::bus
