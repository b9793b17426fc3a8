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
    if (params.kind == SampleAttackParams::Kind::masquerade && !(params.tau_s > 0)) {
        return bad("the time constant of the offset must be positive");
    }
    return SampleAttack{std::move(params), seed};
}

SampleAttack::SampleAttack(SampleAttackParams params, std::uint64_t seed)
    : params_{std::move(params)}, random_{seed, params_.name} {
    if (params_.spacing == SampleAttackParams::Spacing::random) {
        chosen_ = choose(random_, params_.from, params_.until, params_.count, params_.min_gap);
    }
    if (params_.kind == SampleAttackParams::Kind::replay) {
        past_.resize(static_cast<std::size_t>(params_.delay));
    }
}

bool SampleAttack::due(std::int64_t index) {
    if (index < params_.from || index >= params_.until) {
        return false;
    }
    if (params_.spacing == SampleAttackParams::Spacing::every) {
        return true;
    }
    while (next_chosen_ < chosen_.size() && chosen_[next_chosen_] < index) {
        ++next_chosen_;
    }
    return next_chosen_ < chosen_.size() && chosen_[next_chosen_] == index;
}

double SampleAttack::draw(double true_a) {
    // Uniform over the range without the interval around the truth, so that no draw is thrown away.
    double const hole_low = std::clamp(true_a - params_.min_error_a, params_.low_a, params_.high_a);
    double const hole_high = std::clamp(true_a + params_.min_error_a, params_.low_a, params_.high_a);
    double const x = random_.uniform(params_.low_a, params_.high_a - (hole_high - hole_low));
    return x < hole_low ? x : x + (hole_high - hole_low);
}

double SampleAttack::fake(std::int64_t index, std::size_t phase, double true_a) {
    using Kind = SampleAttackParams::Kind;
    double const t = static_cast<double>(index - params_.from) / params_.rate_hz;
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
    }
    return true_a;
}

SampleAttack::Outcome SampleAttack::apply(std::int64_t index, Abc const& true_a) {
    Outcome out{true_a, 0};
    if (due(index)) {
        for (std::size_t p = 0; p < 3; ++p) {
            if ((params_.channels & (1U << p)) == 0) {
                continue;
            }
            out.sent_a[p] = fake(index, p, true_a[p]);
            if (out.sent_a[p] != true_a[p]) {
                out.altered = static_cast<std::uint8_t>(out.altered | (1U << p));
            }
        }
        altered_ += out.altered != 0 ? 1U : 0U;
    }
    if (index < params_.from) {
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
