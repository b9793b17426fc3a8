// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <functional>
#include <mutex>
#include <thread>

namespace gridspace::bus {

/// Everything that a process hears, received by one thread: its own, while it waits (Turn), or one that exists for
/// that. So nothing is handed over from a receiving thread to the working one, and a process wakes up once. While the
/// process's own thread works, the other one looks now and then, so that no buffer of the kernel overflows.
class Receiving {
  public:
    [[nodiscard]] static Receiving& of_process();
    Receiving();
    ~Receiving();
    Receiving(Receiving const&) = delete;
    Receiving& operator=(Receiving const&) = delete;

    /// Takes what there is, without waiting.
    using Take = std::function<void()>;
    /// A descriptor that is listened to for as long as this lives. When it is gone nobody is inside `take` any more; it
    /// must not go while its own `take` is running.
    class Source {
      public:
        Source(Receiving& receiving, int fd, Take take);
        ~Source();
        Source(Source const&) = delete;
        Source& operator=(Source const&) = delete;

      private:
        friend class Receiving;
        Receiving& receiving_;
        int fd_;
        Take take_;
    };

    /// The calling thread receives while it waits, for as long as this lives; unless another one does already.
    class Turn {
      public:
        explicit Turn(Receiving& receiving);
        ~Turn();
        Turn(Turn const&) = delete;
        Turn& operator=(Turn const&) = delete;
        /// Waits until something may have changed, at most `longest`: takes what comes, with the lock given back
        /// meanwhile, or waits for who does.
        void wait(std::unique_lock<std::mutex>& lock, std::condition_variable& changed,
                  std::chrono::nanoseconds longest);

      private:
        void take_turn();
        Receiving& receiving_;
        bool mine_{false};
    };

    /// Ends a wait() of another thread, also one that has not begun in a Turn that has.
    void wake();

  private:
    void look(std::chrono::nanoseconds longest); ///< with `looking_` held
    void run();                                  ///< the other thread
    void let_go() const;                         ///< whoever waits for `looking_` to be free, first
    void start_thread();

    UniqueFd epoll_, bell_;
    std::mutex looking_;                ///< who looks
    std::atomic<int> waiting_to_go_{0}; ///< sources that wait for `looking_`
    std::atomic<bool> has_turn_{false}, has_worker_{false}, stop_{false};
    std::atomic<std::thread::id> worker_{};
    std::once_flag started_;
    std::thread thread_;
};

} // namespace gridspace::bus
