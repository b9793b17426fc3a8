// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/detector_tables.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

std::string percent(ids::Share const& s) {
    if (s.of == 0) {
        return "-";
    }
    return fmt::format("{:.3g} % ({} of {}; 95 %: {:.2g} to {:.2g} %)", s.percent, s.count, s.of, s.low_percent,
                       s.high_percent);
}

std::string share(std::uint64_t of_these, std::uint64_t others) {
    return of_these + others == 0 ? "-"
                                  : fmt::format("{:.3g} %", 100.0 * static_cast<double>(of_these) /
                                                                static_cast<double>(of_these + others));
}

std::string instants(std::vector<std::int64_t> const& trips, double rate_hz) {
    std::string out;
    for (std::size_t i = 0; i < trips.size() && i < 3; ++i) {
        out += fmt::format("{}{:.4f} s", i == 0 ? "" : ", ", static_cast<double>(trips[i]) / rate_hz);
    }
    return trips.empty() ? "none" : trips.size() > 3 ? fmt::format("{} … ({} in all)", out, trips.size()) : out;
}

ReportTable verdict_table(IntrusionScore const& score) {
    ReportTable t{"Detectors: verdicts against the truth (phase-samples)",
                  {"detector", "stream", "forged, flagged", "forged, not flagged", "genuine, flagged",
                   "genuine, not flagged", "precision", "recall", "false positives", "open loop",
                   "samples of three phases with one", "open loop"},
                  {}};
    for (IntrusionScore::Stream const& s : score.streams) {
        t.rows.push_back({escape_markup(s.detector), escape_markup(s.stream), std::to_string(s.score.true_positives),
                          std::to_string(s.score.false_negatives), std::to_string(s.score.false_positives),
                          std::to_string(s.score.true_negatives),
                          share(s.score.true_positives, s.score.false_positives),
                          share(s.score.true_positives, s.score.false_negatives), percent(s.score.false_positive),
                          percent(s.score.open_false_positive), percent(s.packets), percent(s.open_packets)});
    }
    return t;
}

ReportTable attack_table(IntrusionScore const& score) {
    ReportTable t{"Attacks",
                  {"attack", "kind", "target", "detector", "altered", "detected", "of those beyond twice the threshold",
                   "open loop", "delay"},
                  {}};
    for (IntrusionScore::Attack const& a : score.attacks) {
        t.rows.push_back({escape_markup(a.score.attack), escape_markup(a.kind), escape_markup(a.target),
                          escape_markup(a.detector), std::to_string(a.score.labels), percent(a.score.detected),
                          percent(a.score.clear_detected), percent(a.score.open_detected),
                          a.score.seen ? fmt::format("{} samples ({:.2f} ms)", a.score.delay_samples,
                                                     static_cast<double>(a.score.delay_samples) / a.rate_hz * 1e3)
                                       : "never seen"});
    }
    for (IntrusionScore::Unjudged const& u : score.unjudged) {
        t.rows.push_back({escape_markup(u.attack), escape_markup(u.kind), escape_markup(u.target), "nobody watches it",
                          std::to_string(u.labels), "-", "-", "-", "-"});
    }
    return t;
}

/// Of those that a detector watches.
ReportTable relay_table(IntrusionScore const& score) {
    ReportTable t{"Relays with a detector: trips against the faults that really were",
                  {"relay", "line", "faults", "tripped", "blocked or late", "false trips", "trips",
                   "the same relay without a detector", "added by the detector", "alarms (false)"},
                  {}};
    for (IntrusionScore::Relay const& r : score.relays) {
        if (!r.watched) {
            continue;
        }
        std::string faults;
        for (double const at : r.faults_s) {
            faults += (faults.empty() ? "" : ", ") + shortest(at) + " s";
        }
        t.rows.push_back({escape_markup(r.relay), escape_markup(r.line), faults.empty() ? "none" : faults,
                          std::to_string(r.with.tripped), std::to_string(r.with.late_or_blocked),
                          std::to_string(r.with.false_trips), instants(r.trips, r.rate_hz),
                          instants(r.trips_without, r.rate_hz),
                          r.added_ms ? fmt::format("{:.2f} ms", *r.added_ms) : "-",
                          fmt::format("{} ({})", r.alarms, r.false_alarms)});
    }
    return t;
}

} // namespace

std::vector<ReportTable> detector_tables(IntrusionScore const& score) {
    std::vector<ReportTable> out;
    if (!score.streams.empty()) {
        out.push_back(verdict_table(score));
    }
    if (!score.attacks.empty() || !score.unjudged.empty()) {
        out.push_back(attack_table(score));
    }
    if (std::any_of(score.relays.begin(), score.relays.end(), [](auto const& r) { return r.watched; })) {
        out.push_back(relay_table(score));
    }
    return out;
}

std::vector<ReportTable> consequence_tables(Consequences const& c) {
    auto const power = [](double kw) { return fmt::format("{:.3g} kW", kw); };
    auto const energy = [](double wh) { return fmt::format("{:.3g} Wh", wh); };
    ReportTable sum{"What attacks and disturbances did to the grid", {"", ""}, {}};
    sum.rows.push_back({"trips lost", fmt::format("{} of {} faults", c.lost, c.faults)});
    sum.rows.push_back({"trips late", c.compared == 0 ? "not judged: no relay with a detector tripped on a fault"
                                                      : fmt::format("{} of {}", c.late, c.compared)});
    sum.rows.push_back(
        {"slowest trip", c.slowest_trip_ms ? fmt::format("{:.2f} ms after its fault", *c.slowest_trip_ms) : "-"});
    sum.rows.push_back({"trips without a fault", std::to_string(c.false_trips)});
    std::string opened;
    for (std::string const& breaker : c.opened_without_fault) {
        opened += (opened.empty() ? "" : ", ") + escape_markup(breaker);
    }
    sum.rows.push_back({"breakers opened without a fault", opened.empty() ? "none" : opened});
    sum.rows.push_back(
        {"load not served, at most", c.loads.empty() ? "not recorded: load.*.p_kw" : power(c.load_not_served_kw)});
    sum.rows.push_back({"energy not served", c.loads.empty() ? "-" : energy(c.energy_not_served_wh)});
    for (Consequences::Load const& load : c.loads) {
        if (load.not_served_wh > 0) {
            sum.rows.push_back(
                {"load " + escape_markup(load.load), fmt::format("{} of {}, {}", power(load.most_not_served_kw),
                                                                 power(load.asked_kw), energy(load.not_served_wh))});
        }
    }
    for (std::string const& load : c.loads.empty() ? std::vector<std::string>{} : c.unknown) {
        sum.rows.push_back({"load " + escape_markup(load), "not judged"});
    }
    for (AlarmScore::Attack const& attack : c.alarms.attacks) {
        sum.rows.push_back({"first alarm of " + escape_markup(attack.span.attack),
                            attack.delay_ms ? fmt::format("{:.2f} ms after its start, by {}", *attack.delay_ms,
                                                          escape_markup(attack.by))
                                            : "none"});
    }
    return {std::move(sum)};
}

} // namespace gridspace::launcher
