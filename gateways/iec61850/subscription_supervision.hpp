// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/goose_subscriber.hpp"
#include "gateways/iec61850/sv_layout.hpp"
#include "gateways/iec61850/sv_subscriber.hpp"

namespace gridspace::iec61850 {

/// Why the last messages of a subscription were refused.
enum class SubscriptionProblem : std::uint8_t {
    none,
    identity,      ///< its name from another address or APPID, with another datSet or goID
    conf_rev,      ///< another confRev
    data_set,      ///< number, types or size of the members
    simulation,    ///< simulated and not asked for, or real while simulated ones come
    contradiction, ///< other values or older states than the counters allow, a counter that jumped
    commissioning, ///< its publisher says ndsCom, or timeAllowedToLive 0
};

/// What the logical nodes LGOS and LSVS (IEC 61850-7-4) say of a subscription.
struct SupervisionState {
    bool alive{false};               ///< St
    bool simulated{false};           ///< SimSt: what is taken is simulated
    bool needs_commissioning{false}; ///< NdsCom: the publisher's configuration is not the one that is subscribed to
    SubscriptionProblem problem{SubscriptionProblem::none};
    std::uint32_t conf_rev{0}; ///< as received last (RxConfRevNum)
    std::uint32_t counter{0};  ///< GOOSE: stNum (LastStNum); sampled values: smpSynch
    std::uint32_t quality{0};  ///< all quality bits of the members together
    bool operator==(SupervisionState const&) const = default;
};

/// Supervision of one subscription to GOOSE. Times are nanoseconds on any one axis.
class GooseSupervision {
  public:
    explicit GooseSupervision(GooseSubscription subscription) : subscriber_{std::move(subscription)} {}

    /// A message of any control block; true: state or values have changed.
    bool receive(GooseFrame const& message, std::int64_t now_ns, std::int64_t utc_ns) noexcept;
    [[nodiscard]] std::optional<std::int64_t> deadline() const noexcept { return subscriber_.deadline(); }
    bool expire(std::int64_t now_ns) noexcept;

    [[nodiscard]] SupervisionState const& state() const noexcept { return state_; }
    [[nodiscard]] GooseSubscriber const& subscriber() const noexcept { return subscriber_; }

  private:
    GooseSubscriber subscriber_;
    SupervisionState state_;
    std::int64_t refused_ns_{0};
};

/// The same of sampled values.
class SvSupervision {
  public:
    SvSupervision(SvSubscription subscription, DataSet const& data_set);

    bool receive(FrameHeader const& header, Asdu const& asdu, std::int64_t now_ns) noexcept;
    [[nodiscard]] std::optional<std::int64_t> deadline() const noexcept { return subscriber_.deadline(); }
    bool expire(std::int64_t now_ns) noexcept;

    [[nodiscard]] SupervisionState const& state() const noexcept { return state_; }
    [[nodiscard]] SvSubscriber const& subscriber() const noexcept { return subscriber_; }

  private:
    SvSubscriber subscriber_;
    SvLayout layout_;
    std::vector<std::size_t> qualities_; ///< leaves
    SupervisionState state_;
    std::int64_t refused_ns_{0};
};

} // namespace gridspace::iec61850
