// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace {

/// Text for a pipe, a socket or a terminal whose other side may not read. Who writes never waits: what does not go at
/// once is kept in order up to a bound, and goes later. Not thread-safe.
class LineOutput {
  public:
    /// `fd` stays the caller's, and is left as it is: others may write to it too. -1: nothing is written.
    explicit LineOutput(int fd, std::size_t most_octets = std::size_t{1} << 20U);

    /// A line that counts. Beyond the bound it is left out, and counted.
    void put(std::string_view text);
    /// A line that is of no use any more when there is a newer one: only the newest is kept.
    void put_latest(std::string text);
    /// Writes what goes without waiting.
    void flush();
    /// Waits until everything is written, nobody can read it any more, or the patience (if any) is over.
    void drain(std::optional<std::chrono::milliseconds> patience);
    /// Hands over what is not written yet.
    [[nodiscard]] std::string take();

    [[nodiscard]] bool waits() const { return fd_ >= 0 && (!waiting_.empty() || !latest_.empty()); }
    [[nodiscard]] int fd() const { return own_ ? own_.get() : fd_; } ///< to poll for POLLOUT while it waits
    [[nodiscard]] std::uint64_t left_out() const { return left_out_; }

  private:
    /// How many octets went; 0: none at present.
    [[nodiscard]] std::size_t write_some(std::string_view text);
    int fd_;
    UniqueFd own_; ///< the same pipe or terminal, opened again, so that not waiting is only our way of writing
    bool is_socket_{false}, is_file_{false};
    std::size_t most_octets_;
    std::string waiting_, latest_;
    std::uint64_t left_out_{0};
};

} // namespace gridspace
