// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <filesystem>
#include <string>
#include <vector>

namespace gridspace::timebox {

/// How the door of a box is started: it takes these from its command line.
struct DoorTopic {
    bool to_program{false}; ///< the program reads it
    std::string topic, type;
    bool keyed{false};
};
[[nodiscard]] std::vector<std::string> door_command(std::filesystem::path const& qos, std::int64_t domain,
                                                    std::vector<DoorTopic> const& topics);
/// Of a command line.
[[nodiscard]] bool is_door(int argc, char** argv);

/// A participant of DDS next to a foreign program in a box, in simulated time as it does, and carries
/// samples between its topics and the channel. Ends when the channel does. The exit code.
[[nodiscard]] int run_door(int argc, char** argv);

} // namespace gridspace::timebox
