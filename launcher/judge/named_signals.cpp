// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/named_signals.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cctype>

namespace gridspace::launcher {
namespace {

constexpr std::size_t kMostPatterns = 1000; // beyond, each signal counts: nobody waits for the product of both

bool is_letter(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}

/// As the words of expressions.
bool is_in_word(char c) {
    return is_letter(c) || std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.' || c == '*' || c == '?';
}

} // namespace

NamedSignals::NamedSignals(config::Node const& scenario, std::string_view more) {
    look_at(more);
    for (config::Node::Entry const& entry : scenario.entries) {
        if (entry.key != "record") {
            look_at(entry.key);
            look_at(entry.value);
        }
    }
    for (std::string const& word : words_) {
        if (word.find_first_of("*?") != std::string::npos) {
            patterns_.push_back(word);
        }
    }
}

void NamedSignals::look_at(config::Node const& node) {
    look_at(node.text);
    for (config::Node const& item : node.items) {
        look_at(item);
    }
    for (config::Node::Entry const& entry : node.entries) {
        look_at(entry.key);
        look_at(entry.value);
    }
}

void NamedSignals::look_at(std::string_view text) {
    words_.emplace(text); // a pattern may begin with '*', and a signal's name have signs that expressions have not
    for (std::size_t at = 0; at < text.size();) {
        auto const begin = std::find_if(text.begin() + static_cast<std::ptrdiff_t>(at), text.end(), is_letter);
        auto const end = std::find_if_not(begin, text.end(), is_in_word);
        if (begin != end) {
            words_.emplace(begin, end);
        }
        at = static_cast<std::size_t>(end - text.begin());
    }
}

bool NamedSignals::contains(std::string const& signal) const {
    return words_.contains(signal) || patterns_.size() > kMostPatterns ||
           std::ranges::any_of(patterns_, [&](std::string const& pattern) { return matches_glob(pattern, signal); });
}

} // namespace gridspace::launcher
