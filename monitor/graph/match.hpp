// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/discovery.hpp"

#include <string>
#include <vector>

namespace gridspace::graph {

/// Why a writer and a reader of one topic do not match, for people; empty: they do. The rules are those of
/// DDS 1.4, 2.2.3
/// ("requested versus offered"), of DDS-XTypes 1.3, 7.6.3.1 (representations), and the type name.
[[nodiscard]] std::vector<std::string> mismatch(bus::DiscoveredEndpoint const& writer,
                                                bus::DiscoveredEndpoint const& reader);

[[nodiscard]] char const* name_of(bus::Durability durability);
[[nodiscard]] char const* name_of(bus::Liveliness liveliness);
[[nodiscard]] char const* name_of(bus::PresentationScope scope);
[[nodiscard]] char const* name_of(bus::Representation representation);

} // namespace gridspace::graph
