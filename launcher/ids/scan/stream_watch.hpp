// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/first_line/first_line.hpp"
#include "launcher/ids/scan/known_streams.hpp"
#include "launcher/ids/scan/stream_forecast.hpp"

#include <map>

namespace gridspace::scan {

/// A stream at one place of the network: all frames with its name, from any sender.
struct StreamScan {
    std::string vantage;
    bool goose{false};
    std::string id;                                 ///< svID or gocbRef, for people
    std::vector<wire::ObservedStream> senders;      ///< most frames first
    std::map<iec61850::Mac, std::uint64_t> foreign; ///< frames of other addresses than the first one
    std::uint64_t conf_rev_changes{0}, simulated{0};
    // sampled values
    std::string layout;
    bool readable{false}; ///< its currents
    std::uint64_t gaps{0}, jumps{0}, synch_changes{0}, not_good{0};
    std::uint8_t lowest_synch{255};
    ForecastResult forecast;
    std::vector<Alarm> alarms; ///< by first frame
};

/// What all streams have in common.
class SenderWatch {
  public:
    void see(iec61850::FrameHeader const& header, std::uint32_t conf_rev, bool simulated, Place at);
    /// `alive`: at the end of the capture a frame of it could still come.
    void finish(std::int64_t end_ns, bool alive);
    /// Findings of the first-line rules, by name.
    void raise(std::string const& names, iec61850::FrameHeader const& header, Place at);
    void raise_rule(std::string const& rule, Place at) { alarms_.raise(rule, at); }
    void report(StreamScan& out) const;
    [[nodiscard]] Place last() const { return last_; }

  private:
    static constexpr std::size_t kMostForeign = 256; ///< addresses; further ones count as the last of them
    bool started_{false};
    iec61850::Mac source_;
    std::uint32_t conf_rev_{0};
    std::uint64_t conf_rev_changes_{0}, simulated_{0};
    std::map<iec61850::Mac, std::uint64_t> foreign_;
    Place last_;
    Alarms alarms_;
};

class SvWatch {
  public:
    /// `alone`: its currents are judged by themselves; false where a line has both ends.
    SvWatch(SvDescription const& description, ForecastSettings const& settings, bool alone);

    /// ASDU `place` of a frame, of this svID.
    void take(iec61850::FrameHeader const& header, iec61850::Asdu const& asdu, std::size_t place, Place at);
    void finish(std::int64_t end_ns, bool alive);
    void report(StreamScan& out) const;

  private:
    SvDescription description_;
    gateways::SvFirstLine first_line_;
    iec61850::SvSubscriber subscriber_;
    std::optional<relay::SampleReader> reader_;
    std::optional<StreamForecast> forecast_;
    std::string why_not_;
    SenderWatch sender_;
    std::optional<std::uint8_t> synch_;
    std::uint8_t lowest_synch_{255};
    std::uint64_t synch_changes_{0}, not_good_{0};
};

class GooseWatch {
  public:
    /// `described`: nullptr when nobody has said how often it comes.
    GooseWatch(streams::Stream const* described, bool check_clock);

    void take(iec61850::GooseFrame const& message, Place at);
    void finish(std::int64_t end_ns, bool alive) { sender_.finish(end_ns, alive); }
    void report(StreamScan& out) const { sender_.report(out); }

  private:
    gateways::GooseFirstLine first_line_;
    SenderWatch sender_;
    std::int64_t live_until_ns_{INT64_MAX};
};

} // namespace gridspace::scan
