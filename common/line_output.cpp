// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/line_output.hpp"

#include <algorithm>
#include <cerrno>
#include <climits>
#include <fcntl.h>
#include <poll.h>
#include <sys/socket.h>
#include <sys/stat.h>
#include <unistd.h>
#include <utility>

namespace gridspace {

LineOutput::LineOutput(int fd, std::size_t most_octets) : fd_{fd}, most_octets_{most_octets} {
    struct stat status{};
    if (fd < 0 || ::fstat(fd, &status) != 0) {
        return;
    }
    is_socket_ = S_ISSOCK(status.st_mode);
    is_file_ = S_ISREG(status.st_mode);
    if (S_ISFIFO(status.st_mode) || ::isatty(fd) != 0) {
        std::string const name = "/proc/self/fd/" + std::to_string(fd);
        own_ = UniqueFd{::open(name.c_str(), O_WRONLY | O_NONBLOCK | O_NOCTTY | O_CLOEXEC)};
    }
}

std::size_t LineOutput::write_some(std::string_view text) {
    ssize_t size = 0;
    do {
        if (is_socket_) {
            size = ::send(fd_, text.data(), text.size(), MSG_DONTWAIT | MSG_NOSIGNAL);
        } else if (own_) {
            size = ::write(own_.get(), text.data(), text.size());
        } else {
            pollfd ready{fd_, POLLOUT, 0};
            if (!is_file_ && ::poll(&ready, 1, 0) <= 0) {
                return 0;
            }
            size =
                ::write(fd_, text.data(), std::min<std::size_t>(text.size(), PIPE_BUF)); // so much a ready pipe takes
        }
    } while (size < 0 && errno == EINTR);
    if (size < 0 && errno != EAGAIN && errno != EWOULDBLOCK) {
        return text.size(); // nobody is there any more, or the disk is full: it is lost
    }
    return static_cast<std::size_t>(std::max<ssize_t>(size, 0));
}

void LineOutput::flush() {
    while (waits()) {
        if (waiting_.empty()) {
            waiting_ = std::exchange(latest_, {});
        }
        std::size_t const written = write_some(waiting_);
        if (written == 0) {
            return;
        }
        waiting_.erase(0, written);
    }
}

void LineOutput::put(std::string_view text) {
    if (fd_ < 0) {
        return;
    }
    if (waiting_.size() + latest_.size() + text.size() > most_octets_) {
        flush();
        if (waiting_.size() + latest_.size() + text.size() > most_octets_) {
            ++left_out_;
            return;
        }
    }
    waiting_ += std::exchange(latest_, {}); // it is older
    waiting_ += text;
    flush();
}

void LineOutput::put_latest(std::string text) {
    if (fd_ < 0) {
        return;
    }
    latest_ = std::move(text);
    flush();
}

void LineOutput::drain(std::optional<std::chrono::milliseconds> patience) {
    using Clock = std::chrono::steady_clock;
    auto const begin = Clock::now();
    for (flush(); waits(); flush()) {
        auto const waited = std::chrono::duration_cast<std::chrono::milliseconds>(Clock::now() - begin);
        if (patience && waited >= *patience) {
            return;
        }
        constexpr std::chrono::milliseconds kLook{100};
        pollfd ready{fd(), POLLOUT, 0};
        ::poll(&ready, 1, static_cast<int>((patience ? std::min(kLook, *patience - waited) : kLook).count()));
    }
}

std::string LineOutput::take() {
    return std::exchange(waiting_, {}) + std::exchange(latest_, {});
}

} // namespace gridspace
