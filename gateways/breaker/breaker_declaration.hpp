// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/breaker/breaker_config.hpp"
#include "gateways/port/declared_signals.hpp"

namespace gridspace::gateways {

/// Of the command, in the order of their columns.
[[nodiscard]] std::vector<program::Signal> command_signals();

/// What a breaker IED with these settings hears, writes and publishes.
[[nodiscard]] program::Declaration declaration(BreakerConfig const& config, DeclarationContext const& context);
/// With names of settings in the place of their values.
[[nodiscard]] program::Declaration breaker_declaration();

} // namespace gridspace::gateways
