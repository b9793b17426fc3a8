// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"

#include <complex>
#include <functional>
#include <numbers>
#include <string_view>

namespace gridspace::sim {

using config::Ref;
using Complex = std::complex<double>;
struct Element;

/// Value of an element's profile at t seconds of simulated time; 1 without one.
using Scale = std::function<double(double t_s)>;

/// What an element may ask about the network around it.
class Surroundings {
  public:
    virtual ~Surroundings() = default;
    [[nodiscard]] virtual double frequency_hz() const = 0; ///< nominal
    [[nodiscard]] virtual double base_kva() const = 0;
    [[nodiscard]] virtual std::size_t bus(Ref const& bus) const = 0;
    [[nodiscard]] virtual double voltage_v(Ref const& bus) const = 0; ///< nominal, line to line, r.m.s.
    [[nodiscard]] virtual Scale scale(Ref const& profile) const = 0;
    /// The element of that name in a section of the network file; nullptr when there is none.
    [[nodiscard]] virtual Element const* element(std::string_view section, Ref const& name) const = 0;
    /// The same by its kind: a line of its type.
    template <class T>
    [[nodiscard]] T const* find(Ref const& name) const;

    [[nodiscard]] double omega() const { return 2 * std::numbers::pi * frequency_hz(); }
    /// Base impedance of a bus, ohm.
    [[nodiscard]] double base_ohm(Ref const& bus) const {
        double const v = voltage_v(bus);
        return v * v / (base_kva() * 1e3);
    }
};

} // namespace gridspace::sim
