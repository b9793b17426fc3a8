// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// What a client sends to the monitor: through a real connection to its server, in pieces as they come.
#include "monitor/web/server.hpp"
#include "targets.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstdio>
#include <netinet/in.h>
#include <poll.h>
#include <string_view>
#include <sys/socket.h>

namespace gridspace::fuzz {
namespace {

/// libFuzzer's alarm comes every few seconds and interrupts a connect that has to wait: it then goes on by itself
/// (connect(2), EINTR).
bool connected(int fd, sockaddr_in const& address) {
    if (::connect(fd, reinterpret_cast<sockaddr const*>(&address), sizeof address) == 0) {
        return true;
    }
    int error = errno;
    pollfd waiting{fd, POLLOUT, 0};
    while (error == EINTR && ::poll(&waiting, 1, -1) < 0) {
        error = errno;
    }
    socklen_t size = sizeof error;
    if (error == EINTR) {
        ::getsockopt(fd, SOL_SOCKET, SO_ERROR, &error, &size);
    }
    errno = error;
    if (error != 0) {
        std::perror("connect");
    }
    return error == 0;
}

/// One server for all inputs, at a free port of this machine.
class Served {
  public:
    Served() {
        auto socket = web::listen_at("127.0.0.1:0");
        require(socket.has_value(), "no port to listen at");
        std::string const address = web::address_of(*socket);
        port_ = static_cast<std::uint16_t>(std::stoi(address.substr(address.rfind(':') + 1)));
        web::Handlers handlers;
        handlers.request = [](web::Request const& request) {
            web::Response out;
            out.body = request.target.path + request.body;
            return out;
        };
        handlers.accepts_push = [](std::string const&, std::vector<std::string> const&) {
            return std::optional{std::string{}};
        };
        handlers.opened = [](web::ClientId, std::string const&, std::string const&) {};
        handlers.closed = [](web::ClientId) {};
        handlers.message = [](web::ClientId, std::string const&) {};
        auto server = web::Server::start(std::move(*socket), {}, std::move(handlers));
        require(server.has_value(), "no server");
        server_ = std::move(*server);
    }

    /// Sends it all, says that nothing more comes, and waits until the server has ended the connection.
    void feed(std::string_view octets) const {
        UniqueFd const fd{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
        sockaddr_in address{};
        address.sin_family = AF_INET;
        address.sin_port = htons(port_);
        address.sin_addr.s_addr = htonl(INADDR_LOOPBACK);
        linger const at_once{1, 0}; // no thousands of ports in TIME_WAIT
        ::setsockopt(fd.get(), SOL_SOCKET, SO_LINGER, &at_once, sizeof at_once);
        // Where the server closes first its side waits nevertheless, and an address has only 28,000 ports.
        static std::uint32_t connections = 0;
        int const on = 1;
        ::setsockopt(fd.get(), IPPROTO_IP, IP_BIND_ADDRESS_NO_PORT, &on, sizeof on);
        sockaddr_in from{};
        from.sin_family = AF_INET;
        from.sin_addr.s_addr = htonl(INADDR_LOOPBACK + connections++ % 200);
        require(::bind(fd.get(), reinterpret_cast<sockaddr const*>(&from), sizeof from) == 0, "no address to ask from");
        require(connected(fd.get(), address), "the server does not answer any more");
        (void)::send(fd.get(), octets.data(), octets.size(), MSG_NOSIGNAL);
        ::shutdown(fd.get(), SHUT_WR);
        char answer[4096];
        while (::recv(fd.get(), answer, sizeof answer, 0) > 0) {
        }
    }

  private:
    std::uint16_t port_{0};
    std::unique_ptr<web::Server> server_;
};

void feed(std::string const& octets) {
    static Served const sut;
    sut.feed(octets);
}

} // namespace

void http(std::uint8_t const* data, std::size_t size) {
    feed({reinterpret_cast<char const*>(data), size});
}

void websocket(std::uint8_t const* data, std::size_t size) {
    feed("GET /ws/v1 HTTP/1.1\r\nHost: localhost\r\nUpgrade: websocket\r\nConnection: Upgrade\r\n"
         "Sec-WebSocket-Version: 13\r\nSec-WebSocket-Key: AAAAAAAAAAAAAAAAAAAAAA==\r\n\r\n" +
         std::string{reinterpret_cast<char const*>(data), size});
}

} // namespace gridspace::fuzz
