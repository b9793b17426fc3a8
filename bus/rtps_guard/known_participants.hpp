// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "bus/rtps_guard/octets.hpp"

#include <cstdint>
#include <map>

namespace gridspace::rtps_guard {

/// The participants of other processes that one of ours takes at a time. Who came first stays while it is heard, so a
/// flood of invented ones cannot displace the members of a run; who has been silent makes room. Pure: the caller has
/// the clock.
class KnownParticipants {
  public:
    static constexpr std::size_t kMax = 1024;
    static constexpr std::int64_t kForgottenAfterNs = 60'000'000'000;

    explicit KnownParticipants(std::size_t most = kMax) : most_{most} {}

    /// One announces itself; false: there is no room for it.
    [[nodiscard]] bool announce(GuidPrefix const& prefix, std::int64_t now_ns);
    /// One is heard; false: it has not announced itself.
    [[nodiscard]] bool hear(GuidPrefix const& prefix, std::int64_t now_ns);
    [[nodiscard]] std::size_t size() const { return heard_ns_.size(); }

  private:
    std::size_t most_;
    std::map<GuidPrefix, std::int64_t> heard_ns_;
    std::int64_t looked_ns_{INT64_MIN}; ///< when the silent ones were looked for
};

} // namespace gridspace::rtps_guard
