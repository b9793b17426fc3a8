// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/wire_timing_page.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;

std::string ms(double value) {
    std::string const text = fmt::format("{:.3f}", value);
    return text == "-0.000" ? "0.000" : text;
}

std::string captioned(std::string title, std::string const& published_as) {
    return published_as.empty() ? title : title + " (published as " + published_as + ")";
}

std::string verdict(bool within) {
    return within ? "<span class=\"ok\">✓</span>" : "<span class=\"bad\">✗</span>";
}

constexpr char const* kNotMeasurable = "not measurable";

/// Below what the arithmetic of doubles may lose it came before what caused it.
bool measurable(ChainStep const& step) {
    return step.since_before_ms && *step.since_before_ms >= -1e-6;
}

/// A delay below zero has no verdict.
std::string against(double delay_ms, bool measurable, double limit) {
    return measurable ? verdict(delay_ms <= limit) + fmt::format(" {:.4g} ms", limit) : kNotMeasurable;
}

ReportTable streams_table(WireTiming const& t, Published const& published) {
    ReportTable out{captioned("Sampled values", published.smv_figure),
                    {"stream", "received", "lost", "refused", "duplicate", "late", "rate, Hz", "off nominal",
                     "interval p50 / p99 / p99.9 / max, ms"},
                    {}};
    for (SmvTiming const& s : t.smv) {
        bool const measured = s.mean_hz > 0;
        auto const count = [&](std::size_t n) {
            return (s.not_counted.empty() ? "" : "at least ") + std::to_string(n);
        };
        bool const bad = s.lost > 0 || !s.not_counted.empty();
        out.rows.push_back(
            {escape_markup(s.captured ? s.stream + ", in the capture" : s.stream), count(s.received),
             bad ? fmt::format("<span class=\"bad\">{}</span>", count(s.lost)) : "0",
             s.captured      ? "–"
             : s.refused > 0 ? fmt::format("<span class=\"bad\">{}</span>", count(s.refused))
                             : count(s.refused),
             count(s.duplicate), count(s.late), measured ? fmt::format("{:.2f}", s.mean_hz) : "exact",
             measured && s.nominal_hz ? fmt::format("{:+.0f} ppm", (s.mean_hz / *s.nominal_hz - 1) * 1e6) : "–",
             measured ? fmt::format("{} / {} / {} / {}", ms(s.interval.p50), ms(s.interval.p99), ms(s.interval.p999),
                                    ms(s.interval.max))
                      : "–"});
    }
    if (published.smv_rate_hz) {
        out.rows.push_back(
            {"<i>published</i>", "", "", "", "", "", fmt::format("<i>{:.2f}</i>", *published.smv_rate_hz),
             t.smv.empty() || !t.smv[0].nominal_hz
                 ? ""
                 : fmt::format("<i>{:+.0f} ppm</i>", (*published.smv_rate_hz / *t.smv[0].nominal_hz - 1) * 1e6),
             ""});
    }
    out.note = t.lockstep
                   ? "Counted by smpCnt at the relay. Lockstep: frames are sent at simulated instants, so the "
                     "rate is exact and there is no jitter to measure."
                   : "Counted by smpCnt at the relay. Rate: the straight line that fits samples over arrivals best "
                     "(least squares). Intervals: between the receiving kernel's stamps "
                     "(CLOCK_REALTIME) of consecutive frames, at the relay's end of its cable.";
    out.note +=
        " Refused: simulated (S bit), damaged, or of another identity, revision or size; a frame refused is one that "
        "the relay misses, so its samples are among the lost too.";
    if (std::any_of(t.smv.begin(), t.smv.end(), [](SmvTiming const& s) { return s.captured; })) {
        out.note += " In the capture: counted by smpCnt in the captured frames, because no process of ours heard that "
                    "stream (or "
                    "not all of it); what its receiver got is not known, nor the delay to it.";
    }
    if (!t.not_seen.empty()) {
        out.note += fmt::format(" Neither counted nor captured: {}.", join(t.not_seen, ", "));
    }
    for (SmvTiming const& s : t.smv) {
        if (s.other_senders > 0) {
            out.note += fmt::format(" {}: {} more sender{} of this name; the counts are of the one with most frames.",
                                    s.stream, s.other_senders, s.other_senders == 1 ? "" : "s");
        }
        if (!s.not_counted.empty()) {
            out.note += fmt::format(" {}: {} is not known, it ended before it told.", s.stream, s.not_counted);
        }
    }
    return out;
}

