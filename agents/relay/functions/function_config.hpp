// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/functions/bay_relay.hpp"
#include "common/config/fields.hpp"

namespace gridspace::relay {

/// What the settings of functions are turned into samples with, and what is measured.
struct FunctionContext {
    double rate_hz{4800}, frequency_hz{60};
    int samples_per_cycle{80};
    std::uint8_t inputs{0}; ///< of Quantity: kCurrents, kVoltages, kBusVoltages
};

/// Reads `functions:`, a map from names of logical nodes (PTOC1, Z2PDIS1) to their settings. Mistakes are in
/// `diagnostics`; nothing is returned then.
[[nodiscard]] std::optional<FunctionSet> make_functions(config::Node const& functions, FunctionContext const& context,
                                                        config::Diagnostics& diagnostics);

/// "PTOC1.op" or "PTOC1.str": which function of a set, and which of the two. Nothing for anything else.
struct FunctionOutput {
    std::size_t function{0};
    bool op{true};
};
[[nodiscard]] std::optional<FunctionOutput> find_output(FunctionSet const& set, std::string_view text);

} // namespace gridspace::relay
