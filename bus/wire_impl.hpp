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
    std::vector<std::unique_ptr<WireFrame>>
        slots; ///< each is free, early (in the book), waiting for its time, or taken
    std::vector<std::size_t> free, waiting, taken;
    std::vector<WireFrame const*> out;
    SimTime until{INT64_MAX};
    std::size_t kept_octets{0}, bound{SIZE_MAX}; ///< real time: of what is waiting or taken
    std::uint64_t dropped{0};

    void due(std::size_t slot, SimTime time);
};

} // namespace gridspace::bus
