// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"

#include <set>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// The signals that a scenario names anywhere but in `record:`, whose patterns say what is recorded and not what is
/// looked at. Every word that could be a signal or a pattern counts, in expressions and in other text: one too many
/// costs memory, one too few a result.
class NamedSignals {
  public:
    /// `more`: other text that counts, too.
    explicit NamedSignals(config::Node const& scenario, std::string_view more = {});
    [[nodiscard]] bool contains(std::string const& signal) const;

  private:
    void look_at(config::Node const& node);
    void look_at(std::string_view text);
    std::set<std::string, std::less<>> words_;
    std::vector<std::string> patterns_;
};

} // namespace gridspace::launcher
