// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_link.hpp"

#include <cstdint>
#include <deque>
#include <list>
#include <memory>
#include <optional>
#include <span>
#include <vector>

struct udp_pcb; // NOLINT(readability-identifier-naming): lwIP calls it so
struct raw_pcb; // NOLINT(readability-identifier-naming)

namespace gridspace::timebox {

class UdpEnds;

struct Datagram {
    IpEndpoint from;
    std::uint32_t to{0}; ///< its destination
    std::vector<std::uint8_t> octets;
};

/// One socket of UDP.
class UdpEnd {
  public:
    ~UdpEnd();
    UdpEnd(UdpEnd const&) = delete;
    UdpEnd& operator=(UdpEnd const&) = delete;

    /// Each 0, or an error number of the call that it is named after.
    [[nodiscard]] int bind(IpEndpoint const& to, bool reuse);
    [[nodiscard]] int connect(IpEndpoint const& to);
    void disconnect();
    /// Nothing: to whom it is connected.
    [[nodiscard]] int send(std::span<std::uint8_t const> octets, std::optional<IpEndpoint> to);

    [[nodiscard]] std::deque<Datagram>& queue() { return queue_; }
    [[nodiscard]] std::size_t waiting_octets() const { return used_; }
    [[nodiscard]] Datagram pop();
    /// That an ICMP message has brought, once: ECONNREFUSED.
    [[nodiscard]] int take_error();
    [[nodiscard]] bool has_error() const { return error_ != 0; }
    [[nodiscard]] IpEndpoint local() const;
    [[nodiscard]] std::optional<IpEndpoint> remote() const { return remote_; }

    std::size_t room{212'992}; ///< octets that wait at most (SO_RCVBUF)
    void set_header(std::uint8_t service, std::uint8_t time_to_live);
    void set_broadcast(bool on);
    void set_multicast(std::uint8_t time_to_live, bool loop);

  private:
    friend class UdpEnds;
    explicit UdpEnd(UdpEnds& all);
    void push(Datagram datagram);

    UdpEnds& all_;
    udp_pcb* pcb_;
    std::deque<Datagram> queue_;
    std::size_t used_{0};
    std::optional<IpEndpoint> remote_;
    int error_{0};
    bool settled_{false}; ///< its own address, by connect()
};

class UdpEnds {
  public:
    UdpEnds();
    ~UdpEnds();
    UdpEnds(UdpEnds const&) = delete;
    UdpEnds& operator=(UdpEnds const&) = delete;
    [[nodiscard]] std::unique_ptr<UdpEnd> make();

    struct Events;

  private:
    friend class UdpEnd;
    std::list<UdpEnd*> ends_;
    raw_pcb* icmp_; ///< hears that a port is not there
};

} // namespace gridspace::timebox
