// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/lockstep/foreign_frames.hpp"
#include "common/time.hpp"

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::lockstep {

/// What identifies a frame on its link: FNV-1a (64 bit) over its octets from the destination address on, a VLAN tag
/// left out, because the kernel takes it off and puts it back.
[[nodiscard]] std::uint64_t frame_identity(std::span<std::byte const> frame);

/// A raw Ethernet frame that has arrived on a link.
struct WireFrame {
    SimTime time;                  ///< lockstep: its simulated send time; real time: the newest clock when it arrived
    std::int64_t kernel_ns{0};     ///< the kernel's receive stamp (CLOCK_REALTIME), 0 without one
    std::int64_t arrived_ns{0};    ///< the same on the monotonic clock, as the receiver passed it
    std::uint32_t port{0};         ///< whatever the receiver passed with it
    std::vector<std::byte> octets; ///< from the destination address on, VLAN tag included
};

/// A frame in its buffer. It can only be moved, so it is in exactly one place: free, in the book, or at its reader.
using FrameBuffer = std::unique_ptr<WireFrame>;

/// Compares the raw frames that others say they have sent with those that have arrived. A wire knows no writer, so a
/// frame is recognised by what is in it; its simulated send time is what its sender's ledger says. Frames that nobody
/// announces are foreign and never become due. Channels share nothing: what comes on one of them moves no buffer of
/// another. Pure bookkeeping.
class WireBook {
  public:
    struct Channel {
        std::string link;
        std::uint16_t ethertype{0};
    };
    struct Record {
        std::int64_t send_time_ns{0};
        std::uint64_t identity{0};
    };

    static constexpr std::size_t kMaxUnannounced = 1024;
    /// `max_unannounced`: frames that wait for their ledger, on each channel.
    WireBook(std::size_t processes, std::vector<Channel> const& channels,
             std::size_t max_unannounced = kMaxUnannounced);

    static constexpr std::size_t kUnknown = static_cast<std::size_t>(-1);
    [[nodiscard]] std::size_t channel_index(std::string_view link, std::uint16_t ethertype) const;

    /// A line of a sender's ledger. `on_match(FrameBuffer, send_time_ns)` gets each frame that has already arrived. The
    /// ledger of an earlier incarnation than the newest is passed over.
    template <class OnMatch>
    void announced(std::size_t process, std::uint32_t incarnation, std::size_t channel, std::span<Record const> records,
                   OnMatch&& on_match) {
        if (!enter_incarnation(process, incarnation)) {
            return;
        }
        for (Record const& record : records) {
            if (FrameBuffer frame = take_early(channel, record.identity)) {
                on_match(std::move(frame), record.send_time_ns);
            } else {
                channels_[channel].awaited.push_back({process, record});
                ++awaited_of_[process];
            }
        }
    }

    struct Arrival {
        FrameBuffer due; ///< the frame itself, when somebody has announced it
        std::int64_t send_time_ns{0};
        FrameBuffer evicted; ///< a foreign frame that had to make room; its buffer is free
    };
    /// A frame has come. When nobody has announced it yet, the book keeps it until somebody does, or until it has to
    /// make room for newer ones: those from addresses that are not of this run go first.
    [[nodiscard]] Arrival arrived(std::size_t channel, FrameBuffer frame);

    /// Every frame that `process` has announced is here.
    [[nodiscard]] bool complete(std::size_t process) const { return awaited_of_[process] == 0; }
    /// "2 frames of ethertype 0x88ba on 'process_bus'"; empty when complete.
    [[nodiscard]] std::string missing(std::size_t process) const;
    /// Frames that are here and not announced.
    [[nodiscard]] std::size_t unannounced(std::size_t channel) const { return channels_[channel].early.size(); }
    /// What nobody of the run has announced so far, by source address.
    [[nodiscard]] ForeignFrames foreign(std::size_t channel) const;

  private:
    struct Awaited {
        std::size_t process;
        Record record;
    };
    struct Early {
        std::uint64_t identity;
        FrameBuffer frame;
    };
    struct State {
        Channel channel;
        std::vector<Awaited> awaited;           ///< announced, not here
        std::vector<Early> early;               ///< here, not announced; oldest first
        std::vector<std::uint64_t> own_sources; ///< of frames that were announced
        ForeignFrames evicted;
    };
    [[nodiscard]] bool enter_incarnation(std::size_t process, std::uint32_t incarnation);
    [[nodiscard]] FrameBuffer take_early(std::size_t channel, std::uint64_t identity);
    static void remember_source(State& state, WireFrame const& frame);
    static bool is_own(State const& state, WireFrame const& frame);

    std::size_t max_unannounced_;
    std::vector<State> channels_;
    std::vector<std::uint32_t> incarnations_; ///< by process
    std::vector<std::size_t> awaited_of_;     ///< by process, over all channels
};

} // namespace gridspace::lockstep
