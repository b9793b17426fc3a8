// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/relay/event_report_config.hpp"
#include "agents/relay/waveform_window.hpp"

#include <cstdint>
#include <deque>
#include <future>
#include <string>
#include <vector>

namespace gridspace::relay {

/// What a report contains in addition to the samples.
struct EventReportFacts {
    std::string process; ///< the relay's name in the run
    std::string from_stream, to_stream;
    double rate_hz{4800}, frequency_hz{60};
};

/// A disturbance recorder in the relay, as protection relays have one: the samples that the relay decided by, what it
/// made of them, and its event log, as COMTRADE (IEEE C37.111-2013) with a .hdr for the log. Taking a sample costs a
/// copy into fixed memory; files are written by a thread of their own.
class EventReport {
  public:
    EventReport(EventReportConfig const& config, EventReportFacts facts);
    ~EventReport(); ///< finish()
    EventReport(EventReport const&) = delete;
    EventReport& operator=(EventReport const&) = delete;

    /// A sample and what the relay made of it; `utc_ns`: when the sample was taken.
    void sample(LineSample const& sample, RelayOutput const& output, std::int64_t utc_ns);
    /// A line of the event log.
    void event(std::string line);
    /// The end: a report that has begun is written as far as it is. Waits for files.
    void finish();

    [[nodiscard]] int reports() const { return number_; }

  private:
    void write();

    EventReportConfig config_;
    EventReportFacts facts_;
    WaveformWindow window_;
    std::deque<std::string> log_; ///< the newest lines
    bool active_{false}, triggered_{false};
    std::int64_t trigger_index_{0}, trigger_utc_ns_{0};
    int number_{0};
    std::future<void> writing_;
};

} // namespace gridspace::relay
