// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/ethernet/frame_filter.hpp"
#include "gateways/ethernet/interface.hpp"

#include <memory>
#include <span>

namespace gridspace::ethernet {

struct PortOptions {
    std::string interface;
    FrameFilter filter;
    bool receive{true};           ///< false: only sends
    bool include_outgoing{false}; ///< see what this host sends on the interface, for a recorder
    bool promiscuous{false};
    bool ring{true}; ///< memory shared with the kernel, where it is to be had; otherwise recvmmsg
    static constexpr std::size_t kRingFrames = 4096;
    std::size_t ring_frames{kRingFrames};
    bool waited_for{true}; ///< false: nobody waits for its descriptor; frames are fetched when they must be there
    std::size_t receive_buffer{8U << 20U}; ///< octets, without the ring
    /// Frames whose source address begins so have a buffer of their own, and are fetched first: a flood by others fills
    /// another one, and takes no room from them.
    std::optional<std::array<std::uint8_t, 3>> own_sources{};
};

/// A frame as it was on the wire: the VLAN tag is put back where the kernel has taken it out.
struct ReceivedFrame {
    Octets octets;
    std::int64_t stamp_ns{0}; ///< kernel's receive stamp, CLOCK_REALTIME; 0: it gave none
    bool outgoing{false};     ///< sent by this host (include_outgoing)
    bool truncated{false};    ///< longer than 2 kB: the rest is missing
};

struct PortCounters {
    std::uint64_t received{0}, sent{0};
    std::uint64_t dropped{0};                ///< by the kernel, because we did not fetch them in time
    std::uint64_t others_dropped{0};         ///< the same, of those that are not from `own_sources`
    std::uint64_t send_failed{0};            ///< not taken by the kernel (link down, queue full, longer than the MTU)
    int send_error{0};                       ///< errno of the first of these
    std::uint64_t truncated{0}, filtered{0}; ///< filtered: by us, not by the kernel
    std::uint64_t reconnects{0};
    std::uint64_t foreign{
        0}; ///< on the interface since it was opened, and not asked for; as of the last Port::foreign()
};

inline constexpr std::size_t kMostBatches = 64; ///< calls of Port::receive() in a row

/// Raw Ethernet frames of one interface (AF_PACKET). Not one frame is lost at the start: filter, memberships and
/// buffers are in place before the socket is bound. One thread at a time. Needs CAP_NET_RAW and nothing else.
class Port {
  public:
    /// Fails when the interface is missing or the capability is; a link that is down is not an error.
    [[nodiscard]] static Result<Port> open(PortOptions options);
    Port(Port&&) noexcept;
    Port& operator=(Port&&) noexcept;
    ~Port();

    /// For poll(2), to read. Changes when the port reconnects; -1 while the interface is missing.
    [[nodiscard]] int fd() const noexcept;
    /// Fetches what has arrived, at most out.size() frames, and never waits. Octets are valid until the next call. Who
    /// has more to do calls it at most kMostBatches times in a row: frames may come as fast as they are handled.
    [[nodiscard]] std::size_t receive(std::span<ReceivedFrame> out) noexcept;
    /// Waits until something has arrived or the time is over; true: something may have arrived.
    bool wait(std::int64_t timeout_ns) const noexcept;

    /// Hands frames to the kernel, all in one call where possible. Returns how many it took (they are counted; those
    /// that it did not take are not sent later).
    std::size_t send(std::span<Octets const> frames) noexcept;
    bool send(Octets frame) noexcept;

    /// Looks after the link; call it a few times per second. Opens the interface again when it has come back.
    LinkState maintain();

    [[nodiscard]] Mac const& mac() const noexcept; ///< of the interface
    [[nodiscard]] std::string const& interface() const noexcept;
    [[nodiscard]] bool uses_ring() const noexcept;
    /// Asks the kernel for its drop counter.
    [[nodiscard]] PortCounters const& counters() noexcept;
    /// How many frames of the interface the filter has kept away, by the interface's own count. Reads a file of the
    /// kernel: for who reports, not for who receives.
    [[nodiscard]] std::uint64_t foreign();

  private:
    struct Impl;
    explicit Port(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

} // namespace gridspace::ethernet
