// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/ip/tcp_end.hpp"

#include "timebox/ip/lwip_address.hpp"

#include <algorithm>
#include <cerrno>
#include <lwip/tcp.h>

namespace gridspace::timebox {

struct TcpEnd::Events {
    static err_t received(void* self, tcp_pcb*, pbuf* packet, err_t) {
        auto& end = *static_cast<TcpEnd*>(self);
        if (packet == nullptr) {
            end.finished_ = true;
            return ERR_OK;
        }
        std::size_t const before = end.received_.size();
        end.received_.resize(before + packet->tot_len);
        pbuf_copy_partial(packet, end.received_.data() + before, packet->tot_len, 0);
        pbuf_free(packet);
        return ERR_OK;
    }
    static err_t connected(void* self, tcp_pcb*, err_t) {
        auto& end = *static_cast<TcpEnd*>(self);
        end.connected_ = true;
        end.note_names();
        return ERR_OK;
    }
    static void failed(void* self, err_t error) { // lwIP has freed it
        auto& end = *static_cast<TcpEnd*>(self);
        end.pcb_ = nullptr;
        if (error == ERR_CLSD) { // both sides have finished
            end.finished_ = true;
            return;
        }
        end.error_ = error == ERR_RST ? (end.connected_ ? ECONNRESET : ECONNREFUSED) : ETIMEDOUT;
    }
    static void attach(TcpEnd& end) {
        tcp_arg(end.pcb_, &end);
        tcp_recv(end.pcb_, received);
        tcp_err(end.pcb_, failed);
    }
};

TcpEnd::~TcpEnd() {
    reset();
}

void TcpEnd::note_names() {
    local_ = {address_of(pcb_->local_ip), pcb_->local_port};
    remote_ = {address_of(pcb_->remote_ip), pcb_->remote_port};
}

int TcpEnd::bind(IpEndpoint const& to, bool reuse) {
    if (pcb_ == nullptr) {
        pcb_ = tcp_new_ip_type(IPADDR_TYPE_V4);
        Events::attach(*this);
    }
    if (reuse) {
        ip_set_option(pcb_, SOF_REUSEADDR);
    } else {
        ip_reset_option(pcb_, SOF_REUSEADDR);
    }
    ip_addr_t const address = lwip_address(to.address);
    if (err_t const error = tcp_bind(pcb_, &address, to.port); error != ERR_OK) {
        return error == ERR_USE ? EADDRINUSE : EINVAL;
    }
    local_ = {to.address, pcb_->local_port};
    return 0;
}

int TcpEnd::connect(IpEndpoint const& to) {
    if (pcb_ == nullptr) {
        pcb_ = tcp_new_ip_type(IPADDR_TYPE_V4);
        Events::attach(*this);
    }
    ip_addr_t const address = lwip_address(to.address);
    remote_ = to;
    switch (tcp_connect(pcb_, &address, to.port, Events::connected)) {
    case ERR_OK:
        note_names();
        return 0;
    case ERR_RTE:
        return ENETUNREACH;
    case ERR_USE:
        return EADDRNOTAVAIL;
    case ERR_ISCONN:
        return EISCONN;
    default:
        return ENOBUFS;
    }
}

void TcpEnd::adopt(tcp_pcb* pcb) {
    pcb_ = pcb;
    connected_ = true;
    note_names();
    Events::attach(*this);
}

void TcpEnd::take(std::size_t octets) {
    received_.erase(received_.begin(), received_.begin() + static_cast<std::ptrdiff_t>(octets));
    constexpr std::size_t kAtOnce = 0xFFFF;
    for (; pcb_ != nullptr && octets > 0;) {
        std::size_t const now = std::min(octets, kAtOnce);
        tcp_recved(pcb_, static_cast<u16_t>(now));
        octets -= now;
    }
}

std::size_t TcpEnd::room() const {
    bool const open = pcb_ != nullptr && connected_ && !finishing_;
    return open && tcp_sndqueuelen(pcb_) < TCP_SND_QUEUELEN / 2 ? tcp_sndbuf(pcb_) : 0;
}

std::size_t TcpEnd::send(std::span<std::uint8_t const> octets) {
    std::size_t done = 0;
    while (pcb_ != nullptr && done < octets.size()) {
        constexpr std::size_t kAtOnce = 0xFFFF;
        std::size_t const now = std::min({octets.size() - done, room(), kAtOnce});
        if (now == 0 || tcp_write(pcb_, octets.data() + done, static_cast<u16_t>(now), TCP_WRITE_FLAG_COPY) != ERR_OK) {
            break;
        }
        done += now;
    }
    if (pcb_ != nullptr && done > 0) {
        tcp_output(pcb_);
    }
    return done;
}

void TcpEnd::finish() {
    if (pcb_ != nullptr && !finishing_) {
        finishing_ = tcp_shutdown(pcb_, 0, 1) == ERR_OK;
    }
}

void TcpEnd::let_go_when_finished() {
    if (finished_ && finishing_) {
        close();
    }
}

void TcpEnd::forget() {
    tcp_arg(pcb_, nullptr);
    tcp_err(pcb_, nullptr);
    if (pcb_->state != LISTEN) {
        tcp_recv(pcb_, nullptr);
        tcp_sent(pcb_, nullptr);
    }
}

void TcpEnd::close() {
    if (pcb_ == nullptr) {
        return;
    }
    forget();
    if (tcp_close(pcb_) != ERR_OK) {
        tcp_abort(pcb_);
    }
    pcb_ = nullptr;
}

void TcpEnd::reset() {
    if (pcb_ == nullptr) {
        return;
    }
    forget();
    tcp_abort(pcb_);
    pcb_ = nullptr;
}

void TcpEnd::set(Options const& options) {
    if (pcb_ == nullptr) {
        return;
    }
    if (options.no_delay) {
        tcp_nagle_disable(pcb_);
    } else {
        tcp_nagle_enable(pcb_);
    }
    if (options.keep_alive) {
        ip_set_option(pcb_, SOF_KEEPALIVE);
    } else {
        ip_reset_option(pcb_, SOF_KEEPALIVE);
    }
    pcb_->tos = options.service;
    pcb_->ttl = options.time_to_live;
    pcb_->keep_idle = options.keep_idle_s * 1000;
    pcb_->keep_intvl = options.keep_interval_s * 1000;
    pcb_->keep_cnt = options.keep_count;
}

struct TcpListener::Events {
    static err_t accepted(void* self, tcp_pcb* pcb, err_t error) {
        if (pcb == nullptr || error != ERR_OK) {
            return ERR_VAL;
        }
        auto end = std::make_unique<TcpEnd>();
        end->adopt(pcb);
        static_cast<TcpListener*>(self)->accepted_.push_back(std::move(end));
        return ERR_OK;
    }
};

int TcpListener::listen(TcpEnd& end, std::unique_ptr<TcpListener>& out) {
    if (end.pcb_ == nullptr) {
        if (int const error = end.bind({}, false); error != 0) {
            return error;
        }
    }
    err_t error = ERR_OK;
    end.forget();
    tcp_pcb* const listening = tcp_listen_with_backlog_and_err(end.pcb_, 0xFF, &error);
    if (listening == nullptr) {
        TcpEnd::Events::attach(end);
        return EADDRINUSE;
    }
    end.pcb_ = nullptr; // lwIP has freed it
    out.reset(new TcpListener);
    out->pcb_ = listening;
    out->local_ = end.local_;
    tcp_arg(listening, out.get());
    tcp_accept(listening, Events::accepted);
    return 0;
}

TcpListener::~TcpListener() {
    tcp_arg(pcb_, nullptr);
    tcp_accept(pcb_, nullptr);
    (void)tcp_close(pcb_);
}

} // namespace gridspace::timebox
