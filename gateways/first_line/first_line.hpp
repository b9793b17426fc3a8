// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/first_line/first_line_config.hpp"
#include "gateways/iec61850/goose.hpp"
#include "gateways/iec61850/sv.hpp"
#include "gateways/streams/stream.hpp"
#include "ids/rules/goose_rules.hpp"
#include "ids/rules/sv_rules.hpp"

#include <array>
#include <cstdint>

namespace gridspace::gateways {

/// What became of a frame, or of one of its ASDUs.
struct FirstLineVerdict {
    bool pass{true};
    std::uint32_t findings{0}; ///< bits of ids::SvFinding or ids::GooseFinding that mean an alarm
    std::uint32_t news{0};     ///< those of them that were not seen in the last second: worth a line in a log
};

/// What a stream's first line has counted.
struct FirstLineCounters {
    std::uint64_t suspicious{0}, refused{0}, odd_arrivals{0};
};

/// Which findings are news. A flood of forgeries makes one line a second and kind, not thousands.
class FindingNews {
  public:
    std::uint32_t fresh(std::uint32_t findings, std::int64_t now_ns);

  private:
    std::array<std::int64_t, 32> last_ns_{};
    std::uint32_t seen_{0};
};

/// First-line rules of a subscribed stream of sampled values: facts of a decoded frame in, what to do about it out.
/// Pure, allocates nothing.
class SvFirstLine {
  public:
    /// `lockstep`: simulated time says nothing about how a network delivers, so arrivals are not judged.
    SvFirstLine(FirstLineConfig const& config, streams::Stream const& stream, bool lockstep);
    /// An ASDU of the stream; `first` of its frame. `arrival_ns` on any one axis.
    FirstLineVerdict judge(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu, bool first,
                           std::int64_t arrival_ns);
    [[nodiscard]] FirstLineCounters const& counters() const { return counters_; }

  private:
    FirstLineConfig config_;
    ids::SvRules rules_;
    FindingNews news_;
    FirstLineCounters counters_;
};

/// The same for GOOSE.
class GooseFirstLine {
  public:
    GooseFirstLine(FirstLineConfig const& config, streams::Stream const& stream);
    /// A message of the stream's control block; `utc_ns`: when it came.
    FirstLineVerdict judge(iec61850::GooseFrame const& message, std::int64_t utc_ns);
    /// The time to live has run out.
    void expired() { rules_.expired(); }
    [[nodiscard]] FirstLineCounters const& counters() const { return counters_; }

  private:
    FirstLineConfig config_;
    ids::GooseRules rules_;
    FindingNews news_;
    FirstLineCounters counters_;
};

} // namespace gridspace::gateways
