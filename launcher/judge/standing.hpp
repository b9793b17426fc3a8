// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expectation.hpp"

#include <string_view>

namespace gridspace::launcher {

/// How an expectation stands while its run goes on.
enum class Standing {
    unknown, ///< nothing can be said yet: its time has not begun, or what it waits for has not come
    holds,   ///< the value lies in the band, and may leave it yet
    not_yet, ///< the value lies outside of the band, and may come into it yet
    passed,  ///< whatever comes
    failed,  ///< whatever comes
    shown,   ///< it is not judged
};
[[nodiscard]] std::string_view name_of(Standing standing);

struct ExpectationStanding {
    Standing standing{Standing::unknown};
    ExpectationResult result; ///< by what is known: `value` may be missing, and its status is not the last word
};

/// Judges an expectation of a run that is under way. `signals` and `moments` hold all that is known up to `reached_s`
/// and nothing later; the run is to end at `duration_s`. What is `passed` or `failed` is what judge() says of the whole
/// run, if that comes to `duration_s`.
[[nodiscard]] ExpectationStanding stand(Expectation const& expectation, SignalStore const& signals,
                                        Moments const& moments, double reached_s, double duration_s, bool lockstep);

} // namespace gridspace::launcher
