// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/scan_rows.hpp"

#include "common/text.hpp"
#include "launcher/ids/scan/scan_output.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <map>

namespace gridspace::scan {
namespace {

std::string number(std::uint64_t n) {
    return n == 0 ? "-" : std::to_string(n);
}

std::string rate(double hz) {
    return hz <= 0 ? "-" : fmt::format("{:.1f}", hz);
}

std::string plural(std::uint64_t n, std::string const& what) {
    return fmt::format("{} {}{}", n, what, n == 1 ? "" : "s");
}

std::string forecast_of(ForecastResult const& f) {
    return f.why_not.empty() ? fmt::format("{} of {}", f.flagged, f.samples) : "not judged";
}

std::uint64_t total(std::vector<Alarm> const& alarms) {
    std::uint64_t out = 0;
    for (Alarm const& a : alarms) {
        out += a.count;
    }
    return out;
}

void add_alarms(Rows& out, CaptureScan const& scan, std::vector<Alarm> const& alarms, std::string const& of,
                std::string const& where, bool goose) {
    for (Alarm const& a : alarms) {
        out.push_back({a.rule, of, where, fmt::format("{:.6f}", scan.seconds(a.first)), std::to_string(a.first.frame),
                       std::to_string(a.count), std::to_string(a.last.frame),
                       meaning_of(a.rule, goose) + (a.what.empty() ? "" : "; " + a.what)});
    }
}

} // namespace

Counts counts_of(StreamScan const& stream) {
    Counts out;
    for (wire::ObservedStream const& s : stream.senders) {
        out.frames += s.frames;
        out.lost += s.lost;
        out.duplicates += s.duplicates;
        out.out_of_order += s.out_of_order;
        out.restarts += s.restarts;
        out.states += s.states;
    }
    return out;
}

Rows stream_rows(CaptureScan const& scan) {
    Rows out{{"", "stream", "seen at", "source", "APPID", "frames", "rate 1/s", "lost", "copies", "jumps", "confRev",
              "not good", "smpSynch", "foreign", "alarms", "off forecast"}};
    for (StreamScan const& s : scan.streams) {
        wire::ObservedStream const& main = s.senders.front();
        Counts const c = counts_of(s);
        std::uint64_t foreign = 0;
        for (auto const& [address, frames] : s.foreign) {
            foreign += frames;
        }
        std::string const synch = s.goose                ? ""
                                  : s.synch_changes == 0 ? std::to_string(main.smp_synch)
                                                         : fmt::format("{}..{}", s.lowest_synch, main.smp_synch);
        out.push_back({s.goose ? "GOOSE" : "SMV", s.id, s.vantage, main.source.to_string(),
                       fmt::format("0x{:04X}", main.app_id), std::to_string(c.frames), rate(main.rate_hz()),
                       number(c.lost), number(c.duplicates), number(s.goose ? c.restarts : s.jumps),
                       number(s.conf_rev_changes), s.goose ? "" : number(s.not_good), synch, number(foreign),
                       number(total(s.alarms)), s.goose ? "" : forecast_of(s.forecast)});
    }
    return out;
}

Rows line_rows(CaptureScan const& scan) {
    Rows out{{"line from", "to", "seen at", "pairs", "pickups", "alarms", "off forecast, from", "off forecast, to"}};
    for (LineScan const& l : scan.lines) {
        out.push_back({l.from, l.to, l.vantage, std::to_string(l.pairs), number(l.pickups), number(total(l.alarms)),
                       forecast_of(l.from_forecast), forecast_of(l.to_forecast)});
    }
    return out;
}

Rows alarm_rows(CaptureScan const& scan) {
    Rows out{{"rule", "stream", "seen at", "first at, s", "frame", "times", "last frame", "meaning"}};
    for (StreamScan const& s : scan.streams) {
        add_alarms(out, scan, s.alarms, s.id, s.vantage, s.goose);
    }
    for (LineScan const& l : scan.lines) {
        add_alarms(out, scan, l.alarms, l.from + " - " + l.to, l.vantage, false);
    }
    return out;
}

std::vector<std::string> notes_of(CaptureScan const& scan) {
    std::vector<std::string> out;
    if (scan.truncated) {
        out.emplace_back("the file ends in the middle of a frame: what is whole was judged");
    }
    if (scan.other > 0) {
        out.push_back(plural(scan.other, "frame") + " of other protocols");
    }
    if (scan.no_ethernet > 0) {
        out.push_back(plural(scan.no_ethernet, "frame") + " of interfaces that are no Ethernet: not looked at");
    }
    if (scan.cut > 0) {
        out.push_back(plural(scan.cut, "frame") + " cut by the capture (its snap length)");
    }
    if (scan.beyond_table > 0) {
        out.push_back(plural(scan.beyond_table, "frame") + " of more streams or interfaces than are watched");
    }
    std::map<std::string, std::vector<std::string>> not_judged; // by reason; reported once
    for (StreamScan const& s : scan.streams) {
        if (!s.goose && !s.forecast.why_not.empty()) {
            not_judged[s.forecast.why_not].push_back(s.id);
        }
    }
    for (LineScan const& l : scan.lines) {
        if (!l.from_forecast.why_not.empty()) {
            not_judged[l.from_forecast.why_not].push_back(l.from + " - " + l.to);
        }
    }
    for (auto const& [why, names] : not_judged) {
        out.push_back(fmt::format("{}: not judged by the forecaster: {}", join(names, ", "), why));
    }
    for (std::size_t i = 0; i < iec61850::kReasons; ++i) {
        if (scan.errors.by_reason[i] > 0) {
            out.push_back(plural(scan.errors.by_reason[i], "frame") +
                          " could not be read: " + std::string{reason_name(static_cast<iec61850::Reason>(i))});
        }
    }
    return out;
}

std::string meaning_of(std::string const& rule, bool goose) {
    static constexpr std::array<std::pair<char const*, char const*>, 26> kMeanings{{
        {"wrong_source", "from another address than the first one"},
        {"wrong_identity", "another APPID, VLAN, data set or confRev than the first one"},
        {"duplicate", "a sample that was there already"},
        {"contested", "another sample with the same counter, from the same address"},
        {"out_of_order", "a sample older than the last one"},
        {"simulated", "marked as simulated"},
        {"unsynchronised", "smpSynch fell"},
        {"bad_counter", "smpCnt beyond the rate"},
        {"smp_cnt_jump", "smpCnt goes on somewhere else than time explains"},
        {"silent", "the stream ends before the capture"},
        {"off_forecast", "the samples before do not explain it: a disturbance or a forgery (--line tells them apart)"},
        {"old", "not newer than the last message: a replay, or a copy"},
        {"jump", "stNum rose by more than one"},
        {"old_time", "a new state with an older time"},
        {"clock", "the time of a new state is more than 2 s from the capture's"},
        {"commissioning", "marked as needing commissioning"},
        {"flood", "more messages than retransmission explains"},
        {"stretched", "its time to live is far longer than the usual one"},
        {"silent_change", "the values changed and stNum did not"},
        {"contest", "two publishers with one address: each goes on where the other is not"},
        {"time_to_live", "it came after the time to live of the message before"},
        {"one_end", "a change of the current that only one end saw: a forgery of one stream"},
        {"unconfirmed", "the differential element picks up without evidence from both ends"},
        {"noise", "the currents are so noisy that small forgeries would hide"},
        {"not_armed", "the two ends differ all the time: no fault could be confirmed"},
        {"locked_out", "most samples are off their forecast"},
    }};
    if (goose && rule == "silent") {
        return "the stream ends before the capture, by more than its time to live";
    }
    auto const at = std::find_if(kMeanings.begin(), kMeanings.end(), [&](auto const& m) { return rule == m.first; });
    return at == kMeanings.end() ? "" : at->second;
}

} // namespace gridspace::scan
