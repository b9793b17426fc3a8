// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/time.hpp"

#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::agents {

/// Thresholds and factors of Eq. (3) and (4).
struct MccaRules {
    double full_above_pu{0.97};        ///< everybody gets what he asked for while all voltages are above
    double full_again_above_pu{0.975}; ///< the other side of the published overlap, for `safe` and `hysteresis`
    double stop_at_pu{0.955};          ///< at or below: undervoltage, Eq. (4)
    double curtail_factor{0.75};
    double undervoltage_factor{0.5}; ///< for EVs at healthy buses during an undervoltage
    enum class Overlap {
        first_match, ///< full above full_above_pu
        safe,        ///< full above full_again_above_pu
        hysteresis,  ///< curtail at full_above_pu, full again above full_again_above_pu
    } overlap{Overlap::first_match};
};

struct MccaRequest {
    std::string ev;
    double current_a{0};
    double v_pu{0};
    double period_s{0};
};

/// Why nothing can be decided on a request ("current_a is nan"); nothing when it can. A voltage that is not a number is
/// none: it counts as undervoltage.
[[nodiscard]] std::optional<std::string> fault_of(MccaRequest const& request);

struct MccaDecision {
    std::string ev;
    double current_a{0};
    double factor{1}; ///< of what was asked
};

/// The microgrid control agent: collects the requests of a period and decides on all of them together.
class Mcca {
  public:
    struct Params {
        MccaRules rules;
        std::vector<std::string> evs; ///< it decides as soon as all of these have asked
        SimSpan request_timeout;      ///< after the first request, it decides with those that did
    };
    explicit Mcca(Params params);

    struct Outcome {
        SimTime time;                        ///< of the decision
        std::vector<MccaDecision> decisions; ///< in the order of Params::evs
        bool complete{true};                 ///< false: the timeout decided
        bool curtailed{false};
        bool undervoltage{false};
        double period_s{0}; ///< the longest of the requests'
    };

    /// A request that takes effect at `time`. Returns the decision when it was the last one awaited.
    /// Requests of EVs that are not listed, and those with a fault, are ignored.
    [[nodiscard]] std::optional<Outcome> request(SimTime time, MccaRequest const& request);
    [[nodiscard]] bool serves(std::string_view ev) const;
    /// Returns the decision when the timeout has passed by `now`.
    [[nodiscard]] std::optional<Outcome> elapse(SimTime now);
    /// When elapse() will have something to do.
    [[nodiscard]] std::optional<SimTime> deadline() const;

  private:
    [[nodiscard]] Outcome decide(SimTime time, bool complete);
    Params params_;
    std::vector<std::optional<MccaRequest>> asked_; ///< by EV
    std::optional<SimTime> first_;
    bool curtailed_{false};
};

} // namespace gridspace::agents
