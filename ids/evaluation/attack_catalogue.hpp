// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "agents/attacker/sample_attack.hpp"

#include <vector>

namespace gridspace::ids {

/// An attack on the `from` stream, and, when it is coordinated, one on the `to` stream.
struct CataloguedAttack {
    std::string name;
    attacker::SampleAttackParams from;
    bool both_ends{false};
    attacker::SampleAttackParams to;
};

/// The attacks on values by which detectors are compared: isolated and repeated random values, bias, scaling, ramps,
/// replay, freeze, and faults that are not there. They start at sample `start` and last `length` samples (single ones
/// apart).
[[nodiscard]] std::vector<CataloguedAttack> attack_catalogue(double nominal_peak_a, double rate_hz, double frequency_hz,
                                                             std::int64_t start, std::int64_t length);

} // namespace gridspace::ids
