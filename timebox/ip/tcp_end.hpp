// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_link.hpp"

#include <cstdint>
#include <deque>
#include <memory>
#include <span>
#include <vector>

struct tcp_pcb; // NOLINT(readability-identifier-naming): lwIP calls it so

namespace gridspace::timebox {

/// One end of a TCP connection. It keeps what has come until somebody takes it; who takes nothing closes the window.
class TcpEnd {
  public:
    TcpEnd() = default;
    ~TcpEnd(); ///< resets what is not closed
    TcpEnd(TcpEnd const&) = delete;
    TcpEnd& operator=(TcpEnd const&) = delete;

    /// 0, or an error number of bind(2), connect(2).
    [[nodiscard]] int bind(IpEndpoint const& to, bool reuse);
    [[nodiscard]] int connect(IpEndpoint const& to);
    void adopt(tcp_pcb* pcb); ///< that a listener has got

    [[nodiscard]] bool is_connected() const { return connected_; }
    [[nodiscard]] int error() const { return error_; } ///< it has ended by that
    [[nodiscard]] bool has_ended() const { return pcb_ == nullptr; }
    [[nodiscard]] bool peer_has_finished() const { return finished_; } ///< behind what has come, nothing will come
    [[nodiscard]] std::vector<std::uint8_t> const& received() const { return received_; }
    void take(std::size_t octets); ///< the first of these are the reader's

    [[nodiscard]] std::size_t room() const;          ///< octets that send() would take
    std::size_t send(std::span<std::uint8_t const>); ///< how many it has taken
    void finish();                                   ///< nothing more will be sent
    /// When both sides have finished, lwIP goes on without it, and forgets the connection when it likes.
    void let_go_when_finished();
    void close(); ///< it is sent to the end; nothing more is wanted
    void reset();

    struct Options {
        bool no_delay{false}, keep_alive{false};
        std::uint8_t service{0}, time_to_live{255}; ///< of its packets
        std::uint32_t keep_idle_s{7200}, keep_interval_s{75}, keep_count{9};
    };
    void set(Options const& options);
    [[nodiscard]] IpEndpoint local() const { return local_; }
    [[nodiscard]] IpEndpoint remote() const { return remote_; }

    struct Events; ///< of lwIP

  private:
    friend class TcpListener;
    void forget(); ///< lwIP tells it nothing any more
    void note_names();

    tcp_pcb* pcb_{nullptr};
    bool connected_{false}, finished_{false}, finishing_{false};
    int error_{0};
    std::vector<std::uint8_t> received_;
    IpEndpoint local_, remote_;
};

class TcpListener {
  public:
    /// Takes the place of an end that is bound. 0, or an error number.
    [[nodiscard]] static int listen(TcpEnd& end, std::unique_ptr<TcpListener>& out);
    ~TcpListener();
    TcpListener(TcpListener const&) = delete;
    TcpListener& operator=(TcpListener const&) = delete;

    [[nodiscard]] std::deque<std::unique_ptr<TcpEnd>>& accepted() { return accepted_; }
    [[nodiscard]] IpEndpoint local() const { return local_; }

    struct Events;

  private:
    TcpListener() = default;
    tcp_pcb* pcb_{nullptr}; ///< of another kind in truth
    std::deque<std::unique_ptr<TcpEnd>> accepted_;
    IpEndpoint local_;
};

} // namespace gridspace::timebox
