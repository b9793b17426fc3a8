// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/program/declaration.hpp"

#include <algorithm>

namespace gridspace::program {
namespace {

/// Of the first "{...}" that is not the process: what stands between the braces; empty when there is none.
std::string_view placeholder(std::string_view pattern) {
    std::size_t open = 0;
    while ((open = pattern.find('{', open)) != std::string_view::npos) {
        std::size_t const close = pattern.find('}', open);
        if (close == std::string_view::npos) {
            return {};
        }
        std::string_view const inside = pattern.substr(open + 1, close - open - 1);
        if (inside != "process") {
            return inside;
        }
        open = close;
    }
    return {};
}

std::string replaced(std::string text, std::string const& what, std::string const& by) {
    for (std::size_t at = text.find(what); at != std::string::npos; at = text.find(what, at + by.size())) {
        text.replace(at, what.size(), by);
    }
    return text;
}

/// "[...]" goes, with what it holds when `leave_out`.
std::string without_brackets(std::string text, bool leave_out) {
    std::size_t const open = text.find('['), close = text.find(']');
    if (open == std::string::npos || close == std::string::npos || close < open) {
        return text;
    }
    std::string const inside = leave_out ? "" : text.substr(open + 1, close - open - 1);
    return text.substr(0, open) + inside + text.substr(close + 1);
}

std::vector<std::string> values_of(std::string_view alternatives, Values const& values) {
    std::vector<std::string> out;
    while (!alternatives.empty()) {
        std::size_t const bar = std::min(alternatives.find('|'), alternatives.size());
        std::vector<std::string> const some = values(alternatives.substr(0, bar));
        out.insert(out.end(), some.begin(), some.end());
        alternatives.remove_prefix(std::min(bar + 1, alternatives.size()));
    }
    return out;
}

} // namespace

std::vector<std::string> expand(std::string_view pattern, Values const& values) {
    std::vector<std::string> const process = values("process");
    std::string const named = replaced(std::string{pattern}, "{process}", process.empty() ? "" : process.front());
    std::string const key{placeholder(named)};
    if (key.empty()) {
        return {named};
    }
    std::vector<std::string> const all = values_of(key, values);
    std::string const bare = without_brackets(named, all.size() == 1);
    std::vector<std::string> out;
    for (std::string const& value : all) {
        out.push_back(replaced(bare, "{" + key + "}", value));
    }
    return out;
}

std::vector<std::string> placeholder_values(std::string_view pattern, Values const& values) {
    std::string_view const key = placeholder(pattern);
    return key.empty() ? std::vector<std::string>{""} : values_of(key, values);
}

std::vector<Signal> expand(std::vector<Signal> const& signals, Values const& values) {
    std::vector<Signal> out;
    for (std::size_t first = 0, end = 0; first < signals.size(); first = end) {
        std::string_view const key = placeholder(signals[first].name);
        std::vector<std::vector<std::string>> names;
        for (end = first; end < signals.size() && placeholder(signals[end].name) == key; ++end) {
            names.push_back(expand(signals[end].name, values));
        }
        for (std::size_t value = 0; value < names.front().size(); ++value) {
            for (std::size_t i = first; i < end; ++i) {
                out.push_back({names[i - first][value], signals[i].unit, signals[i].rate_hz});
            }
        }
    }
    return out;
}

std::vector<Topic> expand(std::vector<Topic> const& topics, Values const& values) {
    std::vector<Topic> out;
    for (Topic const& topic : topics) {
        for (std::string& name : expand(topic.topic, values)) {
            out.push_back(topic);
            out.back().topic = std::move(name);
        }
    }
    return out;
}

void add_once(std::vector<Topic>& topics, Topic topic) {
    if (std::ranges::none_of(topics, [&](Topic const& t) { return t.topic == topic.topic && !t.is_stream; })) {
        topics.push_back(std::move(topic));
    }
}

} // namespace gridspace::program
