// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/element.hpp"

#include <functional>

namespace gridspace::sim {

/// Value of an element's profile at t seconds of simulated time; 1 without one.
using Scale = std::function<double(double t_s)>;

/// What an element may ask about the network around it, when a solver takes it up.
class Surroundings {
  public:
    virtual ~Surroundings() = default;
    [[nodiscard]] virtual double base_kva() const = 0;
    [[nodiscard]] virtual std::size_t bus(Ref const& bus) const = 0;
    [[nodiscard]] virtual double voltage_v(Ref const& bus) const = 0; ///< nominal, line to line, r.m.s.
    [[nodiscard]] virtual Scale scale(Ref const& profile) const = 0;
};

} // namespace gridspace::sim
