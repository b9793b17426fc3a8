// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <linux/filter.h>
#include <optional>
#include <span>
#include <vector>

namespace gridspace::timebox {

/// What a filter sees of a frame.
struct FilterInput {
    std::span<std::uint8_t const> octets; ///< from the link header (SOCK_RAW) or the network header (SOCK_DGRAM) on
    std::size_t network_offset{14};       ///< of the network header therein
    std::uint16_t protocol{0};
    std::uint8_t packet_type{0};
    int interface{0};
    std::optional<std::uint16_t> vlan_tci;
    std::uint16_t vlan_protocol{0};
};

/// A classic BPF program as SO_ATTACH_FILTER takes it.
class PacketFilter {
  public:
    /// Nothing: the kernel would refuse it, or it asks for what is not known here.
    [[nodiscard]] static std::optional<PacketFilter> make(std::vector<sock_filter> program);
    /// How many octets of the frame are kept; 0: it is not taken.
    [[nodiscard]] std::uint32_t run(FilterInput const& input) const;

  private:
    explicit PacketFilter(std::vector<sock_filter> program) : program_{std::move(program)} {}
    std::vector<sock_filter> program_;
};

} // namespace gridspace::timebox
