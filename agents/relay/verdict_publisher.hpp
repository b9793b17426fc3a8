// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/node.hpp"
#include "common/rational.hpp"
#include "ids/detector/stream_guard.hpp"

#include <intrusion.h>

#include <memory>
#include <string>

namespace gridspace::relay {

/// Publishes what the detector said about the samples of one stream, a hundredth of a second in a message. Where a
/// message ends depends on the samples alone, so that a recording does not depend on ticks or pace.
class VerdictPublisher {
  public:
    /// `writer` must outlive it; both streams of a relay share one.
    VerdictPublisher(bus::Writer<IdsVerdict>& writer, std::string const& detector, std::string const& stream,
                     Rational rate_hz);

    /// `index`: absolute, counted from simulated time 0. A gap of the index ends a message.
    void add(std::int64_t index, ids::StreamVerdict const& verdict, SimTime now, std::int64_t time_ns);
    void flush(SimTime now);

  private:
    bus::Writer<IdsVerdict>* writer_;
    std::size_t per_message_;
    std::int64_t next_index_{0};
    std::unique_ptr<IdsVerdict> message_;
};

} // namespace gridspace::relay
