// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/event_report.hpp"

#include "common/comtrade/comtrade_record.hpp"
#include "common/log.hpp"
#include "common/version.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <limits>
#include <utility>

namespace gridspace::relay {
namespace {

constexpr std::size_t kLogLines = 64;
/// Samples missing in a row that a record shows as missing; after a longer gap it goes on without the time between.
constexpr std::int64_t kLongestGap = 4800;

struct Digital {
    char const* name;
    bool (*of)(WaveformWindow::Row const&);
};
constexpr std::array<Digital, 5> kDigitals{{
    {"pickup", [](WaveformWindow::Row const& r) { return r.pickup; }},
    {"trip", [](WaveformWindow::Row const& r) { return r.trip; }},
    {"blocked", [](WaveformWindow::Row const& r) { return r.blocked != 0; }},
    {"from_received", [](WaveformWindow::Row const& r) { return r.from_present; }},
    {"to_received", [](WaveformWindow::Row const& r) { return r.to_present; }},
}};

std::size_t samples_in(double ms, double rate_hz) {
    return static_cast<std::size_t>(std::lround(ms * rate_hz / 1e3));
}

ComtradeRecord record_of(EventReportFacts const& facts, std::vector<WaveformWindow::Row> const& rows,
                         std::int64_t trigger_index, std::int64_t trigger_utc_ns) {
    static constexpr double kMissing = std::numeric_limits<double>::quiet_NaN();
    ComtradeRecord out;
    out.header.device = facts.process;
    out.header.line_frequency_hz = facts.frequency_hz;
    out.header.sample_rate_hz = facts.rate_hz;
    for (std::string const& group : {facts.from_stream, facts.to_stream, std::string{"differential"}}) {
        for (char const* phase : {"a", "b", "c"}) {
            out.header.analog.push_back({group + "." + phase, phase, "A", facts.process});
        }
    }
    for (Digital const& d : kDigitals) {
        out.header.digital.push_back({d.name, "", "", facts.process});
    }
    out.analog.resize(out.header.analog.size());
    out.digital.resize(out.header.digital.size());
    auto const put = [&](WaveformWindow::Row const* row) {
        for (std::size_t phase = 0; phase < 3; ++phase) {
            out.analog[phase].push_back(row != nullptr && row->from_present ? row->from_a[phase] : kMissing);
            out.analog[3 + phase].push_back(row != nullptr && row->to_present ? row->to_a[phase] : kMissing);
            out.analog[6 + phase].push_back(row != nullptr ? row->differential_a[phase] : kMissing);
        }
        for (std::size_t k = 0; k < kDigitals.size(); ++k) {
            out.digital[k].push_back(row != nullptr && kDigitals[k].of(*row));
        }
    };
    std::int64_t const ns_of_row = std::llround(1e9 / facts.rate_hz);
    std::int64_t rows_before = 0; // the trigger
    for (std::size_t i = 0; i < rows.size(); ++i) {
        std::int64_t const gap = i == 0 ? 0 : rows[i].index - rows[i - 1].index - 1;
        for (std::int64_t k = 0; gap <= kLongestGap && k < gap; ++k) {
            put(nullptr);
        }
        rows_before = rows[i].index == trigger_index ? static_cast<std::int64_t>(out.rows()) : rows_before;
        put(&rows[i]);
    }
    out.header.trigger_unix_ns = trigger_utc_ns;
    out.header.start_unix_ns = trigger_utc_ns - rows_before * ns_of_row;
    return out;
}

} // namespace

EventReport::EventReport(EventReportConfig const& config, EventReportFacts facts)
    : config_{config}, facts_{std::move(facts)},
      window_{samples_in(config.before_ms, facts_.rate_hz) + 1, samples_in(config.after_ms, facts_.rate_hz)} {}

EventReport::~EventReport() {
    finish();
}

void EventReport::sample(LineSample const& sample, RelayOutput const& output, std::int64_t utc_ns) {
    bool const now = config_.trigger == EventReportConfig::Trigger::pickup ? output.pickup : output.trip;
    if (now && !active_ && !triggered_) {
        window_.trigger();
        triggered_ = true;
        trigger_index_ = sample.index;
        trigger_utc_ns_ = utc_ns;
    }
    active_ = now;
    if (window_.push(sample, output)) {
        write();
    }
}

void EventReport::event(std::string line) {
    log_.push_back(std::move(line));
    if (log_.size() > kLogLines) {
        log_.pop_front();
    }
}

void EventReport::finish() {
    if (triggered_) {
        write();
    }
    if (writing_.valid()) {
        writing_.get();
    }
}

void EventReport::write() {
    std::vector<WaveformWindow::Row> rows;
    window_.drain([&](WaveformWindow::Row const& row) { rows.push_back(row); });
    triggered_ = false;
    std::string text = fmt::format(
        "{}, gridspace {}: one of its {}\r\n"
        "Currents of {} (from) and {} (to) as received: primary amperes, in the direction of the CTs.\r\n"
        "Differential: RMS, what the element compares with its pickup.\r\n\r\n",
        facts_.process, version().version, config_.trigger == EventReportConfig::Trigger::trip ? "trips" : "pickups",
        facts_.from_stream, facts_.to_stream);
    for (std::string const& line : log_) {
        text += line + "\r\n";
    }
    ++number_;
    if (writing_.valid()) {
        writing_.get(); // of the report before this one: done long ago, but on a full disk
    }
    // A relay that was restarted goes on behind the reports of its life before.
    std::error_code ignored;
    int n = number_;
    auto const base = [&] { return config_.folder / fmt::format("{}_{}", facts_.process, n); };
    while (std::filesystem::exists(base() += ".cfg", ignored)) {
        ++n;
    }
    writing_ = std::async(std::launch::async, [base = base(), text, facts = facts_, rows = std::move(rows),
                                               index = trigger_index_, utc_ns = trigger_utc_ns_] {
        std::error_code error;
        std::filesystem::create_directories(base.parent_path(), error); // what went wrong shows at the first file
        auto const written = write_comtrade(base, record_of(facts, rows, index, utc_ns), ComtradeFormat::binary);
        std::ofstream log{std::filesystem::path{base} += ".hdr", std::ios::trunc | std::ios::binary};
        log << text;
        if (!written || !log.flush()) {
            log::warning("event report: {}",
                         written ? fmt::format("cannot write '{}.hdr'", base.string()) : written.error().message);
        }
    });
}

} // namespace gridspace::relay
