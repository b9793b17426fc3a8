// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/octets.hpp"

#include <optional>

namespace gridspace::rtps_guard {

/// What a parameter list (DDSI-RTPS 2.2, 9.4.2.11) says about who it speaks of.
struct ParameterFacts {
    std::optional<GuidPrefix> participant; ///< of PID_PARTICIPANT_GUID
    std::optional<GuidPrefix> endpoint;    ///< of PID_ENDPOINT_GUID
    std::optional<GuidPrefix> key;         ///< of PID_KEY_HASH
    std::size_t octets{0};                 ///< of the list, its sentinel included
};

/// Walks a list up to its sentinel. Nothing when a parameter reaches beyond the octets that are there, or when what it
/// counts (a string's characters, a sequence's elements) does not fit into it. In the list of a participant or endpoint
/// (`discovery`) parameters that Fast DDS 2.9 cannot read safely, and that nobody here needs, become padding: type
/// objects (docs/design/bus.md), content filters, shared memory, and security tokens unless the bus is `secured`.
[[nodiscard]] std::optional<ParameterFacts> examine_parameters(Octets list, bool discovery, bool secured = false);

} // namespace gridspace::rtps_guard
