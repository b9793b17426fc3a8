// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/listening.hpp"

#include <arpa/inet.h>
#include <cerrno>
#include <cstring>
#include <fmt/format.h>
#include <netinet/in.h>
#include <sys/socket.h>
#include <unistd.h>

namespace gridspace::launcher {

Result<ListeningSocket> open_listening(std::string const& where) {
    std::size_t const colon = where.rfind(':');
    sockaddr_in address{};
    address.sin_family = AF_INET;
    char* end = nullptr;
    unsigned long const port = colon == std::string::npos ? 65536 : std::strtoul(where.c_str() + colon + 1, &end, 10);
    if (colon == std::string::npos || port > 65535 || *end != '\0' ||
        ::inet_pton(AF_INET, where.substr(0, colon).c_str(), &address.sin_addr) != 1) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an address to listen on", where), "for example 127.0.0.1:0");
    }
    address.sin_port = htons(static_cast<std::uint16_t>(port));
    int const fd = ::socket(AF_INET, SOCK_STREAM | SOCK_CLOEXEC, 0);
    int const yes = 1;
    ::setsockopt(fd, SOL_SOCKET, SO_REUSEADDR, &yes, sizeof yes);
    if (fd < 0 || ::bind(fd, reinterpret_cast<sockaddr const*>(&address), sizeof address) != 0 || ::listen(fd, 64) != 0) {
        int const why = errno;
        ::close(fd);
        return fail(ExitCode::environment, fmt::format("cannot listen on {}: {}", where, std::strerror(why)),
                    why == EADDRINUSE ? "somebody listens there already; port 0 takes a free one" : "");
    }
    socklen_t size = sizeof address;
    ::getsockname(fd, reinterpret_cast<sockaddr*>(&address), &size);
    return ListeningSocket{fd, fmt::format("{}:{}", where.substr(0, colon), ntohs(address.sin_port))};
}

} // namespace gridspace::launcher