void delay_row(ReportTable& table, std::string const& what, std::string const& which, Spread const& s,
               std::optional<double> published, Published const& all, bool of_class) {
    if (s.count == 0) {
        return;
    }
    auto const within = [&](double limit) { return of_class ? against(s.p99, s.measurable(), limit) : std::string{}; };
    if (!s.measurable()) {
        table.rows.push_back(
            {what, escape_markup(which), std::to_string(s.count),
             fmt::format("{}: {} of {} below 0, the lowest {}", kNotMeasurable, s.below_zero, s.count, ms(s.min)), "",
             "", "", "", "", within(kTransferClassMs), all.delay_limit_ms ? within(*all.delay_limit_ms) : ""});
        return;
    }
    table.rows.push_back({what, escape_markup(which), std::to_string(s.count), ms(s.mean),
                          published ? fmt::format("<i>{}</i>", ms(*published)) : "", ms(s.p50), ms(s.p99), ms(s.p999),
                          ms(s.max), within(kTransferClassMs), all.delay_limit_ms ? within(*all.delay_limit_ms) : ""});
}

ReportTable delays_table(WireTiming const& t, Published const& published) {
    ReportTable out{captioned("One-way delays, ms", published.delay_table),
                    {"delay", "of", "n", "mean", "published", "p50", "p99", "p99.9", "max", "IEC 61850-5, p99", ""},
                    {}};
    if (published.delay_limit_ms) {
        out.header.back() = "published limit, p99";
    }
    for (SmvTiming const& s : t.smv) {
        delay_row(out, "publish_age", s.stream, s.publish_age, std::nullopt, published, false);
    }
    for (SmvTiming const& s : t.smv) {
        delay_row(out, "wire_delay", s.stream, s.wire_delay, published.smv_delay_ms, published, true);
    }
    for (GooseTiming const& g : t.goose) {
        delay_row(out, "wire_delay", g.stream, g.wire_delay, published.goose_delay_ms, published, true);
    }
    for (RelayTiming const& r : t.relays) {
        delay_row(out, "transfer", r.relay, r.transfer, std::nullopt, published, true);
    }
    out.note = "Three delays, never mixed. publish_age: from the instant of the sample (start of the simulation clock "
               "plus simulated time) to the call that hands the frame to the kernel; it holds the wait "
               "for the DDS message to fill and the merging unit's buffer. wire_delay: from that call to the receiving "
               "kernel's stamp. transfer: from the instant of the sample to the relay's decision about it. "
               "All stamps are of one machine's clock; a delay below 0 shows that they are not, and is no delay: not "
               "measurable. Percentiles by nearest rank. The class is TT6 of IEC 61850-5 (3 "
               "ms).";
    if (published.smv_delay_ms || published.goose_delay_ms) {
        out.note += " The publication gives means only and no method.";
    }
    return out;
}

ReportTable chain_table(RelayTiming const& r, bool lockstep, Published const& published) {
    ReportTable out{fmt::format("From {} to open poles: {}", r.event, r.relay),
                    {"", "after " + r.event + ", ms", "since the step before, ms", "IEC 61850-5", "", "method"},
                    {}};
    if (published.delay_limit_ms) {
        out.header[4] = "published limit";
    }
    for (ChainStep const& step : r.chain) {
        auto const within = [&](double limit) {
            return !step.communication ? std::string{}
                   : lockstep          ? "declared, not measured"
                                       : against(step.since_before_ms.value_or(0), measurable(step), limit);
        };
        out.rows.push_back({escape_markup(step.what), ms(step.after_ms),
                            step.since_before_ms ? ms(*step.since_before_ms) : "– (another clock)",
                            within(kTransferClassMs), published.delay_limit_ms ? within(*published.delay_limit_ms) : "",
                            "<span class=\"dim\">" + escape_markup(step.method) + "</span>"});
    }
    if (r.foreign) {
        out.note =
            "The sender of this trip is not a relay of ours: when it picked up, decided and sent is not measurable. "
            "Counted from the newest fault of the timeline before the first command, or its newest event.";
        return out;
    }
    out.note = r.own_line ? "Counted from the newest fault on the line of the relay's own current transformers."
                          : "Counted from the newest fault of the timeline before the trip, or its newest event where "
                            "there was none: no fault is known on the line of the relay's own current transformers.";
    if (r.trips_s.size() > 1) {
        out.note += fmt::format(" The first of {} trips; not shown: that of the sample at", r.trips_s.size());
        for (std::size_t i = 1; i < r.trips_s.size(); ++i) {
            out.note += fmt::format("{} {} s", i == 1 ? "" : ",", shortest(r.trips_s[i]));
        }
        out.note += '.';
    }
    return out;
}

} // namespace

