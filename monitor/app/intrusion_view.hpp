// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "monitor/stream/intrusion_tally.hpp"
#include "monitor/stream/signal_window.hpp"

#include <cstddef>
#include <map>
#include <memory>
#include <span>
#include <string>
#include <utility>

namespace gridspace::monitor {

/// Makes signals of what detectors and attackers publish (idl/intrusion.idl), whatever their topics are called:
///   ids.DETECTOR.STREAM.raw.a, .forecast.a, .accepted.a, .limit.a, .flagged.a (b, c)     of each sample
///   ids.DETECTOR.STREAM.judged, .false_positives, .false_positive_percent, .open_loop_false_positive_percent, .fakes,
///   .detected_percent, …
class IntrusionView {
  public:
    using Signals = std::map<std::pair<std::string, std::string>, std::unique_ptr<stream::SignalWindow>>;

    /// False when the sample is not what its type says.
    bool on_verdict(std::span<std::byte const> cdr, Signals& signals);
    bool on_label(std::span<std::byte const> cdr);

  private:
    struct Track {
        stream::SignalWindow *samples{nullptr}, *figures{nullptr}; ///< in the signals of the run, which outlive it
        stream::IntrusionTally tally;
        void tell(std::int64_t time_ns);
    };
    std::map<std::pair<std::string, std::string>, Track> tracks_; ///< by detector and stream
};

} // namespace gridspace::monitor
