// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "timebox/tracee.hpp"

#include <cstdint>
#include <optional>
#include <span>
#include <vector>

namespace gridspace::timebox {

/// A descriptor of a program, and what is waited for (events of poll(2)).
struct Interest {
    int fd{-1};
    short events{0};
};

/// How long a call waits.
struct DescriptorWait {
    std::optional<std::int64_t> timeout_ns; ///< from now; nothing: without end; 0: it only looks
    std::uint64_t signal_mask_at{0};        ///< that holds while it waits; 0: the thread's own
};
/// Of poll, ppoll, select, pselect6, epoll_wait, epoll_pwait, epoll_pwait2.
[[nodiscard]] DescriptorWait wait_of(pid_t tid, Call const& call);
/// And for what.
[[nodiscard]] std::vector<Interest> interests_of(pid_t tid, Call const& call);

/// The descriptors of one process, from outside (pidfd_getfd(2)).
class Descriptors {
  public:
    explicit Descriptors(pid_t process);
    [[nodiscard]] UniqueFd copy_of(int fd) const; ///< of the same open file; none: it is not open
    [[nodiscard]] bool any_ready(std::span<Interest const> interests) const;
    /// The result of such a call now; what it found is written unless it goes on waiting, which is 0 as long as its
    /// time is not over.
    [[nodiscard]] std::int64_t look(pid_t tid, Call const& call, bool over) const;
    /// Waits for that in real time, for what comes from outside of the box.
    [[nodiscard]] bool wait_outside(std::span<Interest const> interests, int timeout_ms) const;

  private:
    [[nodiscard]] bool poll(std::span<Interest const> interests, int timeout_ms) const;
    UniqueFd process_;
};

// Of a file that copy_of() has given; also of none.
[[nodiscard]] bool does_not_block(UniqueFd const& file);
[[nodiscard]] bool is_ready(UniqueFd const& file, short event); ///< also: the call itself will say what is wrong
/// SO_RCVTIMEO or SO_SNDTIMEO, rounded up to the kernel's ticks; nothing: without end.
[[nodiscard]] std::optional<std::int64_t> timeout_ns(UniqueFd const& file, int option);
[[nodiscard]] std::optional<std::int64_t> receive_timeout_ns(UniqueFd const& file);

} // namespace gridspace::timebox