std::vector<ReportTable> chain_tables(WireTiming const& t, Published const& published) {
    std::vector<ReportTable> out;
    for (RelayTiming const& r : t.relays) {
        if (!r.chain.empty()) {
            out.push_back(chain_table(r, t.lockstep, published));
        }
    }
    return out;
}

std::vector<ReportTable> wire_timing_tables(WireTiming const& t, Published const& published) {
    std::vector<ReportTable> out;
    if (!t.smv.empty()) {
        out.push_back(streams_table(t, published));
    }
    if (ReportTable delays = delays_table(t, published); !delays.rows.empty()) {
        out.push_back(std::move(delays));
    }
    return out;
}

std::string wire_timing_json(WireTiming const& t) {
    auto const spread = [](Spread const& s) {
        return s.count == 0 ? Json(nullptr) : Json{{"n", s.count}, {"mean", s.mean},  {"p50", s.p50},
                                                   {"p99", s.p99}, {"p99_9", s.p999}, {"max", s.max}};
    };
    auto const delay = [&](Spread const& s) {
        return s.measurable()
                   ? spread(s)
                   : Json{{"n", s.count}, {"not_measurable", {{"below_zero", s.below_zero}, {"min", s.min}}}};
    };
    Json out{{"clock", t.lockstep ? "lockstep" : "realtime"},
             {"class_ms", kTransferClassMs},
             {"smv", Json::object()},
             {"goose", Json::object()},
             {"relays", Json::object()}};
    for (SmvTiming const& s : t.smv) {
        out["smv"][s.captured && out["smv"].contains(s.stream) ? s.stream + " (capture)" : s.stream] = {
            {"received", s.received},
            {"lost", s.lost},
            {"refused", s.captured ? Json(nullptr) : Json(s.refused)},
            {"duplicate", s.duplicate},
            {"late", s.late},
            {"from_capture", s.captured},
            {"not_counted", s.not_counted.empty() ? Json(nullptr) : Json(s.not_counted)},
            {"rate_hz", s.mean_hz > 0 ? Json(s.mean_hz) : Json(nullptr)},
            {"interval_ms", spread(s.interval)},
            {"publish_age_ms", delay(s.publish_age)},
            {"wire_delay_ms", delay(s.wire_delay)}};
    }
    for (GooseTiming const& g : t.goose) {
        Json burst = Json::array();
        for (std::size_t i = g.event.value_or(g.interval_ms.size()); i < g.interval_ms.size() && burst.size() < 8;
             ++i) {
            burst.push_back(g.interval_ms[i]);
        }
        out["goose"][g.stream] = {{"from_capture", g.captured},
                                  {"messages", g.messages},
                                  {"steady_interval_ms", g.steady_ms ? Json(*g.steady_ms) : Json(nullptr)},
                                  {"burst_ms", burst},
                                  {"wire_delay_ms", delay(g.wire_delay)}};
    }
    for (RelayTiming const& r : t.relays) {
        Json chain = Json::array();
        for (ChainStep const& step : r.chain) {
            Json one{{"step", step.what},
                     {"after_event_ms", step.after_ms},
                     {"since_before_ms", step.since_before_ms ? Json(*step.since_before_ms) : Json(nullptr)},
                     {"method", step.method}};
            if (step.communication) {
                one["within_class"] =
                    measurable(step) ? Json(*step.since_before_ms <= kTransferClassMs) : Json(nullptr);
            }
            chain.push_back(std::move(one));
        }
        out["relays"][r.relay] = {{"event", r.event.empty() ? Json(nullptr) : Json(r.event)},
                                  {"trips_s", r.trips_s},
                                  {"transfer_ms", delay(r.transfer)},
                                  {"chain", chain}};
    }
    return out.dump();
}

} // namespace gridspace::launcher
