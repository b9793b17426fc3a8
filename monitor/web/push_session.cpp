// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/connections.hpp"

#include <algorithm>

namespace gridspace::web {

PushSession::~PushSession() {
    server_.leave(this);
    if (opened_) {
        server_.leave_client(id_);
        if (server_.handlers_.closed) {
            server_.handlers_.closed(id_);
        }
    }
}

void PushSession::open(http::request<http::string_body> const& request, std::string path, std::string protocol) {
    server_.enter(this);
    beast::get_lowest_layer(socket_).expires_never();
    auto timeout = websocket::stream_base::timeout::suggested(beast::role_type::server);
    timeout.handshake_timeout = server_.options_.limits.request_time;
    timeout.idle_timeout = server_.options_.limits.idle_time; // answers to our pings count as life
    timeout.keep_alive_pings = true;
    socket_.set_option(timeout);
    socket_.read_message_max(server_.options_.limits.body_octets);
    protocol_ = !protocol.empty();
    if (protocol_) {
        socket_.set_option(websocket::stream_base::decorator([protocol](websocket::response_type& response) {
            response.set(http::field::sec_websocket_protocol, protocol);
        }));
    }
    ++server_.opening_;
    socket_.async_accept(request, [self = shared_from_this(), path = std::move(path),
                                   protocol = std::move(protocol)](beast::error_code error) {
        --self->server_.opening_;
        if (error) {
            return;
        }
        self->opened_ = true;
        self->server_.enter_client(self);
        if (self->server_.handlers_.opened) {
            self->server_.handlers_.opened(self->id_, path, protocol);
        }
        self->read();
    });
}

void PushSession::read() {
    socket_.async_read(buffer_, [self = shared_from_this()](beast::error_code error, std::size_t) {
        if (error) {
            self->close(); // a write that waits for the client ends too
            return;
        }
        bool const understood = guarded("a message of a WebSocket client", [&] {
            if (self->server_.handlers_.message) {
                self->server_.handlers_.message(self->id_, beast::buffers_to_string(self->buffer_.data()));
            }
        });
        if (!understood) {
            self->close();
            return;
        }
        self->buffer_.clear();
        self->read();
    });
}

void PushSession::push(Message message) {
    Limits const& limits = server_.options_.limits;
    waiting_octets_ += message.octets->size();
    waiting_.push_back(std::move(message));
    std::size_t const most = protocol_ ? limits.push_samples : limits.push_messages;
    while (waiting_.size() > most || waiting_octets_ > limits.push_octets) {
        // The one at the front may be on its way already, the one at the back is the newest.
        auto const from = waiting_.begin() + (writing_ ? 1 : 0), to = waiting_.end() - 1;
        auto const oldest = from < to ? std::find_if(from, to, [](Message const& m) { return !m.lasting; }) : to;
        if (oldest == to) {
            if (waiting_.size() > 2 * most || waiting_octets_ > 2 * limits.push_octets) {
                close(); // it may come back, and then gets everything anew
            }
            break;
        }
        waiting_octets_ -= oldest->octets->size();
        server_.count_out(id_, oldest->octets->size(), true);
        waiting_.erase(oldest);
    }
    if (!writing_) {
        write();
    }
}

void PushSession::write() {
    writing_ = true;
    socket_.binary(waiting_.front().binary);
    socket_.async_write(asio::buffer(*waiting_.front().octets),
                        [self = shared_from_this()](beast::error_code error, std::size_t) {
                            if (error) {
                                self->close();
                                return;
                            }
                            self->server_.count_out(self->id_, self->waiting_.front().octets->size(), false);
                            self->waiting_octets_ -= self->waiting_.front().octets->size();
                            self->waiting_.pop_front();
                            self->writing_ = false;
                            if (!self->waiting_.empty()) {
                                self->write();
                            }
                        });
}

} // namespace gridspace::web
