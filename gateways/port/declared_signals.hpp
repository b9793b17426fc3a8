// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// Signals that several programs with raw frames have in common, as they declare and publish them. "{process}" in a name
// stands for the process.
#pragma once

#include "common/program/declaration.hpp"
#include "gateways/first_line/first_line_config.hpp"
#include "gateways/ptp/ptp_config.hpp"
#include "gateways/streams/stream.hpp"

#include <optional>
#include <span>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// What a declaration follows from besides the settings of the process. Without a scenario, for --describe: no streams,
/// and names of settings in the place of their values.
struct DeclarationContext {
    std::span<streams::Stream const> streams{};
    bool real_time{true};
};

/// The topic on which frames are counted.
[[nodiscard]] program::Topic stream_statistics();

/// Appends.
void add(std::vector<program::Signal>& signals, std::vector<program::Signal> more);

/// Counters of who sends sampled values.
[[nodiscard]] std::vector<program::Signal> publisher_signals();
/// How old a sample is when it is sent, and how long its frame takes (computed by the report).
[[nodiscard]] std::vector<program::Signal> sent_sample_signals(std::string const& stream);

/// Of who follows a PTP daemon (ClockFollower).
[[nodiscard]] std::vector<program::Signal> clock_signals();
[[nodiscard]] std::vector<program::Signal> clock_signals(std::optional<ptp::PtpConfig> const& ptp,
                                                         DeclarationContext const& context);

/// A received stream in front of which the first-line rules stand.
struct GuardedStream {
    std::string name; ///< as its signals have it
    bool sampled_values{false};
    bool authenticated{false};
};
[[nodiscard]] program::Signal first_line_alarm();
[[nodiscard]] std::vector<program::Signal> first_line_counter_signals(std::vector<GuardedStream> const& streams);
/// Both; none where the rules do not run, or before no stream.
[[nodiscard]] std::vector<program::Signal> first_line_signals(FirstLineConfig const& config,
                                                              std::vector<GuardedStream> const& streams);
/// A stream by its name in the scenario, whether it is authenticated there or not.
[[nodiscard]] GuardedStream guarded(DeclarationContext const& context, std::string const& stream, bool sampled_values);

} // namespace gridspace::gateways
