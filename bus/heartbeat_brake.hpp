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

/// Which heartbeats of discovery may leave. Fast DDS tells a new participant of its endpoints one by one, and after
/// each it sends a heartbeat to all participants that it knows, who all answer. With hundreds of them those answers
/// fill the buffers of the simulator and the recorder, what matters is lost among them, and is told again.
/// Heartbeats that are left out cost nothing but time: as long as somebody has not acknowledged, another comes each
/// second.
class HeartbeatBrake {
  public:
    using Clock = std::chrono::steady_clock;
    /// Up to so many destinations there is no brake; each further one adds to the pause between two heartbeats.
    static constexpr std::size_t kFew = 32;
    static constexpr std::chrono::milliseconds kPauseEach{5}, kLongestPause{900};

    /// `message` goes to so many destinations.
    [[nodiscard]] bool lets_pass(std::span<std::uint8_t const> message, std::size_t destinations,
                                 Clock::time_point now) {
        if (destinations <= kFew || !is_for_all_of_discovery(message)) {
            return true;
        }
        auto const pause = std::min(kPauseEach * static_cast<int>(destinations - kFew), kLongestPause);
        auto const [last, first] = last_.try_emplace(writer_of(message), now);
        if (!first && now - last->second < pause) {
            return false;
        }
        last->second = now;
        return true;
    }

  private:
    static constexpr std::size_t kHeader = 20, kHeartbeat = 32; // octets (DDSI-RTPS 2.2, clauses 9.4.4 and 9.4.5.6)

    /// A heartbeat alone, of a built-in writer, neither for one participant nor to assert liveliness.
    static bool is_for_all_of_discovery(std::span<std::uint8_t const> message) {
        constexpr std::uint8_t kHeartbeatId = 0x07, kVendorsOwn = 0x80, kLiveliness = 0x04, kBuiltinWriter = 0xc2;
        if (message.size() < kHeader + kHeartbeat || message[kHeader] != kHeartbeatId ||
            (message[kHeader + 1] & kLiveliness) != 0) {
            return false;
        }
        std::size_t const next = kHeader + kHeartbeat;
        return message[kHeader + 11] == kBuiltinWriter && (message.size() == next || message[next] == kVendorsOwn);
    }
    static std::uint32_t writer_of(std::span<std::uint8_t const> message) {
        std::uint32_t id = 0;
        for (std::uint8_t const octet : message.subspan(kHeader + 8, 4)) {
            id = id << 8U | octet;
        }
        return id;
    }

    std::map<std::uint32_t, Clock::time_point> last_; ///< by entity id of the writer
};

} // namespace gridspace::bus
