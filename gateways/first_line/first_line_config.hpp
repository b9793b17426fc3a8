// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

namespace gridspace::gateways {

/// What a subscriber does about frames that look forged by their headers (ids/rules), before anything else looks at
/// them.
struct FirstLineConfig {
    enum class Action { off, alarm, drop } action{Action::alarm};
    bool check_arrival{true}; ///< sampled values, real time: arrival outside the usual interval is counted
    bool check_clock{true};   ///< GOOSE: the time of a new state is near the time of arrival
};
/// The key `first_line`.
void describe(config::Fields& f, FirstLineConfig& config);

} // namespace gridspace::gateways
