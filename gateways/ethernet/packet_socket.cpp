// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/ethernet/packet_socket.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fmt/format.h>
#include <linux/filter.h>
#include <linux/if_ether.h>
#include <linux/if_packet.h>
#include <sys/socket.h>

namespace gridspace::ethernet {
namespace {

#ifndef PACKET_IGNORE_OUTGOING
#define PACKET_IGNORE_OUTGOING 23
#endif

template <class T>
bool set(int fd, int level, int option, T const& value) {
    return ::setsockopt(fd, level, option, &value, sizeof value) == 0;
}

Error no_capability() {
    std::error_code ec;
    auto const program = std::filesystem::read_symlink("/proc/self/exe", ec);
    return {
        ExitCode::environment, "raw Ethernet frames need the capability CAP_NET_RAW, which this process does not have",
        fmt::format(
            "`sudo setcap cap_net_raw+ep {}`, or run it inside `gridspace run`; on a board as its service or as root",
            ec ? "PROGRAM" : program.string())};
}

/// A multicast group, all of them, or everything.
bool join(int fd, unsigned index, std::uint16_t type, Mac const& mac = {}) {
    packet_mreq request{};
    request.mr_ifindex = static_cast<int>(index);
    request.mr_type = type;
    request.mr_alen = 6;
    std::memcpy(request.mr_address, mac.octets.data(), 6);
    return set(fd, SOL_PACKET, PACKET_ADD_MEMBERSHIP, request);
}

void join_groups(PacketSocket const& socket, PortOptions const& options) {
    if (options.promiscuous) {
        join(socket.fd.get(), socket.index, PACKET_MR_PROMISC);
        return;
    }
    bool all = options.filter.destinations.empty();
    for (Mac const& mac : options.filter.destinations) {
        all = all || (mac.is_group() && !join(socket.fd.get(), socket.index, PACKET_MR_MULTICAST, mac));
    }
    if (all) { // any group: a publisher may use addresses outside of the recommended ranges
        join(socket.fd.get(), socket.index, PACKET_MR_ALLMULTI);
    }
}

bool attach(int fd, FrameFilter const& filter) {
    if (filter.empty()) {
        return true;
    }
    std::vector<sock_filter> program = filter.program();
    sock_fprog const code{static_cast<unsigned short>(program.size()), program.data()};
    return set(fd, SOL_SOCKET, SO_ATTACH_FILTER, code) && filter.kernel_decides();
}

} // namespace

Result<PacketSocket> make_socket(PortOptions const& options) {
    auto const index = interface_index(options.interface);
    if (!index) {
        return std::unexpected{index.error()};
    }
    PacketSocket out;
    out.index = *index;
    out.filter = options.filter;
    out.fd.reset(::socket(AF_PACKET, SOCK_RAW | SOCK_CLOEXEC | SOCK_NONBLOCK, 0)); // 0: no frames until bind()
    if (!out.fd) {
        if (errno == EPERM || errno == EACCES) {
            return std::unexpected{no_capability()};
        }
        return fail(ExitCode::environment, fmt::format("no raw socket: {}", std::strerror(errno)),
                    "is AF_PACKET in this kernel?");
    }
    int const fd = out.fd.get();
    if (!options.receive) {
        return out;
    }
    out.kernel_filters = attach(fd, options.filter);
    int const on = 1;
    set(fd, SOL_PACKET, PACKET_AUXDATA, on);
    set(fd, SOL_SOCKET, SO_TIMESTAMPNS, on);
    out.ignores_outgoing = !options.include_outgoing && set(fd, SOL_PACKET, PACKET_IGNORE_OUTGOING, on);
    auto const octets = static_cast<int>(options.receive_buffer);
    if (!set(fd, SOL_SOCKET, SO_RCVBUFFORCE, octets)) {
        set(fd, SOL_SOCKET, SO_RCVBUF, octets);
    }
    join_groups(out, options);
    return out;
}

Result<void> bind_socket(PacketSocket const& socket, PortOptions const& options) {
    // All protocols, and the filter decides: so frames are seen that carry a second tag, and those of a bridge's port.
    sockaddr_ll address{};
    address.sll_family = AF_PACKET;
    address.sll_ifindex = static_cast<int>(socket.index);
    address.sll_protocol = options.receive ? htons(ETH_P_ALL) : 0;
    if (::bind(socket.fd.get(), reinterpret_cast<sockaddr const*>(&address), sizeof address) != 0) {
        return fail(ExitCode::environment,
                    fmt::format("cannot use interface '{}': {}", options.interface, std::strerror(errno)));
    }
    return {};
}

KernelCounts take_counts(int fd) {
    tpacket_stats stats{};
    socklen_t size = sizeof stats;
    bool const known = ::getsockopt(fd, SOL_PACKET, PACKET_STATISTICS, &stats, &size) == 0;
    return known ? KernelCounts{stats.tp_packets, stats.tp_drops} : KernelCounts{}; // the packets hold the drops
}

std::uint8_t* restore_tag(std::uint8_t* frame, std::uint16_t tpid, std::uint16_t tci) noexcept {
    std::memmove(frame - 4, frame, 12);
    iec61850::store_be(frame + 8, tpid);
    iec61850::store_be(frame + 10, tci);
    return frame - 4;
}

} // namespace gridspace::ethernet
