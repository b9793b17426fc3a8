// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

namespace gridspace::gateways {

/// What a subscriber does about a frame that the first-line rules (ids/rules) find suspicious.
struct FirstLineConfig {
    enum class OnFinding {
        ignore, ///< the rules do not run
        report, ///< counted, shown, told as events; the frame is used as if nothing had been found
        refuse, ///< and the frame is not used
    };
    OnFinding on_finding{OnFinding::report};
    /// Two publishers with one address, and nobody can tell who is real.
    enum class InContest {
        accept, ///< each state that is new is used, whoever begins it: a trip that either asks for is given
        refuse, ///< none is: a forger can hold a trip back
    };
    InContest in_contest{InContest::accept};
    bool check_clock{false}; ///< GOOSE: |t - now| of a new state; both clocks must be synchronised
};
/// The key `first_line`.
void describe(config::Fields& f, FirstLineConfig& config);

} // namespace gridspace::gateways
