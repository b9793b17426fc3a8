// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/spsc_ring.hpp"
#include "common/time.hpp"

#include <atomic>
#include <functional>
#include <optional>
#include <thread>

namespace gridspace::sim {

/// Real time: DDS writes happen here, so that the simulating thread never waits for a socket. It only says that a tick
/// has ended and may be published.
class PublisherThread {
  public:
    /// `publish` writes everything of a tick, on this thread.
    explicit PublisherThread(std::function<Result<void>(SimTime end, bool final)> publish);
    ~PublisherThread(); ///< leaves out what has not been written
    PublisherThread(PublisherThread const&) = delete;
    PublisherThread& operator=(PublisherThread const&) = delete;

    /// From the simulating thread; does not wait. False when the thread has failed or is hundreds of ticks behind.
    [[nodiscard]] bool tick_ended(SimTime end, bool final);
    [[nodiscard]] bool failed() const { return failed_; }
    /// Waits until everything has been written; why it could not be, otherwise.
    [[nodiscard]] Result<void> finish();

  private:
    struct Tick {
        SimTime end;
        bool final{false};
    };
    void loop();

    static constexpr std::size_t kTicks = 4096;
    std::function<Result<void>(SimTime, bool)> publish_;
    SpscRing<Tick> ticks_{kTicks};
    std::atomic<std::uint32_t> bell_{0};
    std::atomic<bool> stop_{false}, failed_{false};
    std::optional<Error> error_; ///< of the thread; read after its end
    std::thread thread_;
};

} // namespace gridspace::sim
