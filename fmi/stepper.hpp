// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "fmi/instance.hpp"

namespace gridspace::fmi {

/// What advance() did.
struct Advance {
    bool terminated{false}; ///< the FMU wants to end: no more steps
    double reached_s{0};
    int steps{0}, discarded{0};
};

/// Makes steps until `from_s + step_s` is reached. What comes back early is continued. A step that is discarded is
/// repeated with half its size, from the state before it, where the FMU can set its state back and make steps of any
/// size; after `kHalvings` of these, or where it can not, that is a failure.
inline constexpr int kHalvings = 10;
[[nodiscard]] Result<Advance> advance(Instance& instance, CoSimulation const& can, std::string const& fmu,
                                      double from_s, double step_s);

} // namespace gridspace::fmi
