// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "recorder/mcap/mcap_format.hpp"

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::mcap {

/// What a file says to hold of one channel.
struct ChannelContent {
    Channel channel;
    std::string type;
    std::uint64_t messages{0};
    std::uint64_t octets{0};               ///< of the messages' data
    std::uint64_t first_ns{0}, last_ns{0}; ///< earliest and latest, when there are messages
};

struct Content {
    std::vector<ChannelContent> channels; ///< those with messages
    std::uint64_t messages{0};
    bool indexed{false};  ///< taken from the index: no data was read
    bool complete{false}; ///< as in ReadOutcome
    std::string note;
};

/// What is in a file, by its summary and its message indexes; where it has none (it was cut, or is another program's)
/// or they do not fit together, by reading all of it.
[[nodiscard]] Result<Content> content_of(std::filesystem::path const& file);

} // namespace gridspace::mcap
