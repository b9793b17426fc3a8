// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/cable/ends.hpp"

#include <array>
#include <cerrno>
#include <fcntl.h>
#include <unistd.h>

namespace gridspace::cable {

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
