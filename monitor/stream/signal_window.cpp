// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/stream/signal_window.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridspace::stream {
namespace {

constexpr std::uint64_t kRatio = 16; ///< between two levels
constexpr std::size_t kLevels = 4;

} // namespace

SignalWindow::SignalWindow(std::vector<Column> columns, std::size_t rows, std::shared_ptr<std::size_t> values_left)
    : columns_{std::move(columns)}, values_left_{std::move(values_left)} {
    std::uint64_t span = 1;
    for (std::size_t i = 0; i < kLevels; ++i, span *= kRatio) {
        Level level;
        level.span = span;
        level.capacity = std::max<std::size_t>(rows, 2);
        levels_.push_back(std::move(level));
    }
}

std::optional<std::size_t> SignalWindow::find(std::string_view name) const {
    auto const it = std::find_if(columns_.begin(), columns_.end(), [&](Column const& c) { return c.name == name; });
    return it == columns_.end() ? std::nullopt : std::optional{static_cast<std::size_t>(it - columns_.begin())};
}

void SignalWindow::append(std::int64_t time_ns, std::span<double const> values) {
    if (values.size() != columns_.size() || time_ns <= newest_ns_) {
        return;
    }
    newest_ns_ = time_ns;
    newest_.assign(values.begin(), values.end());
    ++count_;
    for (Level& level : levels_) {
        add(level, time_ns, values);
    }
}

void SignalWindow::add(Level& level, std::int64_t time_ns, std::span<double const> values) {
    std::size_t const width = columns_.size();
    bool const begin = level.begun == 0 || level.filled == level.span;
    if (begin) {
        ++level.begun;
        level.filled = 0;
    }
    std::size_t slot = static_cast<std::size_t>((level.begun - 1) % level.capacity);
    if (begin && slot >= level.buckets.size() && !take_entry(level)) {
        level.capacity = slot; // no more memory: it is a ring from now on
        slot = 0;
    }
    if (begin && slot >= level.buckets.size()) { // grows until it is a ring
        level.buckets.resize(slot + 1);
        level.low.resize((slot + 1) * width);
        if (level.span > 1) {
            level.high.resize((slot + 1) * width);
        }
    }
    Bucket& bucket = level.buckets[slot];
    bucket.last_ns = time_ns;
    if (begin) {
        bucket.first_ns = time_ns;
    }
    for (std::size_t c = 0; c < width; ++c) {
        auto const value = static_cast<float>(values[c]);
        float& low = level.low[slot * width + c];
        low = begin ? value : std::fmin(low, value);
        if (level.span > 1) {
            float& high = level.high[slot * width + c];
            high = begin ? value : std::fmax(high, value);
        }
    }
    ++level.filled;
}

/// Memory for one entry more, of what it shares with others; a few there are always.
bool SignalWindow::take_entry(Level const& level) {
    constexpr std::size_t kAlways = 64;
    if (!values_left_) {
        return true;
    }
    bool const is_there = *values_left_ >= values_of(level) || level.buckets.size() < kAlways;
    std::size_t const charged = is_there ? std::min(values_of(level), *values_left_) : 0;
    *values_left_ -= charged;
    taken_ += charged;
    return is_there;
}

std::size_t SignalWindow::kept(Level const& level) const {
    return static_cast<std::size_t>(std::min<std::uint64_t>(level.begun, level.capacity));
}

SignalWindow::Bucket const& SignalWindow::bucket(Level const& level, std::size_t i) const {
    return level.buckets[static_cast<std::size_t>((level.begun - kept(level) + i) % level.capacity)];
}

std::int64_t SignalWindow::oldest_ns() const {
    return empty() ? 0 : bucket(levels_.back(), 0).first_ns;
}

double SignalWindow::value_at(std::size_t column, std::int64_t time_ns) const {
    for (Level const& level : levels_) {
        std::size_t const count = kept(level);
        if (count == 0 || column >= columns_.size() || bucket(level, 0).first_ns > time_ns) {
            continue; // a coarser one reaches further back
        }
        std::size_t low = 0, high = count; // the last bucket that begins at or before the instant
        while (high - low > 1) {
            std::size_t const middle = (low + high) / 2;
            (bucket(level, middle).first_ns <= time_ns ? low : high) = middle;
        }
        return level
            .low[static_cast<std::size_t>((level.begun - count + low) % level.capacity) * columns_.size() + column];
    }
    return std::numeric_limits<double>::quiet_NaN();
}

