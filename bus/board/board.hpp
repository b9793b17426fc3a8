// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <atomic>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <vector>

namespace gridspace::bus {

/// Memory that the members of a lockstep run on one machine share: each has a place on which it alone writes what it
/// says to the others, clocks and acknowledgements as they would go over DDS, and a bell that others ring. There are no
/// locks: who is killed holds nobody up, and what it had not finished nobody sees. It is handed on as a descriptor by
/// whoever starts the processes.
class Board {
  public:
    /// For so many processes: memory without a name.
    [[nodiscard]] static Result<UniqueFd> create(std::size_t places);
    /// `processes`: all that have a place, in the same order in each of them; `self`: who this is.
    [[nodiscard]] static Result<std::unique_ptr<Board>> join(UniqueFd memory, std::vector<std::string> processes,
                                                             std::string const& self);
    ~Board();
    Board(Board const&) = delete;
    Board& operator=(Board const&) = delete;

    [[nodiscard]] std::size_t place_of(std::string const& process) const; ///< size() when it has none
    [[nodiscard]] std::size_t size() const { return processes_.size(); }
    [[nodiscard]] std::size_t self() const { return self_; }

    /// Says something. `time_ns` and `number` come with it. False: it is too long.
    [[nodiscard]] bool post(std::span<std::byte const> message, std::int64_t time_ns, std::uint64_t number);
    struct Message {
        std::span<std::byte const> octets; ///< valid inside the call
        std::int64_t time_ns{0};
        std::uint64_t number{0};
    };
    /// What the process on `place` has said since the last call. False: it has said more than is kept.
    [[nodiscard]] bool read(std::size_t place, std::function<void(Message const&)> const& take);
    /// What has been said so far is not for this process.
    void skip(std::size_t place);

    /// `place` is waiting for so many things until it has something to do; the last ring() of them wakes it.
    void expect(std::size_t place, std::int32_t things);
    /// One of the things is there.
    void ring(std::size_t place);
    /// Wakes it whatever it expects.
    void wake(std::size_t place);

    /// Of the own bell: take it before looking at what has been said, and wait with it.
    [[nodiscard]] std::uint32_t bell() const;
    /// Until the bell has been rung since, at most `longest`.
    void wait(std::uint32_t heard, std::chrono::nanoseconds longest);

    static constexpr std::size_t kRing = 1U << 19U; ///< octets of a place: many ticks
    static constexpr std::size_t kLongest = kRing / 8;
    struct Place;

  private:
    Board() = default;
    [[nodiscard]] Place& at(std::size_t place) const;

    std::vector<std::string> processes_;
    std::size_t self_{0}, mapped_{0};
    Place* places_{nullptr};
    std::vector<std::uint64_t> read_until_; ///< by place
    std::vector<std::byte> message_;        ///< reused
};

} // namespace gridspace::bus
