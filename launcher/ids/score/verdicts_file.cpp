// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/score/verdicts_file.hpp"

#include "common/config/yaml.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::score {
namespace {

enum Column : std::uint8_t { kStream, kSample, kTime, kPhase, kVerdict, kScore, kAlarm };
constexpr std::array<char const*, 7> kNames{"stream", "sample", "time_s", "phase", "verdict", "score", "alarm"};

struct Cell {
    std::string_view text;
    int column{1};
};

std::vector<Cell> cells_of(std::string_view line) {
    std::vector<Cell> out;
    for (std::size_t from = 0; from <= line.size();) {
        std::size_t const to = std::min(line.find(',', from), line.size());
        std::string_view const raw = line.substr(from, to - from), text = trim(raw);
        std::size_t const blank = text.empty() ? 0 : raw.find(text.front());
        out.push_back({text, static_cast<int>(from + blank) + 1});
        from = to + 1;
    }
    return out;
}

template <class T>
std::optional<T> number(std::string_view text) {
    T value{};
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    return error == std::errc{} && end == text.data() + text.size() ? std::optional{value} : std::nullopt;
}

class Parser {
  public:
    Parser(std::shared_ptr<config::SourceText const> source, Extent const& extent, std::optional<double> threshold,
           config::Diagnostics& diagnostics)
        : source_{std::move(source)}, extent_{extent}, threshold_{threshold}, diagnostics_{diagnostics} {}

    std::optional<Verdicts> parse() {
        std::size_t line = 0;
        while (line < source_->lines.size() && is_skipped(line)) {
            ++line;
        }
        if (line == source_->lines.size()) {
            diagnostics_.error({source_, 0, 0}, "the file is empty", "expected a row of names: stream,sample,verdict");
            return std::nullopt;
        }
        if (!read_header(line)) {
            return std::nullopt;
        }
        for (++line; line < source_->lines.size() && !diagnostics_.full(); ++line) {
            if (!is_skipped(line)) {
                out_.is_alarms ? read_alarm(line) : read_row(line);
            }
        }
        if (diagnostics_.ok() && !out_.is_alarms && out_.all.empty()) { // no alarm at all is an answer
            diagnostics_.error({source_, 0, 0}, "there is no row below the names");
        }
        return diagnostics_.ok() ? std::optional{std::move(out_)} : std::nullopt;
    }

  private:
    [[nodiscard]] bool is_skipped(std::size_t line) const {
        std::string_view const text = trim(source_->lines[line]);
        return text.empty() || text.front() == '#';
    }
    void wrong(std::size_t line, Cell const& cell, std::string message, std::string hint = {}) {
        diagnostics_.error({source_, static_cast<int>(line) + 1, cell.column}, std::move(message), std::move(hint),
                           std::max(static_cast<int>(cell.text.size()), 1));
    }

    bool read_header(std::size_t line) {
        std::string_view text = source_->lines[line];
        if (text.starts_with("\xef\xbb\xbf")) { // a spreadsheet's mark of UTF-8
            text.remove_prefix(3);
        }
        auto const cells = cells_of(text);
        columns_ = cells.size();
        for (std::size_t c = 0; c < cells.size(); ++c) {
            auto const at = std::find(kNames.begin(), kNames.end(), cells[c].text);
            if (at == kNames.end()) {
                continue; // whatever else the detector's author wants to keep
            }
            auto& place = places_[static_cast<std::size_t>(at - kNames.begin())];
            if (place) {
                wrong(line, cells[c], fmt::format("the column '{}' is there twice", cells[c].text), "remove one");
            }
            place = c;
        }
        auto const missing = [&](std::string const& what, std::string const& why) {
            wrong(line, cells.front(), fmt::format("there is no column '{}'", what), why);
        };
        if (places_[kAlarm]) {
            return check_alarm_header(line, cells);
        }
        if (places_[kSample].has_value() == places_[kTime].has_value()) {
            places_[kSample]
                ? wrong(line, cells[*places_[kTime]], "both 'sample' and 'time_s'", "which of the two counts?")
                : missing("sample", "or 'time_s': which sample a row is about");
        }
        if (!places_[kVerdict] && !places_[kScore]) {
            missing("verdict", "0 or 1; or 'score', higher for more suspicious");
        }
        if (!places_[kVerdict] && places_[kScore] && !threshold_) {
            missing("verdict", "or --threshold X: flagged from this score on");
        }
        if (!places_[kStream] && extent_.only_stream.empty()) {
            missing("stream", "several streams were attacked");
        }
        out_.has_verdicts = places_[kVerdict].has_value();
        out_.has_scores = places_[kScore].has_value();
        out_.by_phase = places_[kPhase].has_value();
        return diagnostics_.ok();
    }

