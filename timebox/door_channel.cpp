// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/door_channel.hpp"

#include <array>
#include <cerrno>
#include <sys/socket.h>

namespace gridspace::timebox {
namespace {

constexpr std::size_t kLongest = 1U << 20U;

} // namespace

DoorEnds make_door_ends() {
    std::array<int, 2> ends{-1, -1};
    if (::socketpair(AF_UNIX, SOCK_SEQPACKET | SOCK_CLOEXEC, 0, ends.data()) != 0) {
        return {};
    }
    int const room = 2 * static_cast<int>(kLongest);
    for (int const end : ends) {
        if (::setsockopt(end, SOL_SOCKET, SO_SNDBUFFORCE, &room, sizeof room) != 0) {
            ::setsockopt(end, SOL_SOCKET, SO_SNDBUF, &room, sizeof room);
        }
    }
    return {UniqueFd{ends[0]}, UniqueFd{ends[1]}};
}

DoorChannel::DoorChannel(UniqueFd ours, decltype(DoorOptions::take) take)
    : ours_{std::move(ours)}, take_{std::move(take)}, buffer_(kLongest) {}

void DoorChannel::hand(std::int64_t at_ns, std::vector<std::byte> message) {
    coming_.push_back({at_ns, std::move(message)});
}

void DoorChannel::exchange(std::int64_t now_ns) {
    while (!coming_.empty() && coming_.front().at_ns <= now_ns) {
        auto const& message = coming_.front().message;
        if (::send(ours_.get(), message.data(), message.size(), MSG_DONTWAIT | MSG_NOSIGNAL) < 0) {
            if (errno == EAGAIN || errno == ENOBUFS) {
                break; // it reads first what is there
            }
            too_long_ += errno == EMSGSIZE ? 1 : 0;
        }
        coming_.pop_front();
    }
    ssize_t got = 0;
    while ((got = ::recv(ours_.get(), buffer_.data(), buffer_.size(), MSG_DONTWAIT)) > 0) {
        take_(now_ns, std::span{buffer_}.first(static_cast<std::size_t>(got)));
    }
}

std::optional<std::int64_t> DoorChannel::next_ns(std::int64_t now_ns) const {
    if (coming_.empty() || coming_.front().at_ns <= now_ns) { // what does not fit waits for the door, not for a time
        return std::nullopt;
    }
    return coming_.front().at_ns;
}

} // namespace gridspace::timebox
