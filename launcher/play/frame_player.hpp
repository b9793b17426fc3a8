// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/ethernet/port.hpp"
#include "launcher/play/pace.hpp"
#include "launcher/play/play_options.hpp"

namespace gridspace::play {

/// Sends the recorded GOOSE and SV frames of a run on an interface, on the recorded clock.
class FramePlayer {
  public:
    /// Refuses a real interface, unless the options allow it.
    [[nodiscard]] static Result<FramePlayer> open(std::filesystem::path const& capture, std::int64_t epoch_ns,
                                                  PlayOptions const& options);

    [[nodiscard]] std::int64_t first_ns() const { return first_ns_; }
    [[nodiscard]] std::int64_t last_ns() const { return last_ns_; }
    [[nodiscard]] std::uint64_t frames() const { return frames_; } ///< that there are to send
    [[nodiscard]] bool truncated() const { return truncated_; }
    [[nodiscard]] Result<void> play(Pace const& pace, std::int64_t from_ns, std::int64_t to_ns);
    [[nodiscard]] std::uint64_t sent() { return port_.counters().sent; }
    [[nodiscard]] std::uint64_t not_sent() { return port_.counters().send_failed; }

  private:
    FramePlayer(std::filesystem::path capture, std::int64_t epoch_ns, std::string only, ethernet::Port port)
        : capture_{std::move(capture)}, epoch_ns_{epoch_ns}, only_{std::move(only)}, port_{std::move(port)} {}
    template <class Handler>
    [[nodiscard]] Result<void> each(Handler const& handler);

    std::filesystem::path capture_;
    std::int64_t epoch_ns_;
    std::string only_;
    ethernet::Port port_;
    std::int64_t first_ns_{0}, last_ns_{0};
    std::uint64_t frames_{0};
    bool truncated_{false};
};

} // namespace gridspace::play
