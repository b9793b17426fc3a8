// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/scan/scan_output.hpp"

#include "launcher/ids/scan/scan_rows.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <utility>

namespace gridspace::scan {
namespace {

using Json = nlohmann::ordered_json;

Json to_json(Place const& at, CaptureScan const& scan) {
    return {{"frame", at.frame}, {"time_s", scan.seconds(at)}, {"time_ns", at.time_ns}};
}

Json to_json(std::vector<Alarm> const& alarms, CaptureScan const& scan) {
    Json out = Json::array();
    for (Alarm const& a : alarms) {
        out.push_back({{"rule", a.rule},
                       {"count", a.count},
                       {"first", to_json(a.first, scan)},
                       {"last", to_json(a.last, scan)},
                       {"what", a.what}});
    }
    return out;
}

Json to_json(ForecastResult const& f) {
    return f.why_not.empty() ? Json{{"samples", f.samples},
                                    {"flagged", f.flagged},
                                    {"sigma_percent", f.sigma_percent},
                                    {"nominal_peak_a", f.nominal_peak_a}}
                             : Json{{"not_judged", f.why_not}};
}

Json to_json(StreamScan const& s, CaptureScan const& scan) {
    wire::ObservedStream const& main = s.senders.front();
    Counts const c = counts_of(s);
    Json foreign = Json::object();
    for (auto const& [address, frames] : s.foreign) {
        foreign[address.to_string()] = frames;
    }
    Json out{{"place", s.vantage},
             {"kind", s.goose ? "goose" : "smv"},
             {"id", s.id},
             {"app_id", main.app_id},
             {"source", main.source.to_string()},
             {"destination", main.destination.to_string()},
             {"vlan", main.vlan ? Json{{"id", main.vlan->id}, {"priority", main.vlan->priority}} : Json(nullptr)},
             {"frames", c.frames},
             {"rate_hz", main.rate_hz()},
             {"lost", c.lost},
             {"duplicates", c.duplicates},
             {"out_of_order", c.out_of_order},
             {"restarts", c.restarts},
             {"conf_rev", main.conf_rev},
             {"conf_rev_changes", s.conf_rev_changes},
             {"simulated", s.simulated},
             {"foreign_sources", foreign}};
    if (s.goose) {
        out["states"] = c.states;
        out["st_num"] = main.st_num;
    } else {
        out.update({{"samples_per_frame", main.asdus},
                    {"sample_octets", main.sample_octets},
                    {"layout", s.layout},
                    {"gaps", s.gaps},
                    {"smp_cnt_jumps", s.jumps},
                    {"smp_synch", main.smp_synch},
                    {"lowest_smp_synch", s.lowest_synch},
                    {"smp_synch_changes", s.synch_changes},
                    {"not_good", s.not_good},
                    {"forecast", to_json(s.forecast)}});
    }
    out["alarms"] = to_json(s.alarms, scan);
    return out;
}

Json to_json(LineScan const& l, CaptureScan const& scan) {
    return {{"place", l.vantage},
            {"from", l.from},
            {"to", l.to},
            {"pairs", l.pairs},
            {"pickup_a", l.pickup_a},
            {"pickups", l.pickups},
            {"from_forecast", to_json(l.from_forecast)},
            {"to_forecast", to_json(l.to_forecast)},
            {"alarms", to_json(l.alarms, scan)}};
}

/// Columns as wide as what stands in them; the first left, numbers right.
std::string text_table(std::vector<std::vector<std::string>> const& rows, std::size_t left) {
    std::vector<std::size_t> widths(rows.front().size());
    for (auto const& row : rows) {
        for (std::size_t c = 0; c < row.size(); ++c) {
            widths[c] = std::max(widths[c], row[c].size());
        }
    }
    std::string out;
    for (auto const& row : rows) {
        std::string line;
        for (std::size_t c = 0; c < row.size(); ++c) {
            bool const last = c + 1 == row.size();
            line += c < left || last ? (last ? row[c] : fmt::format("{:<{}}  ", row[c], widths[c]))
                                     : fmt::format("{:>{}}  ", row[c], widths[c]);
        }
        out += line.substr(0, line.find_last_not_of(' ') + 1) + "\n";
    }
    return out;
}

} // namespace

std::string to_text(CaptureScan const& scan, std::filesystem::path const& file) {
    std::string out = fmt::format("{}: {} frames in {:.6f} s", file.string(), scan.frames,
                                  static_cast<double>(scan.last_ns - scan.first_ns) * 1e-9);
    for (std::string const& note : notes_of(scan)) {
        out += "\nnote: " + note;
    }
    out += "\n\n" + text_table(stream_rows(scan), 4);
    if (auto const lines = line_rows(scan); lines.size() > 1) {
        out += "\n" + text_table(lines, 3);
    }
    if (!scan.has_alarms()) {
        return out + "\nno alarm\n";
    }
    return out + "\nalarms; the frame is Wireshark's frame.number, the time that since the first frame\n" +
           text_table(alarm_rows(scan), 3);
}

std::string to_json(CaptureScan const& scan, std::filesystem::path const& file) {
    Json out{{"capture", file.string()},
             {"frames", scan.frames},
             {"seconds", static_cast<double>(scan.last_ns - scan.first_ns) * 1e-9},
             {"first_ns", scan.first_ns},
             {"truncated", scan.truncated},
             {"other", scan.other},
             {"no_ethernet", scan.no_ethernet},
             {"cut", scan.cut},
             {"undecodable", scan.errors.total()},
             {"not_watched", scan.beyond_table},
             {"alarms", scan.has_alarms()},
             {"streams", Json::array()},
             {"lines", Json::array()}};
    for (StreamScan const& s : scan.streams) {
        out["streams"].push_back(to_json(s, scan));
    }
    for (LineScan const& l : scan.lines) {
        out["lines"].push_back(to_json(l, scan));
    }
    return out.dump(2) + "\n";
}

} // namespace gridspace::scan
