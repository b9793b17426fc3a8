// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/rational.hpp"
#include "gateways/ptp/ptp_config.hpp"

#include <array>
#include <optional>
#include <string>

namespace gridspace::gateways {

using config::Ref;

/// A merging unit: a topic of line currents in, a stream of sampled values out.
struct MuConfig {
    Ref from; ///< DDS topic of LineCurrents, or with voltages of BaySamples
    Ref to;   ///< stream
    std::array<std::string, 3> channels{"Ia", "Ib",
                                        "Ic"};          ///< members of the data set that get the phases; others stay 0
    std::optional<std::array<std::string, 3>> voltages; ///< members that get the voltages
    [[nodiscard]] char const* type() const { return voltages ? "BaySamples" : "LineCurrents"; }
    enum class Sending { scheduled, on_arrival } sending{Sending::scheduled};
    double buffer_ms{1.5}; ///< real time, scheduled: so much later than the first sample of all, to ride out jitter
    std::optional<ptp::PtpConfig> ptp;
    Rational latency_us{120}; ///< lockstep: from the sample to the frame
};
void describe(config::Fields& f, MuConfig& config);

} // namespace gridspace::gateways
