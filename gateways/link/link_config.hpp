// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <vector>

namespace gridspace::gateways {

/// Impairments of one cable.
struct LinkConfig {
    std::vector<config::Ref> between; ///< a host and a link
    enum class Direction { from_host, to_host, both } direction{Direction::from_host};
};
void describe(config::Fields& f, LinkConfig& config);

} // namespace gridspace::gateways
