// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/sample_attack.hpp"

#include "common/elementary.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

constexpr double kTwoPi = 6.283185307179586;

/// `count` indices in [from, until), each at least `gap` after the one before; every such choice is equally likely.
std::vector<std::int64_t> choose(Random& random, std::int64_t from, std::int64_t until, std::int64_t count,
                                 std::int64_t gap) {
    auto const room = static_cast<std::uint64_t>(until - from - (count - 1) * (gap - 1));
    // Floyd's algorithm: `count` different numbers below `room`, without trying in vain.
    std::vector<std::uint64_t> picked;
    picked.reserve(static_cast<std::size_t>(count));
    for (std::uint64_t j = room - static_cast<std::uint64_t>(count); j < room; ++j) {
        std::uint64_t const t = random.below(j + 1);
        auto const place = std::lower_bound(picked.begin(), picked.end(), t);
        if (place != picked.end() && *place == t) {
            picked.push_back(j); // larger than all others
        } else {
            picked.insert(place, t);
        }
    }
    std::vector<std::int64_t> out;
    for (std::size_t k = 0; k < picked.size(); ++k) {
        out.push_back(from + static_cast<std::int64_t>(picked[k]) + static_cast<std::int64_t>(k) * (gap - 1));
    }
    return out;
}

/// How far behind the clock is, in samples.
double lag(SampleAttackParams const& p, std::int64_t since_start) {
    return (p.offset_s + p.drift * static_cast<double>(since_start) / p.rate_hz) * p.rate_hz;
}

constexpr double kLongestLag = 480'000;

} // namespace

Result<SampleAttack> SampleAttack::create(SampleAttackParams params, std::uint64_t seed) {
    auto const bad = [&](std::string what, std::string remedy = {}) {
        return fail(ExitCode::usage, fmt::format("attack '{}': {}", params.name, what), std::move(remedy));
    };
    if (params.until <= params.from) {
        return bad("its window is empty", "until must be after from");
    }
    if ((params.channels & 7U) == 0) {
        return bad("no channel is attacked");
    }
    if (params.spacing == SampleAttackParams::Spacing::random) {
        std::int64_t const length = params.until - params.from;
        if (params.count < 1 || params.min_gap < 1) {
            return bad("random spacing needs count and min_gap of at least 1");
        }
        if (params.count > length || (params.count - 1) > (length - 1) / params.min_gap) {
            return bad(fmt::format("{} samples at least {} apart do not fit into {} samples", params.count,
                                   params.min_gap, length),
                       "widen the window, or ask for fewer");
        }
    }
    if (params.kind == SampleAttackParams::Kind::random) {
        if (!(params.high_a > params.low_a)) {
            return bad("the range of values is empty");
        }
        if (params.high_a - params.low_a < 2 * params.min_error_a) {
            return bad(fmt::format("values from {} to {} A cannot always be {} A from the truth", params.low_a,
                                   params.high_a, params.min_error_a),
                       "lower min_error_a or widen the range");
        }
    }
    if (params.kind == SampleAttackParams::Kind::replay && (params.delay < 1 || params.delay > 10'000'000)) {
        return bad("replay needs a delay of at least one sample");
    }
    if (params.times > 1 && params.every < params.until - params.from) {
        return bad("its windows overlap", "every_s is from one start to the next, at least until_s - from_s");
    }
    if (params.spacing == SampleAttackParams::Spacing::random && (params.times > 1 || params.above_a || params.waits)) {
        return bad("single samples are drawn from one window that is known beforehand",
                   "leave `repeat` and `when` out, or alter every sample");
    }
    if (params.kind == SampleAttackParams::Kind::clock) {
        double const end = lag(params, params.until - params.from);
        if (lag(params, 0) < 0 || end < 0) {
            return bad("its clock would show samples that are still to come",
                       "offset_us and drift_us_per_s of at least 0, or attack the other end");
        }
        if (std::max(lag(params, 0), end) > kLongestLag) {
            return bad("its clock is too far behind", "at most 100 s at 4800 Hz");
        }
    }
    if (params.kind == SampleAttackParams::Kind::recording && params.recording.empty()) {
        return bad("its recording has no samples");
    }
    if (params.kind == SampleAttackParams::Kind::masquerade && !(params.tau_s > 0)) {
        return bad("the time constant of the offset must be positive");
    }
    return SampleAttack{std::move(params), seed};
}

SampleAttack::SampleAttack(SampleAttackParams params, std::uint64_t seed)
    : params_{std::move(params)}, window_{{params_.from, params_.until, params_.every, params_.times, params_.ramp,
                                           params_.above_a.has_value() || params_.waits}},
      random_{seed, params_.name} {
    if (params_.spacing == SampleAttackParams::Spacing::random) {
        chosen_ = choose(random_, params_.from, params_.until, params_.count, params_.min_gap);
    }
    if (params_.kind == SampleAttackParams::Kind::replay) {
        past_.resize(static_cast<std::size_t>(params_.delay));
    } else if (params_.kind == SampleAttackParams::Kind::clock) {
        double const most = std::max(lag(params_, 0), lag(params_, params_.until - params_.from));
        past_.resize(static_cast<std::size_t>(most) + 4);
    }
}