    bool check_alarm_header(std::size_t line, std::vector<Cell> const& cells) {
        for (Column const other : {kStream, kSample, kPhase, kVerdict, kScore}) {
            if (places_[other]) {
                wrong(line, cells[*places_[other]], fmt::format("both 'alarm' and '{}'", kNames[other]),
                      "a file is about samples, or says when an alarm came and went: time_s,alarm");
            }
        }
        if (!places_[kTime]) {
            wrong(line, cells[*places_[kAlarm]], "there is no column 'time_s'", "when the alarm came or went");
        }
        out_.is_alarms = true;
        return diagnostics_.ok();
    }

    [[nodiscard]] bool has_all_cells(std::size_t line, std::vector<Cell> const& cells) {
        if (cells.size() != columns_) {
            wrong(line, cells.back(), fmt::format("{} cells, where the row of names has {}", cells.size(), columns_));
        }
        return cells.size() == columns_;
    }

    void read_alarm(std::size_t line) {
        auto const cells = cells_of(source_->lines[line]);
        if (!has_all_cells(line, cells)) {
            return;
        }
        Cell const& when = cells[*places_[kTime]];
        auto const time_s = read_time(line, when);
        auto const stands = read_binary(line, cells[*places_[kAlarm]], "state of an alarm");
        if (!time_s || !stands) {
            return;
        }
        if (*time_s < 0 || *time_s > extent_.end_s) {
            wrong(line, when, fmt::format("'{}' is outside the run", when.text),
                  fmt::format("it lasts from 0 to {} s", extent_.end_s));
        } else if (!out_.alarm_from_s.try_emplace(*time_s, *stands).second) {
            wrong(line, when, fmt::format("two rows at {} s", when.text));
        }
    }

    void read_row(std::size_t line) {
        auto const cells = cells_of(source_->lines[line]);
        if (!has_all_cells(line, cells)) {
            return;
        }
        auto const cell = [&](Column c) { return cells[*places_[c]]; };
        SampleKey key{places_[kStream] ? std::string{cell(kStream).text} : extent_.only_stream};
        if (auto const named = extent_.names.find(key.stream); named != extent_.names.end()) {
            key.stream = named->second;
        }
        auto const rate = extent_.rates_hz.find(key.stream);
        if (rate == extent_.rates_hz.end()) {
            std::vector<std::string> names;
            for (auto const& [name, hz] : extent_.rates_hz) {
                names.push_back(name);
            }
            wrong(line, cell(kStream), fmt::format("the run has no stream of sampled values '{}'", key.stream),
                  spelling_hint(key.stream, names));
            return;
        }
        auto const index = read_index(line, places_[kSample] ? cell(kSample) : cell(kTime), rate->second);
        if (!index || !read_phase(line, cells, key)) {
            return;
        }
        key.index = *index;
        Verdict verdict;
        if (!read_verdict(line, cells, verdict)) {
            return;
        }
        Cell const& which = cells[places_[kSample] ? *places_[kSample] : *places_[kTime]];
        if (key.index < 0 || key.index >= extent_.samples(key.stream)) {
            wrong(line, which, fmt::format("'{}' is outside the run", which.text),
                  fmt::format("it has the samples 0 to {} of '{}', until {} s", extent_.samples(key.stream) - 1,
                              key.stream, extent_.end_s));
        } else if (!out_.all.try_emplace(key, verdict).second) {
            wrong(line, which, fmt::format("sample {} of '{}' has a verdict already", key.index, key.stream),
                  out_.by_phase ? "one row for each phase of a sample"
                                : "one row for each sample; with a column 'phase', one for each phase");
        }
    }

