// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/play/frame_player.hpp"

#include "gateways/iec61850/routable.hpp"
#include "launcher/wire/tools.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <charconv>
#include <fmt/format.h>

namespace gridspace::play {
namespace {

/// In lockstep frames are stamped with simulated time; in real time their comment says it.
std::int64_t simulated_ns(pcapng::Frame const& frame, std::int64_t epoch_ns) {
    constexpr std::string_view kSays = "simulated time ";
    if (frame.comment.starts_with(kSays)) {
        double seconds = 0;
        char const* const end = frame.comment.data() + frame.comment.size();
        if (std::from_chars(frame.comment.data() + kSays.size(), end, seconds).ec == std::errc{}) {
            return epoch_ns + static_cast<std::int64_t>(seconds * 1e9);
        }
    }
    return frame.time_ns;
}

} // namespace

Result<FramePlayer> FramePlayer::open(std::filesystem::path const& capture, std::int64_t epoch_ns,
                                      PlayOptions const& options) {
    if (auto ok = wire::check_attack_allowed(options.frames, options.allow_attacks_on); !ok) {
        return std::unexpected{ok.error()};
    }
    auto port = ethernet::Port::open({.interface = options.frames, .filter = {}, .receive = false});
    if (!port) {
        return std::unexpected{port.error()};
    }
    FramePlayer player{capture, epoch_ns, options.only, std::move(*port)};
    auto const scanned = player.each([&](pcapng::Frame const&, std::int64_t time) {
        player.first_ns_ = player.frames_ == 0 ? time : std::min(player.first_ns_, time);
        player.last_ns_ = player.frames_ == 0 ? time : std::max(player.last_ns_, time);
        ++player.frames_;
        return true;
    });
    if (!scanned) {
        return std::unexpected{scanned.error()};
    }
    if (player.frames_ == 0) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' holds no GOOSE or SV frame to play{}", capture.string(),
                                options.only.empty() ? "" : fmt::format(" of '{}'", options.only)),
                    "`gridspace info` lists what it holds");
    }
    return player;
}

template <class Handler>
Result<void> FramePlayer::each(Handler const& handler) {
    auto reader = pcapng::Reader::open(capture_);
    if (!reader) {
        return std::unexpected{reader.error()};
    }
    while (true) {
        auto const frame = reader->next();
        if (!frame) {
            return std::unexpected{frame.error()};
        }
        if (!*frame) {
            truncated_ = reader->truncated();
            return {};
        }
        std::uint16_t const ethertype = iec61850::stream_ethertype((*frame)->octets);
        std::string const& point = reader->interfaces()[(*frame)->interface].name;
        bool const wanted = ethertype == iec61850::kSvEthertype || ethertype == iec61850::kGooseEthertype;
        bool const here = only_.empty() ? !pcapng::is_inside_a_cable(point) : only_ == point;
        if (wanted && here && !handler(**frame, simulated_ns(**frame, epoch_ns_))) {
            return {};
        }
    }
}

Result<void> FramePlayer::play(Pace const& pace, std::int64_t from_ns, std::int64_t to_ns) {
    return each([&](pcapng::Frame const& frame, std::int64_t time) {
        if (time >= from_ns && time <= to_ns) {
            (void)pace.wait_until(time);
            if (!wire::stopped()) {
                (void)port_.send(frame.octets);
            }
        }
        return !wire::stopped();
    });
}

} // namespace gridspace::play
