// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/ethernet/port.hpp"
#include "gateways/iec61850/frame.hpp"
#include "gateways/iec61850/utc_time.hpp"
#include "launcher/wire/tools.hpp"

#include <cstdint>
#include <string>

namespace gridspace::wire {

/// Nanoseconds of the monotonic clock, and since 1970.
[[nodiscard]] std::int64_t monotonic_ns();
[[nodiscard]] std::int64_t utc_ns();

/// Until an absolute time of the monotonic clock, or Ctrl-C.
void sleep_until(std::int64_t at_ns);

/// Makes SIGINT and SIGTERM ask for an orderly end instead of killing.
void catch_signals();
[[nodiscard]] bool stopped();

/// A stream and where it is sent; `source`: of its frames.
struct Sending {
    streams::Stream stream;
    ethernet::Port port;
    iec61850::Mac source;
};
/// `source`: an address, or empty for the interface's own.
[[nodiscard]] Result<Sending> open_sending(std::string const& interface, StreamArgument const& stream,
                                           streams::Kind kind, std::string const& source);

/// Why the kernel did not take the first of the frames that were not sent, and what to do; empty when it took all.
[[nodiscard]] std::string why_not_sent(ethernet::Port& port);
/// The same as a note to stderr.
void say_not_sent(ethernet::Port& port);
/// That note; a failure when none was sent at all.
[[nodiscard]] Result<void> check_sent(ethernet::Port& port);

/// TimeQuality in words: "synchronised, 10 bits", "clock failure, not synchronised, accuracy unspecified".
[[nodiscard]] std::string time_quality_text(iec61850::UtcTime const& time);

/// The end of a tool that runs for `duration_s` (0: until Ctrl-C).
class Duration {
  public:
    explicit Duration(double duration_s)
        : end_ns_{duration_s > 0 ? monotonic_ns() + static_cast<std::int64_t>(duration_s * 1e9) : INT64_MAX} {}
    [[nodiscard]] bool over() const { return stopped() || monotonic_ns() >= end_ns_; }
    [[nodiscard]] std::int64_t end_ns() const { return end_ns_; }

  private:
    std::int64_t end_ns_;
};

} // namespace gridspace::wire
