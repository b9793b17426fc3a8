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

/// Takes signals out of the messages of a recording, in their order.
class SignalReader {
  public:
    explicit SignalReader(std::function<bool(std::string const&)> wanted) : wanted_{std::move(wanted)} {}
    SignalReader(SignalReader const&) = delete;
    SignalReader& operator=(SignalReader const&) = delete;

    /// False: the message does not fit its type. Messages of other topics are passed over.
    bool take(std::string const& topic, std::span<std::byte const> data);
    [[nodiscard]] SignalStore& signals() { return signals_; }
    [[nodiscard]] SignalStore const& signals() const { return signals_; }
    /// From the first to the last row of a frame, at most: so long rows have waited for being sent.
    [[nodiscard]] std::int64_t longest_frame_ns() const { return longest_frame_ns_; }

  private:
    /// The columns of one group: where each wanted one goes.
    struct Group {
        std::size_t columns{0};
        std::vector<std::pair<std::size_t, SignalSeries*>> wanted;
    };
    bool take_catalog(std::span<std::byte const> data);
    bool take_frame(std::span<std::byte const> data);

    std::function<bool(std::string const&)> wanted_;
    SignalStore signals_;
    std::int64_t longest_frame_ns_{0};
    std::map<std::pair<std::string, std::string>, Group> groups_; ///< by (source, group)
};

/// Reads the signals of a recording whose name `wanted` accepts.
[[nodiscard]] Result<SignalStore> read_signals(std::filesystem::path const& mcap,
                                               std::function<bool(std::string const&)> const& wanted);

} // namespace gridspace
