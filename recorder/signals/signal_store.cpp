// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "recorder/signals/signal_store.hpp"

#include "recorder/mcap/mcap_reader.hpp"

#include <cstring>
#include <fmt/format.h>

namespace gridspace {
namespace {

/// Reads the members of SignalCatalog and SignalFrame (idl/signals.idl) in order; little-endian CDR as all our writers send.
class CdrCursor {
  public:
    explicit CdrCursor(std::span<std::byte const> cdr) : data_{cdr.subspan(std::min<std::size_t>(4, cdr.size()))} {
        ok_ = cdr.size() >= 4 && cdr[1] == std::byte{1};
    }
    template <class T> T number() {
        at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        T value{};
        if (!ok_ || at_ + sizeof(T) > data_.size()) {
            ok_ = false;
            return value;
        }
        std::memcpy(&value, data_.data() + at_, sizeof(T));
        at_ += sizeof(T);
        return value;
    }
    std::string text() {
        auto const size = number<std::uint32_t>();
        if (!ok_ || size == 0 || at_ + size > data_.size()) {
            ok_ = false;
            return {};
        }
        std::string out{reinterpret_cast<char const*>(data_.data() + at_), size - 1};
        at_ += size;
        return out;
    }
    template <class T> std::span<std::byte const> numbers(std::uint32_t& count) {
        count = number<std::uint32_t>();
        if (count == 0) {
            return {};
        }
        at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        if (!ok_ || at_ + static_cast<std::size_t>(count) * sizeof(T) > data_.size()) {
            ok_ = false;
            count = 0;
            return {};
        }
        auto const out = data_.subspan(at_, count * sizeof(T));
        at_ += count * sizeof(T);
        return out;
    }
    [[nodiscard]] bool ok() const { return ok_; }

  private:
    std::span<std::byte const> data_;
    std::size_t at_{0};
    bool ok_;
};

template <class T> T element(std::span<std::byte const> raw, std::size_t index) {
    T value;
    std::memcpy(&value, raw.data() + index * sizeof(T), sizeof(T));
    return value;
}

/// The columns of one group: where each wanted one goes.
struct Group {
    std::size_t columns{0};
    std::vector<std::pair<std::size_t, SignalSeries*>> wanted;
};

} // namespace

Result<SignalStore> read_signals(std::filesystem::path const& file, std::function<bool(std::string const&)> const& wanted) {
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
        if (!cursor.ok() || (group != groups.end() && static_cast<std::size_t>(rows) * group->second.columns != cells)) {
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
            damaged = fmt::format("a sample of '{}' at {} ns does not fit its type", message.channel.topic, message.time_ns);
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
