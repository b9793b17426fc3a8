// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace::cable {

/// What travels between the two ends of a cable over ssh. Each message is one octet of kind, one of port, four of
/// length (little endian), and its octets.
enum class Kind : std::uint8_t {
    port = 'p',     ///< to the board: "NAME,MAC,ADDRESS/PREFIX|-", in the order of their numbers
    file = 'f',     ///< to the board: NAME, a zero octet, the file's content
    variable = 'v', ///< to the board: "NAME=value" of the program's environment
    word = 'w',     ///< to the board: the program (first), an argument
    go = 'g',       ///< to the board: all has been said, start it
    stop = 't',     ///< to the board: the program shall end
    frame = 'd',    ///< both ways: an Ethernet frame of a port, without its check sequence
    alive = 'a',    ///< both ways: still there
    started = 'r',  ///< from the board: the program runs
    log = 'l',      ///< from the board: what it printed
    status = 's',   ///< from the board: what it wrote on its status descriptor
    failed = '!',   ///< from the board: code, message, remedy, separated by zero octets
    ended = 'x',    ///< from the board: "exit 0" or "signal 9"
};

/// What the board's end says first; login scripts may have printed something before.
constexpr std::string_view kGreeting = "\x01gridspace-cable 1\n";
constexpr std::size_t kLongestMessage = 64U << 20U;

struct Message {
    Kind kind{};
    std::uint8_t port{0};
    std::string_view bytes; ///< valid until the stream is fed again
};

void append(std::string& out, Kind kind, std::uint8_t port, std::string_view bytes);
inline void append(std::string& out, Kind kind, std::string_view bytes = {}) {
    append(out, kind, 0, bytes);
}

/// Messages out of a stream of octets, however it was cut.
class Stream {
  public:
    void feed(std::string_view bytes);
    /// The next complete message, or nothing yet.
    [[nodiscard]] std::optional<Message> next();
    /// The stream makes no sense any more: a length that nobody sends.
    [[nodiscard]] bool broken() const { return broken_; }

  private:
    std::string bytes_;
    std::size_t begin_{0};
    bool broken_{false};
};

} // namespace gridspace::cable
