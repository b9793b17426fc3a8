// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/packet_calls.hpp"

#include <algorithm>
#include <cerrno>
#include <fcntl.h>
#include <linux/filter.h>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kLeastRoom = 2048; ///< of SO_RCVBUF, as in the kernel; which doubles what is asked for

/// What setsockopt(SO_ATTACH_FILTER) names, as the program has it: 64-bit pointers.
struct FilterArgument {
    std::uint16_t length;
    std::uint64_t address;
};

} // namespace

std::optional<std::int64_t> PacketCalls::option(Thread const& t, PacketSocket& socket, UniqueFd const& file) {
    auto const& a = t.call.arguments;
    if (static_cast<int>(a[1]) == SOL_PACKET) {
        return packet_option(t, socket, file);
    }
    if (static_cast<int>(a[1]) != SOL_SOCKET) {
        return -ENOPROTOOPT;
    }
    auto const value = value_at<int>(t.tid, a[3]);
    switch (static_cast<int>(a[2])) {
    case SO_TIMESTAMP:
    case SO_TIMESTAMPNS:
        socket.stamps = value != 0 ? static_cast<int>(a[2]) : 0;
        return 0;
    case SO_TIMESTAMPING:
        return refuse("SO_TIMESTAMPING (SO_TIMESTAMPNS of a packet socket can be had)", ENOPROTOOPT);
    case SO_RCVBUF:
    case SO_RCVBUFFORCE:
        socket.room = std::max<std::size_t>(2 * static_cast<std::size_t>(std::max(value, 0)), kLeastRoom);
        return 0;
    case SO_DETACH_FILTER:
        socket.filter.reset();
        return 0;
    case SO_ATTACH_FILTER: {
        auto const argument = value_at<FilterArgument>(t.tid, a[3]);
        std::vector<sock_filter> program(std::min<std::size_t>(argument.length, BPF_MAXINSNS));
        if (program.empty() ||
            !read_memory(t.tid, argument.address, program.data(), program.size() * sizeof(sock_filter))) {
            return -EINVAL;
        }
        auto filter = PacketFilter::make(std::move(program));
        if (!filter) {
            return refuse("a filter of frames that asks for what is not known in simulated time", EINVAL);
        }
        socket.filter = std::move(filter);
        return 0;
    }
    case SO_ATTACH_BPF:
        return refuse("SO_ATTACH_BPF (SO_ATTACH_FILTER can be had)", ENOPROTOOPT);
    case SO_BINDTODEVICE: {
        std::array<char, 16> name{};
        (void)read_memory(t.tid, a[3], name.data(), std::min<std::size_t>(a[4], name.size() - 1));
        if (sockets_.link().name != name.data()) {
            return refuse("a packet socket on another interface than '" + sockets_.link().name + "'", ENODEV);
        }
        socket.interface = sockets_.link().index;
        return 0;
    }
    default:
        return std::nullopt;
    }
}

std::optional<std::int64_t> PacketCalls::packet_option(Thread const& t, PacketSocket& socket, UniqueFd const& file) {
    auto const& a = t.call.arguments;
    auto const value = value_at<int>(t.tid, a[3]);
    switch (static_cast<int>(a[2])) {
    case PACKET_AUXDATA:
        socket.auxiliary = value != 0;
        return 0;
    case PACKET_IGNORE_OUTGOING:
        socket.ignores_outgoing = value != 0;
        return 0;
    case PACKET_ADD_MEMBERSHIP: // it sees all that comes, as on a virtual cable
    case PACKET_DROP_MEMBERSHIP:
    case PACKET_COPY_THRESH:
    case PACKET_QDISC_BYPASS:
    case PACKET_LOSS:
    case PACKET_TIMESTAMP: // there is one clock
        return 0;
    case PACKET_VERSION:
        if (value == TPACKET_V3) { // libpcap then asks for the version before
            return -EINVAL;
        }
        socket.version = value;
        return 0;
    case PACKET_RESERVE:
        socket.reserve = static_cast<unsigned>(value);
        return 0;
    case PACKET_RX_RING: {
        if (socket.version != TPACKET_V2) {
            return refuse("PACKET_RX_RING of TPACKET_V1 or V3 (V2 can be had)", ENOPROTOOPT);
        }
        PacketRing ring;
        ring.shape = value_at<tpacket_req>(t.tid, a[3]);
        ring.reserve = socket.reserve;
        if (ring.shape.tp_block_nr == 0) {
            socket.ring.reset();
            return 0;
        }
        if (socket.ring || !ring.is_sound()) {
            return socket.ring ? -EBUSY : -EINVAL;
        }
        ring.file.reset(::fcntl(file.get(), F_DUPFD_CLOEXEC, 0));
        socket.ring.emplace(std::move(ring));
        return 0;
    }
    case PACKET_TX_RING:
        return refuse("PACKET_TX_RING", ENOPROTOOPT);
    case PACKET_FANOUT:
        return refuse("PACKET_FANOUT", ENOPROTOOPT);
    default:
        return refuse("option " + std::to_string(a[2]) + " of a packet socket", ENOPROTOOPT);
    }
}

std::optional<std::int64_t> PacketCalls::look_at_option(Thread const& t, PacketSocket& socket) const {
    auto const& a = t.call.arguments;
    auto const level = static_cast<int>(a[1]), name = static_cast<int>(a[2]);
    auto const room = value_at<socklen_t>(t.tid, a[4]);
    auto const say = [&](auto const& value) -> std::int64_t {
        auto const size = std::min<socklen_t>(room, sizeof value);
        (void)write_memory(t.tid, a[3], &value, size);
        put(t.tid, a[4], size);
        return 0;
    };
    if (level == SOL_SOCKET) {
        return name == SO_TYPE     ? std::optional{say(socket.kind)}
               : name == SO_DOMAIN ? std::optional{say(int{AF_PACKET})}
               : name == SO_RCVBUF ? std::optional{say(static_cast<int>(socket.room))}
                                   : std::nullopt;
    }
    if (level != SOL_PACKET) {
        return -ENOPROTOOPT;
    }
    switch (name) {
    case PACKET_STATISTICS:
        return say(std::exchange(socket.counted, {}));
    case PACKET_VERSION:
        return say(socket.version);
    case PACKET_HDRLEN: {
        auto const version = value_at<int>(t.tid, a[3]);
        return version == TPACKET_V2 ? say(static_cast<int>(sizeof(tpacket2_hdr))) : -EINVAL;
    }
    case PACKET_AUXDATA:
        return say(socket.auxiliary ? 1 : 0);
    case PACKET_RESERVE:
        return say(socket.reserve);
    default:
        return -ENOPROTOOPT;
    }
}

} // namespace gridspace::timebox