SignalWindow::Level const& SignalWindow::level_from(std::int64_t from_ns) const {
    for (Level const& candidate : levels_) {
        if (bucket(candidate, 0).first_ns <= from_ns || candidate.begun <= candidate.capacity) {
            return candidate;
        }
    }
    return levels_.back();
}

std::pair<std::size_t, std::size_t> SignalWindow::buckets_between(Level const& level, std::int64_t from_ns,
                                                                  std::int64_t to_ns, Ends ends) const {
    std::size_t const count = kept(level);
    auto const search = [&](auto before) { // first entry for which `before` does not hold
        std::size_t low = 0, high = count;
        while (low < high) {
            std::size_t const middle = (low + high) / 2;
            (before(bucket(level, middle)) ? low : high) = before(bucket(level, middle)) ? middle + 1 : middle;
        }
        return low;
    };
    std::size_t const first = search([&](Bucket const& b) { return b.last_ns < from_ns; });
    std::size_t const last = search([&](Bucket const& b) { return b.first_ns <= to_ns; });
    if (ends == Ends::reach_out) {
        return {first > 0 ? first - 1 : 0, std::min(last + 1, count)};
    }
    return {first, last};
}

Plot SignalWindow::plot(std::size_t column, std::int64_t from_ns, std::int64_t to_ns, std::size_t pixels,
                        Ends ends) const {
    Plot out;
    if (empty() || column >= columns_.size() || to_ns < from_ns || pixels == 0) {
        return out;
    }
    Level const* const level = &level_from(from_ns);
    std::size_t const count = kept(*level), width = columns_.size();
    auto const [first, last] = buckets_between(*level, from_ns, to_ns, ends);
    if (first >= last) {
        return out;
    }
    auto const low_of = [&](std::size_t i) {
        return level->low[static_cast<std::size_t>((level->begun - count + i) % level->capacity) * width + column];
    };
    auto const high_of = [&](std::size_t i) {
        return level->span == 1
                   ? low_of(i)
                   : level->high[static_cast<std::size_t>((level->begun - count + i) % level->capacity) * width +
                                 column];
    };
    auto const put = [&](std::int64_t ns, double value) {
        if (ends == Ends::inside) {
            ns = std::clamp(ns, from_ns, to_ns); // a bucket may begin before or end after
        }
        out.times_s.push_back(static_cast<double>(ns) * 1e-9);
        out.values.push_back(value);
    };
    std::size_t const entries = last - first;
    if (level->span == 1 && entries <= 2 * pixels) {
        for (std::size_t i = first; i < last; ++i) {
            put(bucket(*level, i).first_ns, low_of(i));
        }
        return out;
    }
    for (std::size_t p = 0; p < pixels; ++p) {
        std::size_t const begin = first + entries * p / pixels, end = first + entries * (p + 1) / pixels;
        if (begin == end) {
            continue;
        }
        std::size_t lowest = begin, highest = begin;
        for (std::size_t i = begin; i < end; ++i) {
            // Nothing is below or above NaN: the first number takes its place.
            lowest = low_of(i) < low_of(lowest) || std::isnan(low_of(lowest)) ? i : lowest;
            highest = high_of(i) > high_of(highest) || std::isnan(high_of(highest)) ? i : highest;
        }
        // Each at its own time, as far as that is known: within one bucket only that both were there.
        bool const low_first = lowest <= highest;
        std::size_t const earlier = std::min(lowest, highest), later = std::max(lowest, highest);
        std::int64_t const a = bucket(*level, earlier).first_ns;
        std::int64_t const b = earlier == later ? bucket(*level, later).last_ns : bucket(*level, later).first_ns;
        put(a, low_first ? low_of(lowest) : high_of(highest));
        if (b > a) {
            put(b, low_first ? high_of(highest) : low_of(lowest));
        }
    }
    return out;
}

} // namespace gridspace::stream
