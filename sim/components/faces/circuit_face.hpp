// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/circuit/circuit.hpp"
#include "sim/components/faces/element.hpp"
#include "sim/components/faces/ride_through.hpp"
#include "sim/engine/engine.hpp"

#include <array>
#include <memory>
#include <vector>

namespace gridspace::sim {

struct OnePort;

/// The power that a grid-following injection gives in the waveform simulation, and the states behind it.
class PowerModel {
  public:
    virtual ~PowerModel() = default;
    /// Back to the start. `kvar`: reactive power that the power flow found.
    virtual void start(double /*kvar*/) {}
    /// Whether it can begin with this power (kVA, into the network) at this voltage (p.u.); the error names the
    /// element.
    [[nodiscard]] virtual Result<void> check_start(double /*v*/, Complex /*kva*/) const { return {}; }
    /// Power into the network (VA) at voltage v (p.u.), after it has been so for a time of h.
    virtual Complex power_va(double t, double v, double h) = 0;
    /// The same of one phase, of what is unlike in the phases.
    virtual Complex phase_power_va(std::size_t /*phase*/, double t, double v, double h) {
        return power_va(t, v, h) / 3.0;
    }
    /// Taken out of service; what it gives is not asked until it is back.
    virtual void disconnect() {}
    /// Changes a quantity in a run; false when it cannot have this value.
    virtual bool set(std::string_view /*quantity*/, double /*value*/) { return true; }
    /// Signals other than its powers and currents, and their values.
    [[nodiscard]] virtual std::vector<SignalDef> signals() const { return {}; }
    [[nodiscard]] virtual double value(std::size_t /*signal*/) const { return 0; }
};

/// The parts that an element can put into the circuit of the waveform simulation, behind poles of its own.
class CircuitFace : public Surroundings {
  public:
    /// Impedances to earth, alike in the phases: OnePort::admittance_kva().
    virtual void star(OnePort const& element) = 0;
    /// Impedances to earth that draw these powers at nominal voltage, kVA.
    virtual void star_by_phase(OnePort const& element, std::array<Complex, 3> const& kva) = 0;
    /// An averaged converter with its filter. 0 kVA: nothing limits its current.
    virtual void converter(OnePort const& element, double rating_kva, std::unique_ptr<PowerModel> model,
                           std::optional<RideThrough> const& ride_through = {}) = 0;
    /// What the element draws beyond the star that it has already; phase by phase in an unbalanced network.
    virtual void beyond_star(OnePort const& element, std::unique_ptr<PowerModel> model) = 0;
    /// An ideal voltage, p.u. of the nominal one of its bus, behind a resistance and inductance (none: 0).
    struct SourceData {
        double voltage_pu{1}, angle_deg{0};
        emt::PhaseMatrix r_ohm{}, l_h{};
        std::vector<emt::VoltageSource::Harmonic> harmonics{};
    };
    virtual void source(OnePort const& element, SourceData const& data) = 0;
    /// An element with states of its own.
    virtual void norton(OnePort const& element, std::shared_ptr<emt::NortonElement> model) = 0;
    /// Peak of the nominal voltage of a bus, phase to earth.
    [[nodiscard]] virtual double peak_v(Ref const& bus) const = 0;
};

} // namespace gridspace::sim
