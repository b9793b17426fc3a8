// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <filesystem>
#include <map>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

struct Scenario;

/// How something is protected: not at all, against being altered or made by others, or also against being read.
enum class Protection { none, sign, encrypt };
[[nodiscard]] std::string_view to_string(Protection protection);

/// `security:` of a scenario: DDS Security for the run (docs/design/security.md).
struct SecuritySettings {
    /// Of a topic. Submessages are samples with what belongs to them (numbers, acknowledgements), under a key that the
    /// topic's writer and readers have; data is a sample alone, once more.
    struct Topic {
        Protection submessages{Protection::encrypt}, data{Protection::none};
    };
    std::filesystem::path keys;            ///< made by `gridspace keys init`; empty: keys for this run alone
    Protection messages{Protection::none}; ///< each RTPS message as a whole, under a key that all participants have
    Topic all;                             ///< where `topics` says nothing
    std::map<std::string, Topic> topics;
    std::vector<config::Ref> named; ///< the keys of `topics`, for messages
};

void describe(config::Fields& f, SecuritySettings& security);

/// `security: on` is all defaults, `security: off` is as if nothing were written.
void expand_security_word(config::Node& root, config::Diagnostics& diagnostics);

/// What a secured run cannot have, and topics that do not exist.
void check_security(Scenario const& scenario, config::Diagnostics& diagnostics);

} // namespace gridspace::launcher
