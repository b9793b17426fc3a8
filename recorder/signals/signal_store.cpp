// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/signals/signal_store.hpp"

#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/signals/cdr_cursor.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace {

bool SignalReader::take(std::string const& topic, std::span<std::byte const> data) {
    return topic == "signal_catalog" ? take_catalog(data) : topic != "signals" || take_frame(data);
}

bool SignalReader::take_catalog(std::span<std::byte const> data) {
    CdrCursor cursor{data};
    std::string const source = cursor.text(), name = cursor.text();
    cursor.number<double>(); // rate
    auto const count = cursor.number<std::uint32_t>();
    Group group;
    for (std::uint32_t i = 0; i < count && cursor.ok(); ++i) {
        std::string const signal = cursor.text(), unit = cursor.text();
        if (Keep const keep = cursor.ok() ? keep_(source, signal) : Keep::none; keep != Keep::none) {
            SignalSeries& series = signals_[signal];
            series.unit = unit;
            (keep == Keep::all ? group.all : group.spans).push_back({i, &series});
        }
    }
    group.columns = count;
    groups_[{source, name}] = std::move(group);
    return cursor.ok();
}

bool SignalReader::is_within_spans(std::int64_t from_ns, std::int64_t before_ns) const {
    return std::ranges::any_of(spans_,
                               [&](auto const& span) { return from_ns <= span.second && span.first < before_ns; });
}

bool SignalReader::take_frame(std::span<std::byte const> data) {
    CdrCursor cursor{data};
    std::string const source = cursor.text(), name = cursor.text();
    std::uint32_t rows = 0, cells = 0;
    auto const times = cursor.numbers<std::int64_t>(rows);
    auto const values = cursor.numbers<double>(cells);
    auto const group = groups_.find({source, name});
    if (!cursor.ok() || (group != groups_.end() && static_cast<std::size_t>(rows) * group->second.columns != cells)) {
        return false;
    }
    if (rows > 1) {
        longest_frame_ns_ =
            std::max(longest_frame_ns_, element<std::int64_t>(times, rows - 1) - element<std::int64_t>(times, 0));
    }
    for (std::uint32_t r = 0; group != groups_.end() && r < rows; ++r) {
        auto const time = element<std::int64_t>(times, r);
        auto const add = [&](Column const& column) {
            column.series->times_ns.push_back(time);
            column.series->values.push_back(element<double>(values, r * group->second.columns + column.index));
        };
        std::ranges::for_each(group->second.all, add);
        for (Column const& column : group->second.spans) {
            std::vector<std::int64_t>& kept = column.series->times_ns;
            if (!kept.empty() && !is_within_spans(kept.back(), time)) {
                kept.pop_back();
                column.series->values.pop_back();
            }
            add(column);
        }
    }
    return true;
}

Result<SignalStore> read_signals(std::filesystem::path const& file, KeepRule const& keep, Spans const& spans) {
    SignalReader reader{keep, spans};
    std::string damaged;
    auto const outcome = mcap::read_messages(file, [&](mcap::Message const& message) {
        bool const good = reader.take(message.channel.topic, message.data);
        if (!good) {
            damaged =
                fmt::format("a sample of '{}' at {} ns does not fit its type", message.channel.topic, message.time_ns);
        }
        return good;
    });
    if (!outcome) {
        return std::unexpected{outcome.error()};
    }
    if (!damaged.empty()) {
        return fail(ExitCode::usage, damaged);
    }
    return std::move(reader.signals());
}

Result<SignalStore> read_signals(std::filesystem::path const& file,
                                 std::function<bool(std::string const&)> const& wanted) {
    return read_signals(
        file, [&](std::string const&, std::string const& signal) { return wanted(signal) ? Keep::all : Keep::none; });
}

} // namespace gridspace
