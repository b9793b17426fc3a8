// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/unique_fd.hpp"
#include "gateways/ethernet/port.hpp"

namespace gridspace::ethernet {

/// The steps of making an AF_PACKET socket, and the two ways of reading it. Used by Port alone.
struct PacketSocket {
    UniqueFd fd;
    unsigned index{0}; ///< of the interface
    FrameFilter filter;
    bool kernel_filters{false};
    bool ignores_outgoing{false};
};

/// Everything but the ring and bind(): so nothing can arrive before all is ready.
[[nodiscard]] Result<PacketSocket> make_socket(PortOptions const& options);
[[nodiscard]] Result<void> bind_socket(PacketSocket const& socket, PortOptions const& options);
/// Frames for the socket since the last call, fetched or not: all of them, and those that the kernel dropped.
struct KernelCounts {
    std::uint64_t all{0}, dropped{0};
};
[[nodiscard]] KernelCounts take_counts(int fd);

/// Puts a VLAN tag back: moves the addresses four octets to the front, where there must be room. The new start.
[[nodiscard]] std::uint8_t* restore_tag(std::uint8_t* frame, std::uint16_t tpid, std::uint16_t tci) noexcept;

/// How frames are fetched from a bound socket. Frames are valid until the next call of receive().
class Receiver {
  public:
    virtual ~Receiver() = default;
    [[nodiscard]] virtual std::size_t receive(std::span<ReceivedFrame> out) noexcept = 0;
    [[nodiscard]] virtual bool is_ring() const noexcept = 0;
};
/// Before bind(). Null where the kernel (or an emulator) offers no ring.
[[nodiscard]] std::unique_ptr<Receiver> make_ring(int fd, std::size_t frames);
[[nodiscard]] std::unique_ptr<Receiver> make_batch_receiver(int fd);

} // namespace gridspace::ethernet
