// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/cable/stream.hpp"

namespace gridspace::cable {
namespace {

constexpr std::size_t kHead = 6;

} // namespace

void append(std::string& out, Kind kind, std::uint8_t port, std::string_view bytes) {
    auto const length = static_cast<std::uint32_t>(bytes.size());
    out += static_cast<char>(kind);
    out += static_cast<char>(port);
    for (unsigned shift = 0; shift < 32; shift += 8) {
        out += static_cast<char>((length >> shift) & 255U);
    }
    out += bytes;
}

void Stream::feed(std::string_view bytes) {
    bytes_.erase(0, begin_);
    begin_ = 0;
    bytes_ += bytes;
}

std::optional<Message> Stream::next() {
    if (broken_ || bytes_.size() - begin_ < kHead) {
        return std::nullopt;
    }
    auto const octet = [&](std::size_t i) { return static_cast<unsigned char>(bytes_[begin_ + i]); };
    std::size_t length = 0;
    for (std::size_t i = 0; i < 4; ++i) {
        length |= static_cast<std::size_t>(octet(2 + i)) << (8 * i);
    }
    if (length > kLongestMessage) {
        broken_ = true;
        return std::nullopt;
    }
    if (bytes_.size() - begin_ - kHead < length) {
        return std::nullopt;
    }
    Message const message{static_cast<Kind>(octet(0)), octet(1),
                          std::string_view{bytes_}.substr(begin_ + kHead, length)};
    begin_ += kHead + length;
    return message;
}

} // namespace gridspace::cable
