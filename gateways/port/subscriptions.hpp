// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/goose_publisher.hpp"
#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"
#include "gateways/streams/stream.hpp"

#include <algorithm>

namespace gridspace::gateways {

/// What a declared stream says, as the state machines want it.
[[nodiscard]] inline iec61850::GooseTiming goose_timing(streams::GooseTiming const& t) {
    iec61850::GooseTiming out;
    out.min_ns = static_cast<std::int64_t>(t.min_time_ms * 1e6);
    out.max_ns = static_cast<std::int64_t>(t.max_time_ms * 1e6);
    out.growth = t.growth;
    out.live_factor = t.live_factor;
    out.live_min_ms = static_cast<std::uint32_t>(t.live_min_ms);
    return out;
}

[[nodiscard]] inline iec61850::GoosePublisherParams goose_publisher_params(streams::Stream const& s) {
    iec61850::GoosePublisherParams out;
    out.timing = goose_timing(s.timing);
    out.first_sq_num = s.first_sq_num;
    out.simulation = s.address.simulated;
    return out;
}

[[nodiscard]] inline iec61850::GooseSubscription goose_subscription(streams::Stream const& s) {
    iec61850::GooseSubscription out;
    out.gocb_ref = s.control_block;
    out.dat_set = s.data_set_name;
    out.go_id = s.go_id;
    out.destination = s.address.destination;
    out.app_id = s.address.app_id;
    out.conf_rev = s.conf_rev;
    out.data_set = s.data_set;
    return out;
}

/// `speed`: of the simulation clock in real time, see WireConfig. Samples come so much faster; the counter still wraps
/// after a second of theirs.
[[nodiscard]] inline iec61850::SvSubscription sv_subscription(streams::Stream const& s, double speed = 1) {
    iec61850::SvSubscription out;
    out.sv_id = s.sv_id;
    out.destination = s.address.destination;
    out.app_id = s.address.app_id;
    out.conf_rev = s.conf_rev;
    out.sample_octets = iec61850::SvLayout{s.data_set}.sample_octets();
    out.rate_hz = s.rate_hz.to_double() * speed;
    out.wrap = static_cast<std::uint32_t>(s.rate_hz.num());
    // Whole frames are late, and come at their own pace.
    auto const samples = static_cast<std::uint32_t>(s.samples_per_frame);
    out.late_window = std::clamp<std::uint32_t>(4 * samples, out.late_window, 63);
    out.silence_periods = std::max(out.silence_periods, 2.0 * samples);
    return out;
}

} // namespace gridspace::gateways
