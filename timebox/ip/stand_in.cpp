// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/ip/stand_in.hpp"

#include <array>
#include <cerrno>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <sys/un.h>

namespace gridspace::timebox {
namespace {

sockaddr const* name_of(std::string const& address) {
    return reinterpret_cast<sockaddr const*>(address.data());
}

} // namespace

std::uint64_t socket_inode_of(UniqueFd const& file) {
    struct stat status{};
    return file && ::fstat(file.get(), &status) == 0 && S_ISSOCK(status.st_mode) ? status.st_ino : 0;
}

std::string give_address(UniqueFd const& file) {
    sockaddr_un name{};
    name.sun_family = AF_UNIX;
    socklen_t size = sizeof name;
    auto* const address = reinterpret_cast<sockaddr*>(&name);
    if (::bind(file.get(), address, sizeof name.sun_family) != 0 || ::getsockname(file.get(), address, &size) != 0) {
        return {};
    }
    return {reinterpret_cast<char const*>(&name), size};
}

bool connect_to(UniqueFd const& file, std::string const& address) {
    return ::connect(file.get(), name_of(address), static_cast<socklen_t>(address.size())) == 0;
}

bool send_to(UniqueFd const& file, std::string const& address) {
    return ::sendto(file.get(), "", 1, MSG_DONTWAIT | MSG_NOSIGNAL, name_of(address),
                    static_cast<socklen_t>(address.size())) == 1;
}

bool address_is_taken(std::string const& address, bool stream) {
    UniqueFd const other{::socket(AF_UNIX, (stream ? SOCK_STREAM : SOCK_DGRAM) | SOCK_CLOEXEC, 0)};
    return ::bind(other.get(), name_of(address), static_cast<socklen_t>(address.size())) != 0;
}

void make_unwritable(UniqueFd const& file) {
    // The kernel calls it writable while a quarter of its buffer is taken.
    static std::array<char, 16'384> const fillers{};
    constexpr int kMost = 64;
    for (int i = 0; i < kMost; ++i) {
        pollfd look{file.get(), POLLOUT, 0};
        if (::poll(&look, 1, 0) == 0 || ::send(file.get(), fillers.data(), fillers.size(), MSG_DONTWAIT) <= 0) {
            return;
        }
    }
}

void make_writable(UniqueFd const& ours) {
    std::array<char, 16'384> fillers;
    while (::recv(ours.get(), fillers.data(), fillers.size(), MSG_DONTWAIT) > 0) {
    }
}

} // namespace gridspace::timebox
