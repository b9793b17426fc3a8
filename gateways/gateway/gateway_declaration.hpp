// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/gateway/route.hpp"
#include "gateways/port/declared_signals.hpp"

namespace gridspace::gateways {

/// What a gateway with this table reads, sends and publishes. `routes`: its mappings, made ready; for what they watch.
[[nodiscard]] program::Declaration declaration(GatewayConfig const& config, std::vector<Route> const& routes,
                                               DeclarationContext const& context);
/// Without a table: what holds for each.
[[nodiscard]] program::Declaration gateway_declaration();

/// The watched fields of a mapping, in the order of their columns.
[[nodiscard]] std::vector<program::Signal> watched_signals(Route const& route);

} // namespace gridspace::gateways
