// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "timebox/ip/tcp_end.hpp"
#include "timebox/ip/udp_end.hpp"

#include <deque>
#include <list>
#include <map>
#include <memory>
#include <set>
#include <string>

namespace gridspace::timebox {

/// An IP socket of a program. What the kernel has in its place is a socket of the family unix. A stream's is connected
/// to one of ours, so the kernel itself does what can be done with a stream: it wakes, counts, duplicates, closes. A
/// datagram socket's is readable while a mark of ours lies in it.
struct IpSocket {
    std::uint64_t inode{0};
    std::string stand_in; ///< address of the kernel's socket (unix(7))
    bool stream{false};

    // As setsockopt(2) has set them:
    bool reuse{false}, broadcast{false}, resets_at_close{false}, packet_info{false};
    TcpEnd::Options tcp_options;
    std::uint8_t multicast_ttl{1};
    bool multicast_loop{true};
    int send_room{87'040}, receive_room{131'072};
    std::map<std::pair<int, int>, int> remembered; ///< options without an effect here

    // A stream:
    enum class State { idle, connecting, open, listening, over } state{State::idle};
    std::unique_ptr<TcpEnd> tcp;
    std::unique_ptr<TcpListener> listener;
    UniqueFd ours; ///< the other end
    int error{0};  ///< SO_ERROR
    bool told_end{false};
    IpEndpoint local, remote;
    std::list<IpSocket> unaccepted; ///< in the kernel's queue of the listener, in this order

    // Datagrams:
    std::unique_ptr<UdpEnd> udp;
    int marks{0};
    std::set<std::uint32_t> groups;
};

} // namespace gridspace::timebox
