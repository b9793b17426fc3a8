// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>

/// Verbs that look at a running scenario through its monitor.
namespace gridspace::cli {

struct GraphArguments {
    std::filesystem::path run{"latest"};
    std::string format{"text"}; ///< text, dot, json or svg
    bool framework{false};
};
int graph(GraphArguments const& arguments);

struct ControlArguments {
    std::filesystem::path run{"latest"};
    std::string action; ///< pause, continue, step or stop
    std::int64_t ticks{1};
};
int control(ControlArguments const& arguments);

struct TopicArguments {
    std::filesystem::path run{"latest"};
    std::string topic;
    std::filesystem::path idl; ///< of types that nobody publishes
    bool json{false}, framework{false};
};
int topic_list(TopicArguments const& arguments);
int topic_info(TopicArguments const& arguments);
int topic_echo(TopicArguments const& arguments);
int topic_hz(TopicArguments const& arguments);

} // namespace gridspace::cli
