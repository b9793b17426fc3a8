// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>

namespace gridspace::relay {

/// Lengths in samples.
struct ForeignPermissionParams {
    int wait{10};             ///< a pickup waits so long for the verdict on it
    int hold{160};            ///< a flag counts that is not older than so long before the pickup
    int delay{96};            ///< a flagged pickup trips when it has lasted so long
    bool trips_at_last{true}; ///< false: a flagged pickup never trips
    bool trips_unheard{true}; ///< a pickup without a verdict trips after `wait`; false: it counts as flagged
};

/// Whether a relay may trip, by what somebody else's detector says about the samples of both ends. The detector speaks
/// later than the samples come, so a pickup first waits for the verdict on the sample at which it began. Pure.
class ForeignPermission {
  public:
    enum class Reason : std::uint8_t {
        none,      ///< no pickup, or no verdict has been needed
        waiting,   ///< for the verdict on the pickup
        genuine,   ///< judged, and nothing flagged
        flagged,   ///< a sample of one of the ends was flagged
        timed_out, ///< flagged, and the pickup has lasted long enough
        unheard    ///< the detector has said nothing about it
    };

    explicit ForeignPermission(ForeignPermissionParams const& params) : params_{params} {}

    /// A verdict on sample `index` of an end (0: from, 1: to). Indices may come in any order, and may be missing.
    void verdict(std::size_t end, std::int64_t index, bool flagged);
    /// At each pair of samples: `picked_up`: what the element said at the sample before.
    bool step(std::int64_t index, bool picked_up);

    [[nodiscard]] bool granted() const { return granted_; }
    [[nodiscard]] Reason reason() const { return reason_; }

  private:
    static constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::min() / 4;
    [[nodiscard]] Reason judge(std::int64_t index) const;

    ForeignPermissionParams params_;
    std::array<std::int64_t, 2> judged_{kNever, kNever}, flagged_{kNever, kNever}; ///< newest index
    std::int64_t since_{kNever};                                                   ///< of the pickup
    bool picked_up_{false}, granted_{true};
    Reason reason_{Reason::none};
};

[[nodiscard]] char const* to_string(ForeignPermission::Reason reason);

} // namespace gridspace::relay
