// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Includes Boost: for server.cpp alone.
#pragma once

#include <boost/asio/async_result.hpp>
#include <boost/asio/ssl/context.hpp>
#include <boost/asio/ssl/stream.hpp>
#include <boost/beast/core/tcp_stream.hpp>
#include <boost/beast/websocket/teardown.hpp>
#include <chrono>
#include <memory>
#include <utility>

namespace gridspace::web {

/// A connection, with TLS or without. One type for both, so that HTTP and WebSocket are compiled once.
class Transport {
  public:
    using next_layer_type = boost::beast::tcp_stream; ///< deadlines and close() are the connection's
    using executor_type = next_layer_type::executor_type;

    /// `context` null: no TLS.
    Transport(boost::asio::ip::tcp::socket socket, boost::asio::ssl::context* context)
        : tcp_{std::make_unique<next_layer_type>(std::move(socket))} {
        if (context != nullptr) {
            tls_ = std::make_unique<Tls>(*tcp_, *context);
        }
    }

    [[nodiscard]] executor_type get_executor() noexcept { return tcp_->get_executor(); }
    [[nodiscard]] next_layer_type& next_layer() noexcept { return *tcp_; }
    [[nodiscard]] next_layer_type const& next_layer() const noexcept { return *tcp_; }
    [[nodiscard]] bool secure() const { return tls_ != nullptr; }

    template <class Buffers, class Handler>
    auto async_read_some(Buffers const& buffers, Handler&& handler) {
        return initiate(std::forward<Handler>(handler), [this, buffers](auto&& done) {
            using Done = decltype(done);
            tls_ ? tls_->async_read_some(buffers, std::forward<Done>(done))
                 : tcp_->async_read_some(buffers, std::forward<Done>(done));
        });
    }
    template <class Buffers, class Handler>
    auto async_write_some(Buffers const& buffers, Handler&& handler) {
        return initiate(std::forward<Handler>(handler), [this, buffers](auto&& done) {
            using Done = decltype(done);
            tls_ ? tls_->async_write_some(buffers, std::forward<Done>(done))
                 : tcp_->async_write_some(buffers, std::forward<Done>(done));
        });
    }
    /// Only with TLS. `done(error)`
    template <class Handler>
    void async_handshake(Handler&& done) {
        tls_->async_handshake(boost::asio::ssl::stream_base::server, std::forward<Handler>(done));
    }
    /// Says goodbye in the words of TLS. Only with TLS. `done(error)`
    template <class Handler>
    void async_shutdown(Handler&& done) {
        tls_->async_shutdown(std::forward<Handler>(done));
    }

  private:
    using Tls = boost::asio::ssl::stream<next_layer_type&>;

    template <class Handler, class Start>
    static auto initiate(Handler&& handler, Start start) {
        return boost::asio::async_initiate<Handler, void(boost::system::error_code, std::size_t)>(std::move(start),
                                                                                                  handler);
    }

    // On the heap: TLS refers to the connection, and both move from HTTP to WebSocket.
    std::unique_ptr<next_layer_type> tcp_;
    std::unique_ptr<Tls> tls_;
};

// How a WebSocket ends, found by its implementation by argument-dependent lookup.
inline void teardown(boost::beast::role_type role, Transport& transport, boost::system::error_code& error) {
    boost::beast::websocket::teardown(role, transport.next_layer().socket(), error);
}
template <class Handler>
void async_teardown(boost::beast::role_type role, Transport& transport, Handler&& done) {
    if (transport.secure()) {
        transport.next_layer().expires_after(std::chrono::seconds{2}); // whoever does not say goodbye is not waited for
        transport.async_shutdown(std::forward<Handler>(done));
    } else {
        boost::beast::websocket::async_teardown(role, transport.next_layer().socket(), std::forward<Handler>(done));
    }
}

} // namespace gridspace::web
