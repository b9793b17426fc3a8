// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/faces/one_port.hpp"

namespace gridspace::sim {
namespace {

/// Listens to what an element says about voltages.
class Listener final : public PowerFlowFace {
  public:
    Holding holding;
    void source(Ref const&, IdealSource const& source) override {
        holding = {.ideal = source.z1_ohm == Complex{}, .keeps_alive = true};
    }
    void regulate(Ref const&, Regulation const& regulation) override {
        holding = {.regulates = true, .keeps_alive = regulation.keeps_alive, .rating_kva = regulation.rating_kva};
    }
    void inject(Ref const&, Complex) override {}
    void admit(Ref const&, Complex) override {}
    void draw(Ref const&, VoltageDependent const&, double) override {}
    [[nodiscard]] double voltage_v(Ref const&) const override { return 1; }
    [[nodiscard]] double omega() const override { return 1; }
    [[nodiscard]] double scale(Ref const&) const override { return 1; }
};

} // namespace

Holding holding_of(OnePort const& element) {
    Listener listener;
    element.power_flow(listener);
    return listener.holding;
}

} // namespace gridspace::sim
