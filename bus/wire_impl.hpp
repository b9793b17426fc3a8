// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/wire.hpp"

namespace gridspace::bus {

/// The inside of a WireReader; everything is guarded by the node's mutex.
struct WireReader::Impl {
    explicit Impl(Node::Core& c) : core{c} {}
    Node::Core& core;
    std::string link;
    std::uint16_t ethertype{0};
    std::size_t channel{0}; ///< its index in the book
    // A buffer is in exactly one of these, or in the book while nobody has announced its frame.
    std::vector<lockstep::FrameBuffer> free, waiting, taken;
    std::vector<WireFrame const*> out;
    SimTime until{INT64_MAX};
    std::size_t kept_octets{0}, bound{SIZE_MAX}; ///< real time: of what is waiting or taken
    std::uint64_t dropped{0};
    std::uint64_t not_fetched{0};

    void due(lockstep::FrameBuffer frame, SimTime time);
};

} // namespace gridspace::bus
