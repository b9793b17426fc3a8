// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/generator/generator.hpp"

#include "sim/components/faces/converter.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void Generator::fields(Fields& f) {
    f.number("rating_kva", rating_kva, not_negative("rated power"));
    f.choice<GeneratorRole>("role", role,
                            {{"slack", GeneratorRole::slack}, {"pv", GeneratorRole::pv}, {"pq", GeneratorRole::pq}},
                            {.doc = "what it holds: voltage and angle, power and voltage, or powers"});
    f.number("voltage_setpoint_pu", voltage_setpoint_pu, positive("held voltage (slack, pv)"));
    f.number("angle_deg", angle_deg, any("held angle (slack)"));
    f.number("p_kw", p_kw, any("active power (pv, pq)"));
    f.number("q_kvar", q_kvar, any("reactive power (pq)"));
    f.number("q_min_kvar", q_min_kvar, any("least reactive power"));
    f.number("q_max_kvar", q_max_kvar, any("most reactive power"));
    if (q_min_kvar && q_max_kvar && *q_min_kvar > *q_max_kvar) {
        f.error("q_min_kvar", fmt::format("generator '{}' has a least reactive power above its most", name.name),
                "q_min_kvar is negative where it takes reactive power");
    }
}

bool Generator::set(std::string_view quantity, double value) {
    bool const reactive = quantity == "q_kvar", voltage = quantity == "voltage_setpoint_pu";
    if (role == GeneratorRole::pq ? voltage : reactive || (role == GeneratorRole::slack && !voltage)) {
        return false;
    }
    (reactive ? q_kvar : voltage ? voltage_setpoint_pu : p_kw) = value;
    return true;
}

std::optional<Refusal> Generator::refuses(std::string_view quantity, Surroundings const&, bool) const {
    if (role == GeneratorRole::slack && quantity != "voltage_setpoint_pu") {
        return Refusal{"a generator of role slack gives what the network needs", "set the powers of others"};
    }
    if (role == GeneratorRole::pv && quantity == "q_kvar") {
        return Refusal{"a generator of role pv gives the reactive power that its voltage needs",
                       "set its voltage_setpoint_pu"};
    }
    return role == GeneratorRole::pq && quantity == "voltage_setpoint_pu"
               ? std::optional{Refusal{"a generator of role pq holds no voltage", "set its q_kvar"}}
               : std::nullopt;
}

Complex Generator::sequence_pu(Sequence, Surroundings const&) const {
    return role == GeneratorRole::slack ? Complex{1e9} : Complex{}; // stiff; a converter drives no such current
}

void Generator::power_flow(PowerFlowFace& face) const {
    switch (role) {
    case GeneratorRole::slack:
        face.source(bus, {voltage_setpoint_pu, angle_deg, {}, {}});
        break;
    case GeneratorRole::pv:
        face.regulate(bus, {.p_kw = p_kw,
                            .voltage_pu = voltage_setpoint_pu,
                            .q_min_kvar = q_min_kvar.value_or(-1e30),
                            .q_max_kvar = q_max_kvar.value_or(1e30)});
        break;
    case GeneratorRole::pq:
        face.inject(bus, {p_kw, q_kvar});
        break;
    }
}

namespace {

/// Role pq with phasors.
class GivenPower final : public PowerInjection {
  public:
    GivenPower(Generator const& g, Surroundings const& around)
        : PowerInjection{Generator::kKind, g.name, around.bus(g.bus), around.base_kva()},
          power_{Complex{g.p_kw, g.q_kvar} / around.base_kva()},
          rating_{std::max(g.rating_kva / around.base_kva(), std::abs(power_))} {}
    bool set(double, std::string_view quantity, double value) override {
        if (quantity == "voltage_setpoint_pu") {
            return false;
        }
        double const pu = value / base_kva();
        power_ = quantity == "p_kw" ? Complex{pu, power_.imag()} : Complex{power_.real(), pu};
        rating_ = std::max(rating_, std::abs(power_));
        return true;
    }

  private:
    [[nodiscard]] Complex power(double, std::span<double const>, double v) const override {
        return within_rating(power_, v, rating_);
    }
    Complex power_;
    double rating_;
};

/// Behind a converter, in waveforms: given powers (role pq), or a given active power and the voltage held by an
/// integral regulator within reactive limits (role pv).
class GeneratorPower final : public PowerModel {
  public:
    GeneratorPower(Generator const& generator, double base_kva) : g_{generator}, base_kva_{base_kva} {}
    void start(double kvar) override { regulated_kvar_ = kvar; }
    [[nodiscard]] Result<void> check_start(double v, Complex kva) const override;
    bool set(std::string_view quantity, double value) override { return g_.set(quantity, value); }
    Complex power_va(double, double v, double h) override {
        if (g_.role == GeneratorRole::pq) {
            return {1e3 * g_.p_kw, 1e3 * g_.q_kvar};
        }
        double& q = regulated_kvar_;
        double const rating = g_.rating_kva > 0 ? g_.rating_kva : std::max(std::abs(g_.p_kw), base_kva_);
        double const least = g_.q_min_kvar.value_or(-1e30);
        q += kVoltageRegulator * rating * (g_.voltage_setpoint_pu - v) * h;
        q = std::clamp(q, least, std::max(least, g_.q_max_kvar.value_or(1e30)));
        return {1e3 * g_.p_kw, 1e3 * q};
    }

  private:
    /// Integral gain: p.u. of its power per p.u. voltage and second.
    static constexpr double kVoltageRegulator = 50;
    Generator g_;
    double base_kva_;
    double regulated_kvar_{0};
};

Result<void> GeneratorPower::check_start(double v, Complex kva) const {
    double const most = kConverterOverload * g_.rating_kva;
    if (g_.role != GeneratorRole::pv || most <= 0 || std::abs(kva) <= most * v) {
        return {};
    }
    return fail(ExitCode::usage,
                fmt::format("generator '{}' would have to give {:.4g} kVA at the start, more than the {:.4g} kVA "
                            "that its converter can ({} of rating_kva)",
                            g_.name.name, std::abs(kva), most * v, kConverterOverload),
                "give it a larger rating_kva, reactive limits, or less power");
}

} // namespace

std::unique_ptr<PhasorInjection> Generator::phasor(Surroundings const& around) const {
    return role == GeneratorRole::pq ? std::make_unique<GivenPower>(*this, around) : nullptr;
}

void Generator::circuit(CircuitFace& face) const {
    if (role == GeneratorRole::slack) {
        face.source(*this, {voltage_setpoint_pu, angle_deg, {}, {}, {}});
        return;
    }
    // The reactive power of one that holds a voltage is not known here: without a rating nothing limits it.
    double const rating = role == GeneratorRole::pq ? std::max(rating_kva, std::hypot(p_kw, q_kvar)) : rating_kva;
    face.converter(*this, rating, std::make_unique<GeneratorPower>(*this, face.base_kva()));
}

} // namespace gridspace::sim
