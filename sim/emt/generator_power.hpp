// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/network/network.hpp"

#include <algorithm>
#include <cmath>

namespace gridspace::sim::emt {

/// A generator without dynamics behind a converter: given powers (role pq), or a given active power and the voltage
/// held by an integral regulator within reactive limits (role pv).
class GeneratorPower final : public PowerModel {
  public:
    GeneratorPower(Generator const& generator, double base_kva) : g_{generator}, base_kva_{base_kva} {}
    void start(double kvar) override { regulated_kvar_ = kvar; }
    bool set(std::string_view quantity, double value) override {
        bool const reactive = quantity == "q_kvar", voltage = quantity == "voltage_setpoint_pu";
        if (g_.role == GeneratorRole::pq ? voltage : reactive) {
            return false;
        }
        (reactive ? g_.q_kvar : voltage ? g_.voltage_setpoint_pu : g_.p_kw) = value;
        return true;
    }
    Complex power_va(double, double v, double h) override {
        if (g_.role == GeneratorRole::pq) {
            return {1e3 * g_.p_kw, 1e3 * g_.q_kvar};
        }
        double& q = regulated_kvar_;
        double const rating = g_.rating_kva > 0 ? g_.rating_kva : std::max(std::abs(g_.p_kw), base_kva_);
        q += kVoltageRegulator * rating * (g_.voltage_setpoint_pu - v) * h;
        q = std::clamp(q, g_.q_min_kvar.value_or(-1e30),
                       std::max(g_.q_min_kvar.value_or(-1e30), g_.q_max_kvar.value_or(1e30)));
        return {1e3 * g_.p_kw, 1e3 * q};
    }

  private:
    /// Integral gain: p.u. of its power per p.u. voltage and second.
    static constexpr double kVoltageRegulator = 50;
    Generator g_;
    double base_kva_;
    double regulated_kvar_{0};
};

} // namespace gridspace::sim::emt
