// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/command_line/command.hpp"

#include <cstdint>
#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::play {

/// What `gridspace play` is asked for; gridspace-player takes the same options.
struct PlayOptions {
    std::filesystem::path run{"latest"}; ///< run folder, or its data.mcap
    double rate{1};                      ///< recorded seconds per second; 0: as fast as readers take it
    std::string start, until;            ///< simulated time; empty: from the beginning, to the end
    std::vector<std::string> topics;     ///< patterns; empty: all
    std::int64_t loops{1};               ///< 0: for ever
    std::int64_t domain{0};
    std::int64_t data_domain{-1}; ///< of the topics that are not the framework's own; -1: `domain`
    std::vector<std::string> addresses;
    std::filesystem::path qos; ///< player.xml
    bool wait{false};          ///< until every topic has a reader
    bool json{false};
    bool no_samples{false};
    std::string frames, only, allow_attacks_on;
};

/// Adds the options to a command line that shall read them.
void add_options(command_line::Command app, PlayOptions& options);

/// The options as a command line.
[[nodiscard]] std::vector<std::string> to_words(PlayOptions const& options);

} // namespace gridspace::play
