// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/rational.hpp"
#include "gateways/first_line/first_line_config.hpp"

#include <string>

namespace gridspace::gateways {

using config::Ref;

/// A breaker IED: a Boolean of a GOOSE stream in, trip commands on a DDS topic out.
struct BreakerConfig {
    Ref from; ///< "TRIP2.status": stream and member of its data set
    Ref to;   ///< DDS topic of TripCommand
    enum class OnLoss { hold, open } on_loss{OnLoss::hold};
    bool accept_test{false}; ///< act on messages marked simulated
    FirstLineConfig first_line;
    Rational latency_us{1000}; ///< from the message to the effect of the command; in real time no sooner

    [[nodiscard]] Ref stream() const { return {from.name.substr(0, from.name.find('.')), from.where}; }
    [[nodiscard]] std::string field() const {
        std::size_t const dot = from.name.find('.');
        return dot == std::string::npos ? "" : from.name.substr(dot + 1);
    }
};
void describe(config::Fields& f, BreakerConfig& config);

} // namespace gridspace::gateways
