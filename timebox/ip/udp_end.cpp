// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/ip/udp_end.hpp"

#include "timebox/ip/lwip_address.hpp"

#include <cerrno>
#include <lwip/ip.h>
#include <lwip/raw.h>
#include <lwip/udp.h>
#include <utility>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kLongestDatagram = 65'507;
constexpr std::size_t kDatagramBookkeeping =
    768; ///< what the kernel charges a buffer for a datagram besides its octets, about

bool goes_to_many(std::uint32_t address) {
    return (address >> 28U) == 0xE || ip4_addr_isbroadcast_u32(lwip_htonl(address), ip_current_netif()) != 0;
}

} // namespace

struct UdpEnds::Events {
    static void received(void* self, udp_pcb*, pbuf* packet, ip_addr_t const* from, u16_t port) {
        auto& end = *static_cast<UdpEnd*>(self);
        Datagram datagram{{address_of(*from), port}, lwip_ntohl(ip4_current_dest_addr()->addr), {}};
        datagram.octets.resize(packet->tot_len);
        pbuf_copy_partial(packet, datagram.octets.data(), packet->tot_len, 0);
        pbuf_free(packet);
        if (!goes_to_many(datagram.to)) {
            end.push(std::move(datagram));
            return;
        }
        for (UdpEnd* const each : end.all_.ends_) { // lwIP gives it to the first alone
            IpEndpoint const bound = each->local();
            bool const fits = bound.port == end.local().port && (bound.address == 0 || bound.address == datagram.to);
            if (fits && (!each->remote_ || *each->remote_ == datagram.from)) {
                each->push(datagram);
            }
        }
    }

    /// RFC 792: behind 8 octets, the header and 8 octets of what could not be delivered.
    static u8_t icmp(void* self, raw_pcb*, pbuf* packet, ip_addr_t const*) {
        constexpr u16_t kHeader = 20, kIcmp = 8;
        auto const octet = [&](u16_t at) { return pbuf_get_at(packet, at); };
        u16_t const inner = kHeader + kIcmp, udp = inner + kHeader;
        if (packet->tot_len >= udp + 8 && octet(kHeader) == 3 && octet(kHeader + 1) == 3 && octet(inner + 9) == 17) {
            auto const port = [&](int at) {
                return static_cast<std::uint16_t>(octet(static_cast<u16_t>(at)) << 8U |
                                                  octet(static_cast<u16_t>(at + 1)));
            };
            std::uint32_t to = 0;
            for (u16_t i = 0; i < 4; ++i) {
                to = to << 8U | octet(static_cast<u16_t>(inner + 16 + i));
            }
            for (UdpEnd* const each : static_cast<UdpEnds*>(self)->ends_) {
                if (each->local().port == port(udp) && each->remote_ == IpEndpoint{to, port(udp + 2)}) {
                    each->error_ = ECONNREFUSED;
                }
            }
        }
        return 0; // others look at it too
    }
};

UdpEnds::UdpEnds() : icmp_{raw_new_ip_type(IPADDR_TYPE_V4, IP_PROTO_ICMP)} {
    raw_recv(icmp_, Events::icmp, this);
}
UdpEnds::~UdpEnds() {
    raw_remove(icmp_);
}

std::unique_ptr<UdpEnd> UdpEnds::make() {
    return std::unique_ptr<UdpEnd>{new UdpEnd{*this}};
}

UdpEnd::UdpEnd(UdpEnds& all) : all_{all}, pcb_{udp_new_ip_type(IPADDR_TYPE_V4)} {
    udp_recv(pcb_, UdpEnds::Events::received, this);
    udp_set_multicast_ttl(pcb_, 1);
    set_multicast(1, true);
    all_.ends_.push_back(this);
}

UdpEnd::~UdpEnd() {
    all_.ends_.remove(this);
    udp_remove(pcb_);
}

void UdpEnd::push(Datagram datagram) {
    std::size_t const takes = datagram.octets.size() + kDatagramBookkeeping;
    if (used_ + takes <= room) {
        used_ += takes;
        queue_.push_back(std::move(datagram));
    }
}

Datagram UdpEnd::pop() {
    Datagram out = std::move(queue_.front());
    queue_.pop_front();
    used_ -= out.octets.size() + kDatagramBookkeeping;
    return out;
}

int UdpEnd::take_error() {
    return std::exchange(error_, 0);
}

IpEndpoint UdpEnd::local() const {
    return {address_of(pcb_->local_ip), pcb_->local_port};
}

int UdpEnd::bind(IpEndpoint const& to, bool reuse) {
    if (reuse) {
        ip_set_option(pcb_, SOF_REUSEADDR);
    } else {
        ip_reset_option(pcb_, SOF_REUSEADDR);
    }
    ip_addr_t const address = lwip_address(to.address);
    return udp_bind(pcb_, &address, to.port) == ERR_OK ? 0 : EADDRINUSE;
}

int UdpEnd::connect(IpEndpoint const& to) {
    disconnect();
    ip_addr_t const address = lwip_address(to.address);
    if (udp_connect(pcb_, &address, to.port) != ERR_OK) {
        return EAGAIN;
    }
    remote_ = to;
    if (ip_addr_isany_val(pcb_->local_ip)) { // connect(2) settles from where, too
        if (netif const* const way = ip4_route(ip_2_ip4(&address)); way != nullptr) {
            pcb_->local_ip = way->ip_addr;
            settled_ = true;
        }
    }
    return 0;
}

void UdpEnd::disconnect() {
    udp_disconnect(pcb_);
    remote_.reset();
    if (std::exchange(settled_, false)) {
        pcb_->local_ip = lwip_address(0);
    }
}

int UdpEnd::send(std::span<std::uint8_t const> octets, std::optional<IpEndpoint> to) {
    if (octets.size() > kLongestDatagram) {
        return EMSGSIZE;
    }
    if (!to && !remote_) {
        return EDESTADDRREQ;
    }
    IpEndpoint const target = to ? *to : *remote_;
    pbuf* const packet = pbuf_alloc(PBUF_TRANSPORT, static_cast<u16_t>(octets.size()), PBUF_RAM);
    if (packet == nullptr) {
        return ENOBUFS;
    }
    if (!octets.empty()) {
        pbuf_take(packet, octets.data(), static_cast<u16_t>(octets.size()));
    }
    ip_addr_t const address = lwip_address(target.address);
    err_t const error = udp_sendto(pcb_, packet, &address, target.port);
    pbuf_free(packet);
    switch (error) {
    case ERR_OK:
        return 0;
    case ERR_RTE:
        return ENETUNREACH;
    case ERR_VAL:
        return EACCES; // broadcast, and it has not asked for that
    case ERR_IF:
        return EPERM;
    default:
        return ENOBUFS;
    }
}

void UdpEnd::set_broadcast(bool on) {
    if (on) {
        ip_set_option(pcb_, SOF_BROADCAST);
    } else {
        ip_reset_option(pcb_, SOF_BROADCAST);
    }
}

void UdpEnd::set_header(std::uint8_t service, std::uint8_t time_to_live) {
    pcb_->tos = service;
    pcb_->ttl = time_to_live;
}

void UdpEnd::set_multicast(std::uint8_t time_to_live, bool loop) {
    udp_set_multicast_ttl(pcb_, time_to_live);
    udp_set_flags(pcb_, static_cast<u8_t>(loop ? udp_flags(pcb_) | UDP_FLAGS_MULTICAST_LOOP
                                               : udp_flags(pcb_) & ~UDP_FLAGS_MULTICAST_LOOP));
}

} // namespace gridspace::timebox
