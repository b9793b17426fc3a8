// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/codec.hpp"
#include "common/time.hpp"

#include <algorithm>
#include <cstdint>
#include <mutex>
#include <span>
#include <string>
#include <tuple>
#include <vector>

namespace gridspace::bus {

/// Where a delivered sample comes from; the order of samples of one instant is (process, writer, sequence).
struct Origin {
    SimTime time;             ///< when it takes effect
    std::uint32_t process{0}; ///< index in the order of process names
    std::uint32_t writer{0};
    std::uint64_t sequence{0};
    friend auto operator<=>(Origin const&, Origin const&) = default;
};

template <class T>
struct Received {
    Origin origin;
    T value;
};

/// Samples that have arrived and wait for their time. Filled by receiving threads, emptied by the process's own thread.
class Inbox {
  public:
    virtual ~Inbox() = default;
    /// Called on the receiving thread. A sample that has a field time_ns overrides the time in `origin` with it.
    /// False when the sample cannot be decoded.
    virtual bool push(std::span<std::byte const> cdr, Origin origin, TimeBase const& base) = 0;
    [[nodiscard]] virtual bool has_due(SimTime until) const = 0;

    /// Samples up to this instant may be taken; set by the node when a tick is granted.
    void release(SimTime until) {
        std::lock_guard const lock{mutex_};
        until_ = until;
    }

  protected:
    mutable std::mutex mutex_;
    SimTime until_{INT64_MIN};
};

namespace detail {
template <class T>
concept HasTimeStamp = requires(T const& t) {
    { t.time_ns() } -> std::convertible_to<std::int64_t>;
};
} // namespace detail

/// The reading end of a topic, shared with the receiving thread. A sample becomes visible in the tick that contains its
/// time, in an order that does not depend on the network.
template <class T>
class Reader final : public Inbox {
  public:
    /// What is due now, oldest first. The span is valid until the next call.
    [[nodiscard]] std::span<Received<T> const> take() {
        std::lock_guard const lock{mutex_};
        due_.clear();
        auto const later = std::partition(waiting_.begin(), waiting_.end(),
                                          [&](Received<T> const& r) { return r.origin.time <= until_; });
        due_.insert(due_.end(), std::make_move_iterator(waiting_.begin()), std::make_move_iterator(later));
        waiting_.erase(waiting_.begin(), later);
        std::sort(due_.begin(), due_.end(), [](auto const& a, auto const& b) { return a.origin < b.origin; });
        return due_;
    }

    bool push(std::span<std::byte const> cdr, Origin origin, TimeBase const& base) override {
        Received<T> received{origin, {}};
        if (!codec_of<T>().decode(cdr, &received.value)) {
            return false;
        }
        if constexpr (detail::HasTimeStamp<T>) {
            received.origin.time = base.from_nanoseconds(received.value.time_ns());
        }
        std::lock_guard const lock{mutex_};
        waiting_.push_back(std::move(received));
        return true;
    }
    [[nodiscard]] bool has_due(SimTime until) const override {
        std::lock_guard const lock{mutex_};
        return std::any_of(waiting_.begin(), waiting_.end(),
                           [&](Received<T> const& r) { return r.origin.time <= until; });
    }

  private:
    std::vector<Received<T>> waiting_;
    std::vector<Received<T>> due_;
};

/// Samples of any type as octets.
struct CdrSample {
    std::vector<std::byte> cdr;
};

class CdrReader final : public Inbox {
  public:
    /// In real time nobody waits for this reader: what comes when so many octets wait already is dropped, and counted.
    void bound(std::size_t octets);
    [[nodiscard]] std::uint64_t dropped() const;
    /// What is due now, oldest first.
    [[nodiscard]] std::vector<Received<CdrSample>> take();
    bool push(std::span<std::byte const> cdr, Origin origin, TimeBase const& base) override;
    [[nodiscard]] bool has_due(SimTime until) const override;

  private:
    std::vector<Received<CdrSample>> waiting_;
    std::size_t waiting_octets_{0}, bound_{SIZE_MAX};
    std::uint64_t dropped_{0};
};

} // namespace gridspace::bus
