// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/team.hpp"

#include <atomic>
#include <system_error>
#include <thread>
#include <vector>

namespace gridspace {
namespace {

/// Looks at what another thread writes before it yields, and yields before it sleeps: some 20 us, and a few more where
/// nobody else wants the processor.
constexpr int kLooks = 500, kYields = 20;
constexpr std::size_t kCacheLine = 64;

void pause_processor() {
#if defined(__x86_64__)
    __builtin_ia32_pause();
#elif defined(__aarch64__)
    asm volatile("yield");
#endif
}

/// A number that one thread changes and others wait for. It counts on and starts again from the least.
class Counter {
  public:
    [[nodiscard]] int get() const { return value_.load(std::memory_order_acquire); }
    void set(int value) {
        value_.store(value); // in one order with sleepers_: who goes to sleep sees the value, or is seen
        if (sleepers_.load() > 0) {
            value_.notify_all();
        }
    }
    /// Returns once it is not `old` any more.
    int wait_while(int old) {
        for (int i = 0; i < kLooks; ++i) {
            if (int const now = get(); now != old) {
                return now;
            }
            pause_processor();
        }
        for (int i = 0; i < kYields; ++i) {
            if (int const now = get(); now != old) {
                return now;
            }
            std::this_thread::yield();
        }
        ++sleepers_;
        while (value_.load() == old) {
            value_.wait(old);
        }
        --sleepers_;
        return get();
    }

  private:
    std::atomic<int> value_{0}, sleepers_{0};
};

int after(int round) {
    return static_cast<int>(static_cast<unsigned>(round) + 1U);
}

class ThreadTeam final : public Team {
  public:
    explicit ThreadTeam(int threads) : parts_(static_cast<std::size_t>(threads)) {
        try {
            for (int k = 1; k < threads; ++k) {
                threads_.emplace_back([this, k] { help(k); });
            }
        } catch (std::system_error const&) { // the system allows no more: those that are there do all parts
        }
    }
    ThreadTeam(ThreadTeam const&) = delete;
    ThreadTeam& operator=(ThreadTeam const&) = delete;
    ~ThreadTeam() override {
        ending_ = true;
        round_.set(after(round_.get()));
        for (std::thread& t : threads_) {
            t.join();
        }
    }

    [[nodiscard]] int size() const override { return static_cast<int>(parts_.size()); }

  private:
    struct alignas(kCacheLine) Part {
        std::atomic<int> taken{0}; ///< the last round in which somebody does it
        alignas(kCacheLine) Counter done;
    };

    void do_parts(Call call, void const* context) override {
        int const before = round_.get(), now = after(before);
        call_ = call;
        context_ = context;
        round_.set(now);
        take_parts(0, before, now);
        for (Part& p : parts_) {
            (void)p.done.wait_while(before);
        }
    }

    void help(int own) {
        for (int seen = 0;;) {
            int const now = round_.wait_while(seen);
            if (ending_) {
                return;
            }
            seen = now;
            take_parts(own, static_cast<int>(static_cast<unsigned>(now) - 1U), now);
        }
    }

    /// The own part first, then what nobody has begun. All parts of a round are taken before the next one begins: who
    /// comes late finds nothing.
    void take_parts(int own, int before, int now) {
        for (int k = 0; k < size(); ++k) {
            int const part = (own + k) % size();
            Part& p = parts_[static_cast<std::size_t>(part)];
            int expected = before;
            if (p.taken.compare_exchange_strong(expected, now)) {
                call_(context_, part);
                p.done.set(now);
            }
        }
    }

    Counter round_;
    std::atomic<bool> ending_{false};
    Call call_{nullptr};
    void const* context_{nullptr};
    std::vector<Part> parts_;
    std::vector<std::thread> threads_;
};

} // namespace

std::unique_ptr<Team> make_thread_team(int threads) {
    return std::make_unique<ThreadTeam>(threads);
}

} // namespace gridspace
