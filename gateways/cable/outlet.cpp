// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/cable/ends.hpp"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>

namespace gridspace::cable {
namespace {

constexpr std::size_t kMostWritten = 1U << 20U; ///< octets that are kept though they have left

} // namespace

Outlet::Outlet(int fd) : fd_{fd} {
    ::fcntl(fd, F_SETFL, ::fcntl(fd, F_GETFL) | O_NONBLOCK);
}

bool Outlet::flush() {
    while (!empty()) {
        ssize_t const size = ::write(fd_, waiting_.data() + written_, waiting_.size() - written_);
        if (size < 0) {
            return errno == EAGAIN || errno == EINTR;
        }
        written_ += static_cast<std::size_t>(size);
        if (written_ > kMostWritten) { // who is never caught up with never empties it
            waiting_.erase(0, written_);
            written_ = 0;
        }
    }
    waiting_.clear();
    written_ = 0;
    return true;
}

void forward_frames(int tap, std::uint8_t port, Outlet& out) {
    std::array<char, 16384> frame{};
    for (ssize_t size = 0; !out.full() && (size = ::read(tap, frame.data(), frame.size())) > 0;) {
        out.send(Kind::frame, port, {frame.data(), static_cast<std::size_t>(size)});
    }
}

} // namespace gridspace::cable
