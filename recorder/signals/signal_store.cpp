// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/signals/signal_store.hpp"

#include "recorder/mcap/mcap_reader.hpp"
#include "recorder/signals/cdr_cursor.hpp"

#include <cstring>
#include <fmt/format.h>

namespace gridspace {
namespace {

/// The columns of one group: where each wanted one goes.
struct Group {
    std::size_t columns{0};
    std::vector<std::pair<std::size_t, SignalSeries*>> wanted;
};

} // namespace

Result<SignalStore> read_signals(std::filesystem::path const& file,
                                 std::function<bool(std::string const&)> const& wanted) {
    SignalStore store;
    std::map<std::pair<std::string, std::string>, Group> groups; // (source, group)
    std::string damaged;
    auto const on_catalog = [&](CdrCursor cursor) {
        std::string const source = cursor.text(), name = cursor.text();
        cursor.number<double>(); // rate
        auto const count = cursor.number<std::uint32_t>();
        Group group;
        for (std::uint32_t i = 0; i < count && cursor.ok(); ++i) {
            std::string const signal = cursor.text(), unit = cursor.text();
            if (cursor.ok() && wanted(signal)) {
                SignalSeries& series = store[signal];
                series.unit = unit;
                group.wanted.emplace_back(i, &series);
            }
        }
        group.columns = count;
        groups[{source, name}] = std::move(group);
        return cursor.ok();
    };
    auto const on_frame = [&](CdrCursor cursor) {
        std::string const source = cursor.text(), name = cursor.text();
        std::uint32_t rows = 0, cells = 0;
        auto const times = cursor.numbers<std::int64_t>(rows);
        auto const values = cursor.numbers<double>(cells);
        auto const group = groups.find({source, name});
        if (!cursor.ok() ||
            (group != groups.end() && static_cast<std::size_t>(rows) * group->second.columns != cells)) {
            return false;
        }
        if (group != groups.end()) {
            for (std::uint32_t r = 0; r < rows; ++r) {
                for (auto const& [column, series] : group->second.wanted) {
                    series->times_ns.push_back(element<std::int64_t>(times, r));
                    series->values.push_back(element<double>(values, r * group->second.columns + column));
                }
            }
        }
        return true;
    };
    auto const outcome = mcap::read_messages(file, [&](mcap::Message const& message) {
        bool good = true;
        if (message.channel.topic == "signal_catalog") {
            good = on_catalog(CdrCursor{message.data});
        } else if (message.channel.topic == "signals") {
            good = on_frame(CdrCursor{message.data});
        }
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
    return store;
}

} // namespace gridspace
