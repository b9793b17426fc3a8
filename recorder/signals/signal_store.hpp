// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace gridspace {

/// A recorded signal: values that hold from their time on. Times are nanoseconds of simulated time, increasing.
struct SignalSeries {
    std::string unit;
    std::vector<std::int64_t> times_ns;
    std::vector<double> values;
};

using SignalStore = std::map<std::string, SignalSeries>;

/// Rates, ages and delays of the wall clock: in lockstep there are none.
[[nodiscard]] bool is_wall_clock_signal(std::string_view name);

/// Adds what follows from both ends of a stream: stream.<name>.wire_delay_ms, from the sender's publish_age_ms and the
/// receiver's arrival_age_ms of the same sample, or from sent_after_ms and heard_after_ms of the same GOOSE message.
void derive_wire_delays(SignalStore& signals);

/// Which rows of a signal are kept.
enum class Keep {
    none,
    spans, ///< what holds in the spans that are asked for, and the last
    all,
};
/// From the first to the last, in nanoseconds of simulated time.
using Spans = std::vector<std::pair<std::int64_t, std::int64_t>>;
/// What is kept of a signal of a source (the process that publishes it).
using KeepRule = std::function<Keep(std::string const& source, std::string const& signal)>;

/// Takes signals out of the messages of a recording, in their order.
class SignalReader {
  public:
    explicit SignalReader(KeepRule keep, Spans spans = {}) : keep_{std::move(keep)}, spans_{std::move(spans)} {}
    SignalReader(SignalReader const&) = delete;
    SignalReader& operator=(SignalReader const&) = delete;

    /// False: the message does not fit its type. Messages of other topics are passed over.
    bool take(std::string const& topic, std::span<std::byte const> data);
    [[nodiscard]] SignalStore& signals() { return signals_; }
    [[nodiscard]] SignalStore const& signals() const { return signals_; }
    /// From the first to the last row of a frame, at most: so long rows have waited for being sent.
    [[nodiscard]] std::int64_t longest_frame_ns() const { return longest_frame_ns_; }

  private:
    /// Where a column of a group goes.
    struct Column {
        std::size_t index{0};
        SignalSeries* series{nullptr};
    };
    struct Group {
        std::size_t columns{0};
        std::vector<Column> all, spans; ///< by what is kept of them
    };
    bool take_catalog(std::span<std::byte const> data);
    bool take_frame(std::span<std::byte const> data);
    /// Whether a value that holds from one time until before the other is asked for.
    [[nodiscard]] bool is_within_spans(std::int64_t from_ns, std::int64_t before_ns) const;

    KeepRule keep_;
    Spans spans_;
    SignalStore signals_;
    std::int64_t longest_frame_ns_{0};
    std::map<std::pair<std::string, std::string>, Group> groups_; ///< by (source, group)
};

/// Reads the signals of a recording. Memory: 16 octets for each row that is kept.
[[nodiscard]] Result<SignalStore> read_signals(std::filesystem::path const& mcap, KeepRule const& keep,
                                               Spans const& spans = {});
/// Those whose name `wanted` accepts, whole.
[[nodiscard]] Result<SignalStore> read_signals(std::filesystem::path const& mcap,
                                               std::function<bool(std::string const&)> const& wanted);

} // namespace gridspace
