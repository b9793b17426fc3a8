// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/shunt_capacitor/shunt_capacitor.hpp"

#include "sim/components/faces/number_specs.hpp"

namespace gridspace::sim {

using namespace elements;

void ShuntCapacitor::fields(Fields& f) {
    f.number("q_kvar", q_kvar, positive("reactive power that it gives at its rated voltage", true));
    f.number("rated_kv", rated_kv, positive("rated voltage, line to line", true));
    f.choice<bool>("state", closed, {{"closed", true}, {"open", false}}, {.doc = "state of its switch at the start"});
}

Complex ShuntCapacitor::admittance_kva(double voltage_v) const {
    double const v = voltage_v / (1e3 * rated_kv);
    return {0, q_kvar * v * v};
}

namespace {

class CapacitorInjection final : public PowerInjection {
  public:
    CapacitorInjection(ShuntCapacitor const& bank, Surroundings const& around)
        : PowerInjection{ShuntCapacitor::kKind, bank.name, around.bus(bank.bus), around.base_kva()},
          nominal_{bank.admittance_kva(around.voltage_v(bank.bus)) / around.base_kva()} {}

  private:
    [[nodiscard]] Complex power(double, std::span<double const>, double v) const override { return nominal_ * v * v; }
    Complex nominal_;
};

} // namespace

std::unique_ptr<PhasorInjection> ShuntCapacitor::phasor(Surroundings const& around) const {
    return std::make_unique<CapacitorInjection>(*this, around);
}

} // namespace gridspace::sim
