// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/standing.hpp"

#include "common/text.hpp"

#include <algorithm>

namespace gridspace::launcher {
namespace {

using Verb = Expectation::Verb;
using Status = ExpectationResult::Status;

/// How the value of a verb moves while more comes: an edge of the band that it cannot come back over decides.
enum class Moves { down, up, both, never };

Moves moves(Verb verb) {
    switch (verb) {
    case Verb::min_of:
        return Moves::down;
    case Verb::max_of:
    case Verb::count_of:
        return Moves::up;
    case Verb::time_of: // the first time stays the first
        return Moves::never;
    default:
        return Moves::both;
    }
}

Standing of_value(double value, Expectation::Band const& band, Moves moves) {
    using Band = Expectation::Band;
    bool const in = band.contains(value);
    bool const may_fall = moves == Moves::down || moves == Moves::both;
    bool const may_rise = moves == Moves::up || moves == Moves::both;
    bool const too_low = !Band{band.low, {}, band.low_open, false}.contains(value);
    bool const too_high = !Band{{}, band.high, false, band.high_open}.contains(value);
    if (in) {
        return (may_fall && band.low) || (may_rise && band.high) ? Standing::holds : Standing::passed;
    }
    return (too_low && !may_rise) || (too_high && !may_fall) ? Standing::failed : Standing::not_yet;
}

/// The time that an expectation looks at, as far as it is known; seconds.
struct Window {
    std::optional<double> from, until, since;
};

Window window_of(Expectation const& e, Moments const& moments, double duration_s) {
    auto const instant = [&](std::optional<Moment> const& moment, double otherwise) {
        return moment ? instant_of(*moment, moments) : std::optional{otherwise};
    };
    Window w{instant(e.from, 0), instant(e.until, duration_s), instant(e.since, 0)};
    if (w.until && e.within_s && w.from) {
        w.until = std::min(*w.until, *w.from + *e.within_s);
    }
    return w;
}

bool all_recorded(Expectation const& e, SignalStore const& signals) {
    std::vector<std::string> const& used = e.expression->signals();
    return std::all_of(used.begin(), used.end(), [&](std::string const& pattern) {
        return std::any_of(signals.begin(), signals.end(), [&](auto const& signal) {
            return matches_glob(pattern, signal.first) && !signal.second.times_ns.empty();
        });
    });
}

/// While its time goes on.
Standing standing_of(Expectation const& e, ExpectationResult const& result, double since_s, double reached_s) {
    switch (e.verb) {
    case Verb::always:
    case Verb::never:
        return result.status == Status::passed ? Standing::holds
               : result.decided_at_s           ? Standing::failed
                                               : Standing::unknown; // no value yet
    case Verb::eventually:
    case Verb::intervals_ms:
        return result.status == Status::passed ? Standing::passed : Standing::unknown;
    default:
        if (result.value) {
            return of_value(*result.value, result.band, moves(e.verb));
        }
        bool const too_late =
            e.verb == Verb::time_of && result.band.high && reached_s > since_s + *result.band.high * e.unit_s();
        return too_late ? Standing::failed : Standing::unknown;
    }
}

} // namespace

std::string_view name_of(Standing standing) {
    switch (standing) {
    case Standing::unknown:
        return "unknown";
    case Standing::holds:
        return "holds";
    case Standing::not_yet:
        return "not_yet";
    case Standing::passed:
        return "passed";
    case Standing::failed:
        return "failed";
    case Standing::shown:
        break;
    }
    return "shown";
}

ExpectationStanding stand(Expectation const& e, SignalStore const& signals, Moments const& moments, double reached_s,
                          double duration_s, bool lockstep) {
    ExpectationStanding out;
    out.result = judge(e, signals, moments, reached_s, lockstep);
    Window const window = window_of(e, moments, duration_s);
    if (e.show_only || out.result.status == Status::not_applicable) {
        out.standing = Standing::shown;
        return out;
    }
    // Of what detectors and attacks did, and of processor times, signals are made when the run has ended.
    bool const begun = window.from && window.until && window.since && *window.from <= reached_s &&
                       *window.since <= reached_s && all_recorded(e, signals);
    if (!begun) {
        out.result.value.reset();
        out.result.detail.clear();
        return out;
    }
    bool const closed = *window.until <= reached_s;
    out.standing = closed ? (out.result.status == Status::passed ? Standing::passed : Standing::failed)
                          : standing_of(e, out.result, *window.since, reached_s);
    if (out.standing == Standing::unknown) {
        out.result.value.reset();
        out.result.detail.clear();
    }
    return out;
}

} // namespace gridspace::launcher
