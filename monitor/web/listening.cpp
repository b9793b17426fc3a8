// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/listening.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>

namespace gridspace::web {

Result<UniqueFd> listen_at(std::string const& where) {
    std::size_t const colon = where.rfind(':');
    sockaddr_in address{};
    address.sin_family = AF_INET;
    char* end = nullptr;
    unsigned long const port = colon == std::string::npos ? 65536 : std::strtoul(where.c_str() + colon + 1, &end, 10);
    if (port > 65535 || *end != '\0' || ::inet_pton(AF_INET, where.substr(0, colon).c_str(), &address.sin_addr) != 1) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an address to listen on", where),
                    "for example 127.0.0.1:0");
    }
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    UniqueFd socket{::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0)};
    int const yes = 1;
    ::setsockopt(socket.get(), SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (!socket || ::bind(socket.get(), reinterpret_cast<sockaddr const*>(&address), sizeof address) != 0 ||
        ::listen(socket.get(), 128) != 0) {
        int const why = errno;
        return fail(ExitCode::environment, fmt::format("cannot listen on {}: {}", where, std::strerror(why)),
                    why == EADDRINUSE ? "somebody listens there already; port 0 takes a free one"
                                      : "port 0 takes a free one");
    }
    return socket;
}

std::string address_of(UniqueFd const& listening) {
    sockaddr_in address{};
    socklen_t size = sizeof address;
    char text[INET_ADDRSTRLEN] = "";
    if (::getsockname(listening.get(), reinterpret_cast<sockaddr*>(&address), &size) == 0) {
        ::inet_ntop(AF_INET, &address.sin_addr, text, sizeof text);
    }
    return fmt::format("{}:{}", text, ntohs(address.sin_port));
}

bool is_loopback(std::string const& where) {
    in_addr address{};
    return ::inet_pton(AF_INET, where.substr(0, where.rfind(':')).c_str(), &address) == 1 &&
           (ntohl(address.s_addr) >> 24) == 127;
}

Result<void> check_exposure(std::string const& where, bool token, bool tls) {
    if (is_loopback(where) || (token && tls)) {
        return {};
    }
    return fail(ExitCode::usage,
                fmt::format("whoever reaches {} could look at the run: that needs {}{}{}", where,
                            token ? "" : "a token (token_file)", token || tls ? "" : " and ",
                            tls ? "" : "TLS (tls_cert and tls_key)"),
                "or listen on 127.0.0.1 and look through `ssh -L 8080:127.0.0.1:PORT HOST`");
}

} // namespace gridspace::web
