// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/judge/results.hpp"
#include "launcher/judge/spread.hpp"

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

struct SmvTiming {
    std::string stream;
    bool captured{false};         ///< counted in the capture, not by a relay of ours
    std::size_t other_senders{0}; ///< that use the same name and APPID: the counts are of the one with most frames
    std::optional<double> nominal_hz;
    std::size_t received{0}, lost{0}, duplicate{0}, late{0};
    std::size_t refused{0};  ///< simulated, damaged, or of another identity, revision or size; they are among the lost
    std::string not_counted; ///< "what relay1 counted from 0 s to 0.4 s": the counters are no less than that much
    std::size_t samples_per_frame{1};
    double mean_hz{0};                   ///< samples over arrivals, by least squares; 0 in lockstep
    std::vector<std::int64_t> sample_ns; ///< simulated instants of the last samples of the frames, in order
    std::vector<double> arrival_ms;      ///< of each frame on the wall clock, since the start; empty in lockstep
    Spread interval;                     ///< between the arrivals of two frames
    Spread publish_age, wire_delay;
};

struct GooseTiming {
    std::string stream;
    bool captured{false}; ///< intervals are those of the capture, not the sender's own
    std::size_t messages{0};
    std::optional<double> steady_ms;  ///< median interval where it no longer grows; nothing when it nowhere does
    std::optional<std::size_t> event; ///< index of the first message of the new state
    std::vector<double> interval_ms;  ///< of each message, to the one before
    Spread wire_delay;
};

/// What the receiver of a declared stream has counted and measured; where the capture has to stand in for that, by
/// captured_smv().
[[nodiscard]] SmvTiming smv_timing(Results const& results, config::Node const& scenario, std::string const& stream);
/// What the sender of a declared stream says of its messages; none: nothing was recorded.
[[nodiscard]] GooseTiming goose_timing(SignalStore const& signals, std::string const& stream);

/// Declared streams for whose receiver no complete counters (sampled values) or whose sender no rows (GOOSE) were
/// recorded.
[[nodiscard]] std::vector<std::string> uncounted_streams(Results const& results, config::Node const& scenario);
/// The same of the capture: counts and intervals, with the sender's own publish_age if it is ours. Nothing where
/// the capture does not hold the stream.
[[nodiscard]] std::optional<SmvTiming> captured_smv(Results const& results, config::Node const& scenario,
                                                    std::string const& stream);
[[nodiscard]] std::optional<GooseTiming> captured_goose(Results const& results, config::Node const& scenario,
                                                        std::string const& stream);
[[nodiscard]] bool is_goose(config::Node const& scenario, std::string const& stream);

} // namespace gridspace::launcher