/// The start of the window when the sample is to be altered.
std::optional<std::int64_t> SampleAttack::due(std::int64_t index, Abc const& true_a) {
    for (std::size_t p = 0; p < 3 && params_.above_a; ++p) {
        triggered_ = triggered_ || ((params_.channels & (1U << p)) != 0 && std::fabs(true_a[p]) > *params_.above_a);
    }
    if (std::exchange(triggered_, false)) {
        window_.trigger(index);
    }
    auto const start = window_.start(index);
    if (!start || params_.spacing == SampleAttackParams::Spacing::every) {
        return start;
    }
    while (next_chosen_ < chosen_.size() && chosen_[next_chosen_] < index) {
        ++next_chosen_;
    }
    return next_chosen_ < chosen_.size() && chosen_[next_chosen_] == index ? start : std::nullopt;
}

double SampleAttack::draw(double true_a) {
    // Uniform over the range without the interval around the truth, so that no draw is thrown away.
    double const hole_low = std::clamp(true_a - params_.min_error_a, params_.low_a, params_.high_a);
    double const hole_high = std::clamp(true_a + params_.min_error_a, params_.low_a, params_.high_a);
    double const x = random_.uniform(params_.low_a, params_.high_a - (hole_high - hole_low));
    return x < hole_low ? x : x + (hole_high - hole_low);
}

/// The current so long ago, through the four samples around that instant (at the newest end, through the last four).
double SampleAttack::late(std::int64_t index, std::int64_t start, std::size_t phase, double true_a) const {
    double const behind = lag(params_, index - start);
    auto const newest = std::max<std::int64_t>(static_cast<std::int64_t>(behind) - 1, 0); // of the four, counted back
    if (static_cast<std::size_t>(newest) + 3 > past_filled_) {
        return true_a; // not heard for that long yet
    }
    double out = 0;
    for (std::int64_t i = 0; i < 4; ++i) {
        std::int64_t const back = newest + i;
        auto const at = static_cast<std::size_t>(static_cast<std::int64_t>(past_next_) +
                                                 static_cast<std::int64_t>(past_.size()) - back) %
                        past_.size();
        double weight = 1;
        for (std::int64_t j = 0; j < 4; ++j) {
            if (j != i) {
                weight *= (behind - static_cast<double>(newest + j)) / static_cast<double>(i - j);
            }
        }
        out += weight * (back == 0 ? true_a : past_[at][phase]);
    }
    return out;
}

double SampleAttack::fake(std::int64_t index, std::int64_t start, std::size_t phase, double true_a) {
    using Kind = SampleAttackParams::Kind;
    double const t = static_cast<double>(index - start) / params_.rate_hz;
    switch (params_.kind) {
    case Kind::random:
        return draw(true_a);
    case Kind::bias:
        return true_a + params_.bias_a;
    case Kind::scale:
        return true_a * params_.factor;
    case Kind::ramp:
        return true_a * (1 + params_.ramp_per_cycle * t * params_.frequency_hz);
    case Kind::replay:
        return past_filled_ == past_.size() ? past_[past_next_][phase] : true_a;
    case Kind::freeze:
        return before_[phase];
    case Kind::masquerade: {
        double const angle = params_.angle_deg * kTwoPi / 360 - kTwoPi * static_cast<double>(phase) / 3;
        return true_a + params_.peak_a * (elementary::cos(kTwoPi * params_.frequency_hz * t + angle) -
                                          elementary::cos(angle) * elementary::exp(-t / params_.tau_s));
    }
    case Kind::clock:
        return late(index, start, phase, true_a);
    case Kind::recording:
        return params_.recording[static_cast<std::size_t>(index - start) % params_.recording.size()][phase];
    }
    return true_a;
}

SampleAttack::Outcome SampleAttack::apply(std::int64_t index, Abc const& true_a) {
    Outcome out{true_a, 0};
    auto const start = due(index, true_a);
    if (start) {
        double const strength = window_.strength(*start, index);
        for (std::size_t p = 0; p < 3; ++p) {
            if ((params_.channels & (1U << p)) == 0) {
                continue;
            }
            double const whole = fake(index, *start, p, true_a[p]);
            out.sent_a[p] = params_.ramp > 0 ? true_a[p] + strength * (whole - true_a[p]) : whole;
            if (out.sent_a[p] != true_a[p]) {
                out.altered = static_cast<std::uint8_t>(out.altered | (1U << p));
            }
        }
        altered_ += out.altered != 0 ? 1U : 0U;
    }
    if (!window_.acts(index)) {
        before_ = true_a;
    }
    if (!past_.empty()) {
        past_[past_next_] = true_a;
        past_next_ = past_next_ + 1 == past_.size() ? 0 : past_next_ + 1;
        past_filled_ = std::min(past_filled_ + 1, past_.size());
    }
    return out;
}

} // namespace gridspace::attacker
