// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <algorithm>
#include <chrono>
#include <cstddef>
#include <cstdint>
#include <map>
#include <span>

namespace gridspace::bus {

/// Which heartbeats for all may leave, so that the start of hundreds of participants comes to an end. Who gets one
/// answers, and those answers fill the buffers of the simulator and the recorder; what matters is lost among them, and
/// is sent again.
/// - Fast DDS tells a new participant of its endpoints one by one, and after each, all that it knows get a heartbeat.
/// - A writer sends one to all readers each 100 ms (qos/) until the last of them has answered, also before it has
///   written anything, when nobody can lack anything.
/// Those that are left out cost nothing but time: as long as somebody has not acknowledged, another comes.
class HeartbeatBrake {
  public:
    using Clock = std::chrono::steady_clock;
    /// Up to so many destinations those of discovery all pass; each further one adds to the pause between two.
    static constexpr std::size_t kFew = 32;
    static constexpr std::chrono::milliseconds kPauseEach{5}, kLongestPause{900};

    /// A heartbeat alone in its message, neither for one participant nor to assert liveliness. All else always passes.
    [[nodiscard]] static bool concerns(std::span<std::uint8_t const> message) {
        constexpr std::uint8_t kHeartbeat = 0x07, kVendorsOwn = 0x80, kLiveliness = 0x04;
        return message.size() >= kNext && message[kSubmessage] == kHeartbeat &&
               (message[kSubmessage + 1] & kLiveliness) == 0 &&
               (message.size() == kNext || message[kNext] == kVendorsOwn);
    }
    /// `heartbeat`: one that it concerns, to so many destinations.
    [[nodiscard]] bool lets_pass(std::span<std::uint8_t const> heartbeat, std::size_t destinations,
                                 Clock::time_point now) {
        auto const pause = pause_of(heartbeat, destinations);
        if (pause == std::chrono::milliseconds{0}) {
            return true;
        }
        auto const [last, first] = last_.try_emplace(writer_of(heartbeat), now);
        if (!first && now - last->second < pause) {
            return false;
        }
        last->second = now;
        return true;
    }

  private:
    // Octets from the beginning of the message (DDSI-RTPS 2.2, clauses 9.4.4 and 9.4.5.6).
    static constexpr std::size_t kSubmessage = 20, kWriter = 28, kLastNumber = 40, kNext = 52;

    static std::chrono::milliseconds pause_of(std::span<std::uint8_t const> heartbeat, std::size_t destinations) {
        constexpr std::uint8_t kBuiltinWriter = 0xc2;
        if (heartbeat[kWriter + 3] == kBuiltinWriter) {
            return destinations <= kFew ? std::chrono::milliseconds{0}
                                        : std::min(kPauseEach * static_cast<int>(destinations - kFew), kLongestPause);
        }
        auto const last_number = heartbeat.subspan(kLastNumber, 8);
        bool const has_written = std::ranges::any_of(last_number, [](std::uint8_t octet) { return octet != 0; });
        return has_written ? std::chrono::milliseconds{0} : kLongestPause;
    }
    static std::uint32_t writer_of(std::span<std::uint8_t const> heartbeat) {
        std::uint32_t id = 0;
        for (std::uint8_t const octet : heartbeat.subspan(kWriter, 4)) {
            id = id << 8U | octet;
        }
        return id;
    }

    std::map<std::uint32_t, Clock::time_point> last_; ///< by entity id of the writer
};

} // namespace gridspace::bus
