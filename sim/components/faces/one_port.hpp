// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/circuit_face.hpp"
#include "sim/components/faces/phasor_injection.hpp"
#include "sim/components/faces/power_flow_face.hpp"

#include <memory>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace::sim {

/// How an element finds mistakes that its own keys do not show.
class ElementCheck {
  public:
    virtual ~ElementCheck() = default;
    /// `profile`, if it is given, must exist.
    virtual void profile(Ref const& profile) = 0;
    virtual void wrong(std::string_view what, std::string hint) = 0;
};

/// Why a quantity of this element cannot be set, and what to do instead.
struct Refusal {
    std::string_view why, hint;
};

/// An element at one bus: its data as in the network file, and a face for everybody who must know what it is. Solvers
/// know these faces and no kinds (docs/design/elements.md).
struct OnePort : Element {
    Ref bus;

    OnePort() = default;
    OnePort(OnePort const&) = default;
    OnePort(OnePort&&) = default;
    OnePort& operator=(OnePort const&) = default;
    OnePort& operator=(OnePort&&) = default;
    virtual ~OnePort() = default;

    [[nodiscard]] virtual Kind const& kind() const = 0;
    /// The keys of the network file, beside `bus`.
    virtual void fields(config::Fields& f) = 0;
    virtual void check(ElementCheck& /*check*/) const {}
    /// Its phases have loads of their own.
    [[nodiscard]] virtual bool unbalanced() const { return false; }

    /// Conductance and susceptance (a capacitor is positive) of the earthed star that it is in the sequence networks of
    /// a fault, kVA at the nominal voltage `voltage_v` of its bus.
    [[nodiscard]] virtual Complex admittance_kva(double /*voltage_v*/) const { return {}; }
    /// Whether it connects its bus to earth.
    [[nodiscard]] virtual bool earthed() const { return admittance_kva(1) != Complex{}; }
    /// Whether its poles are closed at the start.
    [[nodiscard]] virtual bool closed_at_start() const { return true; }

    virtual void power_flow(PowerFlowFace& face) const = 0;
    /// Nothing where the power flow's admittance says all.
    [[nodiscard]] virtual std::unique_ptr<PhasorInjection> phasor(Surroundings const& /*around*/) const { return {}; }
    virtual void circuit(CircuitFace& face) const = 0;

    /// Changes a quantity of kind().settable in a run, as far as it is in the element's data; false when it cannot have
    /// this value.
    virtual bool set(std::string_view /*quantity*/, double /*value*/) { return true; }
    [[nodiscard]] virtual std::optional<Refusal> refuses(std::string_view /*quantity*/) const { return {}; }
    /// What such a quantity is now.
    [[nodiscard]] virtual double value(std::string_view /*quantity*/) const { return 0; }
};

} // namespace gridspace::sim
