// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/instance.hpp"

#include <atomic>
#include <chrono>
#include <condition_variable>
#include <cstdint>
#include <mutex>
#include <string>
#include <thread>

namespace gridspace::agents {

/// Watches over the calls into an FMU. One that crashes, aborts, ends the process or does not come back ends this
/// process with exit code 4 and a line that names FMU, function and time, in the log and for the launcher. One in a
/// process. Calls come from the thread that made it.
class CallGuard final : public fmi::Host {
  public:
    /// `status_fd`: where the launcher listens; -1: nobody does.
    CallGuard(std::string const& fmu, int status_fd);
    ~CallGuard() override;
    CallGuard(CallGuard const&) = delete;
    CallGuard& operator=(CallGuard const&) = delete;

    /// How long a call may take, of the wall; 0: for ever (a debugger is attached).
    void patience(double seconds) { patience_ms_ = static_cast<std::int64_t>(seconds * 1e3); }
    /// Simulated time, for messages.
    void now(double seconds);

    void enter(char const* function) noexcept override;
    void leave() noexcept override;
    void say(fmi::Status status, std::string_view category, std::string_view message) noexcept override;

  private:
    void watch(std::stop_token const& stop);

    std::string fmu_;
    std::atomic<std::int64_t> patience_ms_{0};
    std::atomic<std::uint64_t> calls_{0}; ///< odd: within one
    std::uint64_t messages_{0};
    std::mutex mutex_;
    std::condition_variable_any asked_to_stop_;
    std::jthread watcher_; ///< last: it uses the others
};

} // namespace gridspace::agents
