// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/first_line/first_line_config.hpp"
#include "gateways/iec61850/goose.hpp"
#include "gateways/iec61850/sv.hpp"
#include "ids/rules/goose_rules.hpp"
#include "ids/rules/sv_rules.hpp"

#include <array>
#include <span>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// Findings of an arriving frame that say nothing about somebody at work: samples before it are missing, or it came at
/// an odd moment. They are counted and raise no alarm.
inline constexpr std::uint32_t kHarmlessSvFindings = ids::kGap | ids::kBadArrival;

/// Names of the counters of a stream of sampled values or of GOOSE: its findings, "refused", and for samples
/// "contested".
[[nodiscard]] std::vector<std::string> first_line_counters(bool sampled_values);

/// The first-line rules in front of one subscribed stream of sampled values. Pure; no allocation.
class SvFirstLine {
  public:
    /// `judge_arrival`: false in lockstep, where the moment of arrival says nothing.
    SvFirstLine(FirstLineConfig const& config, double rate_hz, bool accept_test, bool judge_arrival);

    struct Verdict {
        bool use{true}; ///< what the configuration makes of it
        bool contested{
            false}; ///< another frame with the address of the stream claimed the same sample with other values
        std::uint32_t findings{0};
    };
    /// ASDU `place` of a frame, of this stream's svID.
    Verdict judge(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu, std::size_t place,
                  std::int64_t arrival_ns);

    [[nodiscard]] std::span<std::uint64_t const> counters() const { return rules_.counters(); }
    [[nodiscard]] std::uint64_t refused() const { return refused_; }
    [[nodiscard]] std::uint64_t contested() const { return contested_; }

  private:
    FirstLineConfig config_;
    double rate_hz_;
    ids::SvRules rules_;
    struct Said {
        std::uint16_t smp_cnt{0};
        std::uint64_t value_hash{0};
    };
    std::array<Said, 32> said_{}; ///< the newest samples, by counter
    std::size_t next_said_{0}, remembered_{0};
    std::uint64_t refused_{0}, contested_{0};
};

/// The same in front of one subscribed GOOSE control block.
class GooseFirstLine {
  public:
    /// `longest_live_ms`: timeAllowedToLive in steady state.
    GooseFirstLine(FirstLineConfig const& config, double min_time_ms, double max_time_ms, bool accept_test,
                   double longest_live_ms);

    struct Verdict {
        bool use{true};
        bool contested{false}; ///< to be used although its counters are not next; see ids::GooseRules
        std::uint32_t findings{0};
    };
    Verdict judge(iec61850::GooseFrame const& message, std::int64_t utc_ns);
    /// The subscriber's timeAllowedToLive has run out.
    void expired() { rules_.expired(); }

    [[nodiscard]] std::span<std::uint64_t const> counters() const { return rules_.counters(); }
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

  private:
    FirstLineConfig config_;
    ids::GooseRules rules_;
    std::uint64_t refused_{0};
};

/// An alarm that is on while suspicious frames come. It goes off when a whole report interval has passed without one.
class FirstLineAlarm {
  public:
    /// A finding; true when the alarm comes on, or has not had one of this kind since it did.
    bool raise(std::uint32_t findings) {
        bool const news = !on_ || (findings & ~findings_) != 0;
        findings_ |= findings;
        on_ = fresh_ = true;
        return news;
    }
    /// Once per report interval: true when the alarm goes off.
    bool settle() {
        bool const off = on_ && !fresh_;
        if (off) {
            on_ = false;
            findings_ = 0;
        }
        fresh_ = false;
        return off;
    }
    [[nodiscard]] bool on() const { return on_; }

  private:
    bool on_{false}, fresh_{false};
    std::uint32_t findings_{0};
};

} // namespace gridspace::gateways
