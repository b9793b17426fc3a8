// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "recorder/mcap/mcap_format.hpp"

#include <cstddef>
#include <filesystem>
#include <functional>
#include <memory>
#include <optional>
#include <span>

namespace gridspace::mcap {

struct Message {
    Channel const& channel;
    Schema const& schema;
    std::uint32_t sequence;
    std::uint64_t time_ns;
    std::span<std::byte const> data;
};

struct ReadOutcome {
    std::uint64_t messages{0};
    bool complete{false}; ///< the file ends as it should; otherwise it was cut, and the prefix was read
    std::string note;     ///< what is wrong with the rest
    std::optional<std::uint64_t> damaged_from_ns{}; ///< when the earliest chunk begins that was left out
};

/// Calls `handler` for every message in the order of the file. Works on files that were cut off. Records of unknown
/// kinds are skipped. Memory is bounded by the largest chunk, and time by the size of the file: what is beyond the
/// limits of mcap_format.hpp is not believed, and the note says so. `handler` returns false to stop.
[[nodiscard]] Result<ReadOutcome> read_messages(std::filesystem::path const& file,
                                                std::function<bool(Message const&)> const& handler);

/// A file that somebody still writes. Memory and time as with read_messages, of what is new.
class GrowingFile {
  public:
    /// It need not be there yet.
    explicit GrowingFile(std::filesystem::path file);
    ~GrowingFile();

    /// Calls `handler` for the messages of what was completed since the last call; a record that is not whole waits for
    /// the next. False when nothing was. After the end of the data, something damaged, or when `handler` returned false
    /// nothing comes any more.
    bool read_on(std::function<bool(Message const&)> const& handler);

  private:
    struct State;
    std::unique_ptr<State> state_;
};

} // namespace gridspace::mcap
