// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/gateway.hpp"

/// What a gateway keeps of its inputs; for its own sources.
namespace gridspace::gateways {

struct Gateway::Topic {
    std::string name, type;
    std::shared_ptr<bus::CdrReader> reader;
    std::vector<Source*> sources;
    std::vector<bus::Received<bus::CdrSample>> due;
};

/// A sample or a frame, and when it is.
struct Gateway::Event {
    SimTime time;
    Topic const* topic{nullptr}; ///< nullptr: a frame
    std::size_t sample{0};
    bus::WireFrame const* frame{nullptr};
    std::uint16_t ethertype{0};
};

} // namespace gridspace::gateways
