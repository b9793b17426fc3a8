// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/cable/stream.hpp"
#include "gateways/cable/tap.hpp"

#include <string>
#include <string_view>
#include <vector>

namespace gridspace::cable {

/// Where a program's status lines leave; its own words say so too.
inline constexpr int kStatusFd = 3;

/// Octets that wait for a descriptor that does not block.
class Outlet {
  public:
    explicit Outlet(int fd);
    void send(Kind kind, std::string_view bytes = {}) { append(waiting_, kind, bytes); }
    void send(Kind kind, std::uint8_t port, std::string_view bytes) { append(waiting_, kind, port, bytes); }
    /// Writes what can be written; false when nobody reads any more.
    bool flush();
    [[nodiscard]] bool empty() const { return waiting_.size() == written_; }
    /// So much waits that frames shall wait too, in the queue of their device.
    [[nodiscard]] bool full() const { return waiting_.size() - written_ > (1U << 20U); }
    [[nodiscard]] int fd() const { return fd_; }
    [[nodiscard]] std::size_t held() const { return waiting_.size(); } ///< octets, also written ones

  private:
    int fd_;
    std::string waiting_;
    std::size_t written_{0};
};

/// All frames that wait in a tap device, into the stream.
void forward_frames(int tap, std::uint8_t port, Outlet& out);

/// On the board: interfaces in a network namespace of their own, and the program in it, as the other end says on
/// standard input; answers on standard output. `bundle` holds bin/ and lib/. Returns the program's exit code.
int far_end(std::string const& bundle);

/// On the board: what the far end needs is there. Reasons on standard error; 0 or 3.
int check_far_end();

struct NearEnd {
    std::string place;                ///< "root@board", for messages
    double patience_s{6};             ///< silence that means that the connection is lost; 0: any
    std::string folder;               ///< files for the board, removed when they have been sent
    std::string outer_network;        ///< file of the network namespace in which ssh runs; empty: this one
    std::vector<std::string> ports;   ///< "NAME,MAC,ADDRESS:TAP", the tap being a device of this namespace
    std::vector<std::string> program; ///< and its arguments
    std::vector<std::string> ssh;     ///< the command that starts the far end
};

/// Next to the launcher: starts the far end over ssh and carries frames between it and the taps. The program's status
/// lines leave on descriptor 3, what it prints on standard output. Returns the program's exit code.
int near_end(NearEnd const& options);

} // namespace gridspace::cable
