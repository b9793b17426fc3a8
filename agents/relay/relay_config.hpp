// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/line_relay.hpp"
#include "common/config/fields.hpp"

namespace gridspace::relay {

/// What a scenario says about a relay's decision. Streams, hosts and the trip data set belong to the program.
struct RelayLogicConfig {
    ElementParams::Kind kind{ElementParams::Kind::phasor};
    Rational window_cycles{1};
    double pickup_a{0}, slope_percent{30}, slope2_percent{0}, slope2_from_a{0};
    std::int64_t confirm_samples{1};
    bool publish_values{false}; ///< differential and restraint currents as signals

    enum class SealIn { until_reset, while_pickup } seal_in{SealIn::until_reset};

    std::int64_t max_interpolated{3};
    bool accept_questionable{false}, test_mode{false}, in_service{true};
    Synch required_synch{Synch::global};
};

/// Reads the keys `element`, `seal_in`, `blocking` and `in_service`.
void describe(config::Fields& f, RelayLogicConfig& config);

/// The relay of a stream with `rate_hz` in a network of `frequency_hz`.
[[nodiscard]] Result<RelayParams> make_params(RelayLogicConfig const& config, Rational rate_hz, Rational frequency_hz);

} // namespace gridspace::relay