    std::optional<std::int64_t> read_index(std::size_t line, Cell const& cell, double rate_hz) {
        if (places_[kSample]) {
            auto const out = number<std::int64_t>(cell.text);
            if (!out) {
                wrong(line, cell, fmt::format("'{}' is no number of a sample", cell.text),
                      "second of the run times rate, plus smpCnt");
            }
            return out;
        }
        auto const time_s = read_time(line, cell);
        return time_s ? std::optional{std::llround(*time_s * rate_hz)} : std::nullopt;
    }

    std::optional<double> read_time(std::size_t line, Cell const& cell) {
        auto const time_s = number<double>(cell.text);
        if (!time_s || !(std::fabs(*time_s) <= 1e9)) {
            wrong(line, cell, fmt::format("'{}' is no time", cell.text), "seconds since the start of the run");
            return std::nullopt;
        }
        return time_s;
    }

    std::optional<bool> read_binary(std::size_t line, Cell const& cell, char const* what) {
        if (cell.text != "0" && cell.text != "1") {
            wrong(line, cell, fmt::format("'{}' is no {}", cell.text, what), "0 or 1");
            return std::nullopt;
        }
        return cell.text == "1";
    }

    bool read_phase(std::size_t line, std::vector<Cell> const& cells, SampleKey& key) {
        if (!out_.by_phase) {
            return true;
        }
        Cell const& cell = cells[*places_[kPhase]];
        std::size_t const at =
            cell.text.size() == 1 ? std::string_view{"abc"}.find(cell.text.front()) : std::string_view::npos;
        if (at == std::string_view::npos) {
            wrong(line, cell, fmt::format("'{}' is no phase", cell.text), "a, b or c");
            return false;
        }
        key.phase = static_cast<std::uint8_t>(at);
        return true;
    }

    bool read_verdict(std::size_t line, std::vector<Cell> const& cells, Verdict& out) {
        if (out_.has_scores) {
            Cell const& cell = cells[*places_[kScore]];
            auto const score = number<double>(cell.text);
            if (!score || std::isnan(*score)) {
                wrong(line, cell, fmt::format("'{}' is no score", cell.text), "a number, higher for more suspicious");
                return false;
            }
            out.score = *score;
            out.flagged = threshold_ && *score >= *threshold_;
        }
        if (out_.has_verdicts && !(threshold_ && out_.has_scores)) {
            auto const flagged = read_binary(line, cells[*places_[kVerdict]], "verdict");
            out.flagged = flagged.value_or(false);
            return flagged.has_value();
        }
        return true;
    }

    std::shared_ptr<config::SourceText const> source_;
    Extent const& extent_;
    std::optional<double> threshold_;
    config::Diagnostics& diagnostics_;
    std::array<std::optional<std::size_t>, kNames.size()> places_;
    std::size_t columns_{0};
    Verdicts out_;
};

} // namespace

std::int64_t Extent::samples(std::string const& stream) const {
    auto const rate = rates_hz.find(stream);
    return rate == rates_hz.end() ? 0 : static_cast<std::int64_t>(std::ceil(end_s * rate->second - 1e-6));
}

std::optional<Verdicts> parse_verdicts(std::string_view text, std::string const& name, Extent const& extent,
                                       std::optional<double> threshold, config::Diagnostics& diagnostics) {
    return Parser{config::make_source(name, text), extent, threshold, diagnostics}.parse();
}

} // namespace gridspace::score
