// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/fragments.hpp"
#include "bus/rtps_guard/known_participants.hpp"
#include "bus/rtps_guard/message_guard.hpp"

#include <array>
#include <atomic>
#include <functional>
#include <mutex>
#include <string>

namespace gridspace::rtps_guard {

/// What stands between the sockets of a participant and the library. Thread-safe: each socket has a thread.
class Gate {
  public:
    explicit Gate(Rules rules = {}, std::size_t most_participants = KnownParticipants::kMax)
        : rules_{rules}, known_{most_participants} {}

    /// Called with each message that the library may see.
    using Deliver = std::function<void(std::span<std::uint8_t const>)>;
    /// Of most datagrams one message: the datagram, without statistics. None of one that is kept away; several of one
    /// with fragments of samples.
    void admit(std::span<std::uint8_t> datagram, std::int64_t now_ns, Deliver const& deliver);

    /// Datagrams that were kept away and should not have come. Not counted: those of participants that have not
    /// announced themselves, which the library would ignore, and which come in every run that somebody joins late; and
    /// on a secured bus disposes, which members send as they leave.
    [[nodiscard]] std::uint64_t refused() const;
    /// "12 (numbers that cannot be), 3 (not RTPS 2)"; empty when there are none.
    [[nodiscard]] std::string text() const;

  private:
    [[nodiscard]] Refusal judge(Examined const& examined, std::int64_t now_ns);

    Rules rules_;
    std::mutex mutex_;
    KnownParticipants known_; ///< under the mutex
    Fragments fragments_;     ///< under the mutex
    std::array<std::atomic<std::uint64_t>, static_cast<std::size_t>(Refusal::count_)> refused_{};
};

} // namespace gridspace::rtps_guard
