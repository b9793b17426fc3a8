// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/recording_loss.hpp"

#include "common/text.hpp"
#include "recorder/signals/cdr_cursor.hpp"

#include <algorithm>
#include <cstdint>
#include <fmt/format.h>
#include <regex>

namespace gridspace::launcher {
namespace {

constexpr char const *kValues = "signals", *kCatalog = "signal_catalog"; // topics

} // namespace

void RecordingLoss::publishes(std::string const& process, std::string const& signal) {
    signals_[process].insert(signal);
}

void RecordingLoss::publishes_catalog(std::string const& process, std::span<std::byte const> sample) {
    CdrCursor cursor{sample};
    cursor.text();           // source
    cursor.text();           // group
    cursor.number<double>(); // rate
    auto const count = cursor.number<std::uint32_t>();
    for (std::uint32_t i = 0; i < count && cursor.ok(); ++i) {
        std::string const signal = cursor.text();
        cursor.text(); // unit
        if (cursor.ok()) {
            publishes(process, signal);
        }
    }
}

void RecordingLoss::dropped(std::string const& event_text) {
    // "3 of 50 samples of 'signals' from sim", any number of them: lost on the way to the recorder.
    static std::regex const on_the_way{R"(\d+ of \d+ samples of '([^']+)' from ([^,\s]+))"};
    // "2 samples of 'signals' are not in the recording: ... (7 since the start)": by the recorder itself, of anybody.
    static std::regex const by_itself{R"(samples of '([^']+)' are not in the recording.*\((\d+) since the start\))"};
    for (std::sregex_iterator it{event_text.begin(), event_text.end(), on_the_way}, end; it != end; ++it) {
        lost_[{it->str(1), it->str(2)}] = it->str(0);
    }
    if (std::smatch m; std::regex_search(event_text, m, by_itself)) {
        lost_[{m.str(1), std::nullopt}] = fmt::format("{} samples of '{}'", m.str(2), m.str(1));
    }
}

bool RecordingLoss::concerns(std::string const& topic, std::optional<std::string> const& process,
                             std::vector<std::string> const& patterns) const {
    if (topic != kValues && topic != kCatalog) {
        return false;
    }
    auto const publishes_one = [&](auto const& own, std::string const& pattern) {
        return std::any_of(own.second.begin(), own.second.end(),
                           [&](std::string const& name) { return matches_glob(pattern, name); });
    };
    return std::any_of(patterns.begin(), patterns.end(), [&](std::string const& pattern) {
        bool const known =
            std::any_of(signals_.begin(), signals_.end(), [&](auto const& own) { return publishes_one(own, pattern); });
        if (!known && topic == kCatalog) { // it may have been in there
            return true;
        }
        auto const own = process ? signals_.find(*process) : signals_.end();
        return process ? own != signals_.end() && publishes_one(*own, pattern) : true;
    });
}

std::string RecordingLoss::of(std::vector<std::string> const& patterns) const {
    std::vector<std::string> out;
    for (auto const& [place, text] : lost_) {
        if (concerns(place.first, place.second, patterns)) {
            out.push_back(text);
        }
    }
    return join(out, ", ");
}

void name_loss(Expectation const& expectation, RecordingLoss const& loss, ExpectationResult& result) {
    if (result.status != ExpectationResult::Status::failed || !expectation.expression) {
        return;
    }
    std::vector<std::string> patterns = expectation.expression->signals();
    if (!expectation.stream.empty()) {
        patterns.push_back(expectation.stream + ".*");
    }
    std::string const lost = loss.of(patterns);
    if (lost.empty()) {
        return;
    }
    std::string const rest = !result.detail.empty() ? result.detail
                             : result.value         ? fmt::format("{:.6g} {}", *result.value, result.unit)
                                                    : std::string{};
    result.detail = fmt::format("cannot be judged: the recording has lost {}", lost);
    result.detail += rest.empty() ? "" : fmt::format(" (by what is left: {})", trim(rest));
    result.value.reset();
}

namespace {

/// Whatever comes later does not change the answer.
bool is_decided(Expectation const& e, ExpectationResult const& result) {
    using Verb = Expectation::Verb;
    bool const passed = result.status == ExpectationResult::Status::passed;
    Expectation::Band const& band = result.band;
    switch (e.verb) {
    case Verb::time_of:
        return result.value.has_value();
    case Verb::intervals_ms:
        return passed;
    case Verb::max_of: // both only grow
    case Verb::count_of:
        return result.value && (passed ? !band.high : band.high && *result.value > *band.high);
    case Verb::min_of:
        return result.value && (passed ? !band.low : band.low && *result.value < *band.low);
    case Verb::always:
    case Verb::never:
    case Verb::eventually:
        return result.decided_at_s.has_value();
    default:
        return false;
    }
}

} // namespace

void mind_the_end(Expectation const& expectation, Moments const& moments, double cut_at_s, double duration_s,
                  ExpectationResult& result) {
    using Status = ExpectationResult::Status;
    constexpr double kRounding = 0.001; // s: the clock of the last tick is at the end
    std::optional<double> until = duration_s, from = 0;
    if (expectation.until) {
        until = instant_of(*expectation.until, moments);
    }
    if (expectation.from) {
        from = instant_of(*expectation.from, moments);
    }
    if (until && from && expectation.within_s) {
        until = std::min(*until, *from + *expectation.within_s);
    }
    if (result.status == Status::not_applicable || is_decided(expectation, result) || !from || !until ||
        *until <= cut_at_s + kRounding || result.detail.starts_with("cannot be judged")) {
        return;
    }
    if (result.status == Status::passed) {
        result.status = Status::failed;
    }
    std::string const rest =
        result.value && result.unit != "" ? fmt::format("{:.6g} {}", *result.value, result.unit) : result.detail;
    result.detail =
        fmt::format("cannot be judged: the recording is whole until {:.6g} s, and {:.6g} s were simulated{}", cut_at_s,
                    duration_s, rest.empty() ? "" : fmt::format(" (by what is left: {})", trim(rest)));
    result.value.reset();
}

} // namespace gridspace::launcher
