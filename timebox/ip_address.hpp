// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "timebox/ip/ip_link.hpp"
#include "timebox/tracee.hpp"

#include <algorithm>
#include <arpa/inet.h>
#include <cerrno>
#include <netinet/in.h>
#include <optional>

namespace gridspace::timebox {

[[nodiscard]] inline sockaddr_in to_sockaddr(IpEndpoint const& e) {
    sockaddr_in out{};
    out.sin_family = AF_INET;
    out.sin_port = htons(e.port);
    out.sin_addr.s_addr = htonl(e.address);
    return out;
}

/// What a program has written there.
struct NamedAddress {
    int family{AF_UNSPEC};
    IpEndpoint endpoint;
    int error{0};
};
[[nodiscard]] inline NamedAddress address_at(pid_t tid, std::uint64_t at, std::uint64_t size) {
    sockaddr_in in{};
    if (size < sizeof in.sin_family || !read_memory(tid, at, &in, std::min<std::uint64_t>(size, sizeof in))) {
        return {AF_UNSPEC, {}, size < sizeof in.sin_family ? EINVAL : EFAULT};
    }
    if (in.sin_family == AF_UNSPEC) {
        return {};
    }
    int const error = in.sin_family != AF_INET ? EAFNOSUPPORT : size < sizeof in ? EINVAL : 0;
    return {in.sin_family, {ntohl(in.sin_addr.s_addr), ntohs(in.sin_port)}, error};
}

/// As accept(2) and its relatives return an address: as much as there is room for, and how long it is.
inline void put_address(pid_t tid, std::uint64_t at, std::uint64_t size_at, socklen_t room, IpEndpoint const& e) {
    sockaddr_in const name = to_sockaddr(e);
    if (at != 0 && size_at != 0) {
        (void)write_memory(tid, at, &name, std::min<std::size_t>(room, sizeof name));
        put(tid, size_at, static_cast<socklen_t>(sizeof name));
    }
}

} // namespace gridspace::timebox
