// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <cstddef>
#include <cstdint>
#include <deque>
#include <functional>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::timebox {

/// A program of ours in a box, next to the one that the box is for, and what it exchanges with the box's owner.
struct DoorOptions {
    std::vector<std::string> command; ///< it finds the other end of the channel at kDoorFd
    /// A message of the door's, and the simulated time at which it has sent it.
    std::function<void(std::int64_t now_ns, std::span<std::byte const> message)> take;
};
inline constexpr int kDoorFd = 3;

/// Messages between a box and the door in it, at simulated times.
class DoorChannel {
  public:
    /// `ours`: of a pair of SOCK_SEQPACKET.
    DoorChannel(UniqueFd ours, decltype(DoorOptions::take) take);

    /// It is there at that time; in their order.
    void hand(std::int64_t at_ns, std::vector<std::byte> message);
    /// Gives what is due, and takes what the door has sent.
    void exchange(std::int64_t now_ns);
    [[nodiscard]] std::optional<std::int64_t> next_ns(std::int64_t now_ns) const;
    [[nodiscard]] std::uint64_t too_long() const { return too_long_; } ///< messages that did not fit

  private:
    struct Coming {
        std::int64_t at_ns;
        std::vector<std::byte> message;
    };
    UniqueFd ours_;
    decltype(DoorOptions::take) take_;
    std::deque<Coming> coming_;
    std::vector<std::byte> buffer_;
    std::uint64_t too_long_{0};
};

/// Both ends, for messages as long as the system allows.
struct DoorEnds {
    UniqueFd ours, theirs;
};
[[nodiscard]] DoorEnds make_door_ends();

} // namespace gridspace::timebox
