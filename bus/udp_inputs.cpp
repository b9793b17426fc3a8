// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/udp_inputs.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <array>
#include <cerrno>
#include <netinet/in.h>
#include <sys/socket.h>

namespace gridspace::bus {
namespace {

constexpr std::size_t kBatch = 16;

/// Where datagrams are put; of the thread that looks, whichever that is.
struct Batch {
    std::vector<std::uint8_t> octets;
    std::array<mmsghdr, kBatch> messages{};
    std::array<iovec, kBatch> parts{};
    std::array<sockaddr_in, kBatch> from{};

    void prepare(std::size_t longest) {
        if (octets.size() < kBatch * longest) {
            octets.resize(kBatch * longest);
        }
        for (std::size_t i = 0; i < kBatch; ++i) {
            parts[i] = {octets.data() + i * longest, longest};
            messages[i].msg_hdr = {};
            messages[i].msg_hdr.msg_name = &from[i];
            messages[i].msg_hdr.msg_namelen = sizeof from[i];
            messages[i].msg_hdr.msg_iov = &parts[i];
            messages[i].msg_hdr.msg_iovlen = 1;
        }
    }
};

thread_local Batch t_batch;

in_addr address_of(std::string const& text) {
    in_addr out{};
    ::inet_pton(AF_INET, text.c_str(), &out);
    return out;
}

} // namespace

struct UdpInput::Socket {
    UniqueFd fd;
    std::size_t longest;
    OnDatagram const* on_datagram;
    OnDatagram own; ///< of the first one of a port; the others share it
    std::unique_ptr<Receiving::Source> source;

    void take() const {
        Batch& batch = t_batch;
        batch.prepare(longest);
        int count = ::recvmmsg(fd.get(), batch.messages.data(), kBatch, MSG_DONTWAIT, nullptr);
        if (count < 0 && errno == ENOSYS) { // an emulator
            ssize_t const size = ::recvmsg(fd.get(), &batch.messages[0].msg_hdr, MSG_DONTWAIT);
            batch.messages[0].msg_len = size < 0 ? 0 : static_cast<unsigned>(size);
            count = size < 0 ? 0 : 1;
        }
        for (std::size_t i = 0; i < static_cast<std::size_t>(std::max(count, 0)); ++i) {
            std::span const datagram{static_cast<std::uint8_t*>(batch.parts[i].iov_base), batch.messages[i].msg_len};
            if (!datagram.empty()) {
                (*on_datagram)(datagram, ntohl(batch.from[i].sin_addr.s_addr), ntohs(batch.from[i].sin_port));
            }
        }
    }
};

UdpInput::~UdpInput() {
    for (auto const& socket : sockets_) {
        socket->source.reset(); // before anything that its take() uses
    }
}

std::unique_ptr<UdpInput> UdpInput::open(Options const& options, OnDatagram on_datagram) {
    auto out = std::unique_ptr<UdpInput>{new UdpInput};
    bool const multicast = !options.group.empty();
    auto const bind = [&](std::string const& address) -> Socket* {
        auto socket = std::make_unique<Socket>();
        socket->fd.reset(::socket(AF_INET, SOCK_DGRAM | SOCK_CLOEXEC | SOCK_NONBLOCK, 0));
        int const fd = socket->fd.get();
        if (auto const size = static_cast<int>(options.receive_buffer); size > 0) {
            (void)::setsockopt(fd, SOL_SOCKET, SO_RCVBUF, &size, sizeof size);
        }
        int const on = 1;
        if (multicast) { // everybody on this machine listens to it
            (void)::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &on, sizeof on);
        }
        sockaddr_in at{};
        at.sin_family = AF_INET;
        at.sin_addr = address_of(address);
        at.sin_port = htons(options.port);
        if (fd < 0 || ::bind(fd, reinterpret_cast<sockaddr const*>(&at), sizeof at) != 0) {
            return nullptr;
        }
        socket->longest = options.longest;
        out->sockets_.push_back(std::move(socket));
        return out->sockets_.back().get();
    };
    for (std::string const& interface : options.interfaces) {
        if (bind(interface) == nullptr) {
            return nullptr;
        }
    }
    if (multicast) {
        Socket const* const group = bind(options.group);
        if (group == nullptr) {
            return nullptr;
        }
        for (std::string const& interface : options.interfaces) {
            ip_mreq const request{address_of(options.group), address_of(interface)};
            (void)::setsockopt(group->fd.get(), IPPROTO_IP, IP_ADD_MEMBERSHIP, &request, sizeof request);
        }
    }
    out->sockets_.front()->own = std::move(on_datagram);
    for (auto const& socket : out->sockets_) {
        socket->on_datagram = &out->sockets_.front()->own;
        socket->source = std::make_unique<Receiving::Source>(Receiving::of_process(), socket->fd.get(),
                                                             [raw = socket.get()] { raw->take(); });
    }
    return out;
}

} // namespace gridspace::bus
