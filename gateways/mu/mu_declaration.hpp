// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/mu/mu_config.hpp"
#include "gateways/port/declared_signals.hpp"

namespace gridspace::gateways {

/// What a merging unit with these settings reads, sends and publishes.
[[nodiscard]] program::Declaration declaration(MuConfig const& config, DeclarationContext const& context);
/// With names of settings in the place of their values.
[[nodiscard]] program::Declaration mu_declaration();

} // namespace gridspace::gateways
