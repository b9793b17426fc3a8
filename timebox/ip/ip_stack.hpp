// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_link.hpp"

#include <cstdint>
#include <functional>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::timebox {

/// IPv4 of a box, driven by simulated time alone: lwIP, whose clock and random numbers are ours. It makes and reads
/// Ethernet frames; 127.0.0.1 and its own address lead back to itself at the same instant. lwIP has one state per
/// process: so there is one of these at a time, and one thread uses it.
class IpStack {
  public:
    /// A frame leaves. What is refused, or nothing.
    using Send = std::function<std::string(std::span<std::uint8_t const>)>;
    IpStack(IpLink const& link, std::uint64_t seed, Send send);
    ~IpStack();
    IpStack(IpStack const&) = delete;
    IpStack& operator=(IpStack const&) = delete;

    /// Simulated time has got so far: what is due by then (retransmissions, keepalives) is done.
    void elapse_to(std::int64_t now_ns);
    /// Nothing more happens at this instant: what has come and is not answered is acknowledged. lwIP would wait up to
    /// 250 ms for an answer that takes the acknowledgement along.
    void acknowledge();
    /// When something is due by itself.
    [[nodiscard]] std::int64_t next_ns() const;
    /// A frame has come. What is not IPv4 for this box is passed over.
    void receive(std::span<std::uint8_t const> frame);
    /// Carries out what leads back to itself. After every use of what is in tcp_end.hpp and udp_end.hpp.
    void settle();

    [[nodiscard]] IpLink const& link() const;
    [[nodiscard]] bool reaches(std::uint32_t address) const; ///< there is somebody, or it is the box itself
    [[nodiscard]] bool is_broadcast(std::uint32_t address) const;
    void join(std::uint32_t group);
    void leave(std::uint32_t group);
    [[nodiscard]] std::vector<std::string> take_refused();

    struct Impl;

  private:
    std::unique_ptr<Impl> impl_;
};

} // namespace gridspace::timebox
