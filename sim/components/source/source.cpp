// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/components/source/source.hpp"

#include "sim/components/faces/shared_checks.hpp"

#include <cmath>
#include <fmt/format.h>

namespace gridspace::sim {

using namespace elements;

void Source::fields(Fields& f) {
    f.number("voltage_pu", voltage_pu, not_negative("internal voltage"));
    f.number("angle_deg", angle_deg, any("angle of phase a"));
    f.number("r_ohm", r_ohm, not_negative("resistance, positive sequence"));
    f.number("l_mh", l_mh, not_negative("inductance, positive sequence"));
    f.number("r0_ohm", r0_ohm, not_negative("resistance, zero sequence"));
    f.number("l0_mh", l0_mh, not_negative("inductance, zero sequence"));
    f.list("harmonics", {.doc = "harmonics of the internal voltage"}, [&](Fields& h) {
        Harmonic harmonic;
        h.integer("order", harmonic.order, {.doc = "order", .required = true, .min = 2});
        h.number("percent", harmonic.percent, not_negative("amplitude, of the fundamental", true));
        h.number("angle_deg", harmonic.angle_deg, any("angle of phase a"));
        harmonics.push_back(harmonic);
    });
}

void Source::check(ElementCheck& check) const {
    bool const zero = r0_ohm.value_or(r_ohm) != 0 || l0_mh.value_or(l_mh) != 0;
    if (ideal() == zero) {
        check.wrong(fmt::format("has a {} sequence impedance but no {} sequence impedance",
                                ideal() ? "zero" : "positive", ideal() ? "positive" : "zero"),
                    "give both, or neither");
    }
    double const omega = check.around().omega();
    check_least_impedance(check, bus, std::abs(z1_ohm(omega)), std::abs(z0_ohm(omega)));
}

std::optional<Refusal> Source::refuses(std::string_view quantity, Surroundings const&, bool waveform) const {
    return quantity == "frequency_hz" && !waveform && ideal()
               ? std::optional{Refusal{"with phasors a source without an impedance holds the angle of its bus",
                                       "give it an l_mh"}}
               : std::nullopt;
}

Complex Source::sequence_pu(Sequence sequence, Surroundings const& around) const {
    constexpr double kStiff = 1e9; // an ideal source
    Complex const z = sequence == Sequence::zero ? z0_ohm(around.omega()) : z1_ohm(around.omega());
    return z == Complex{} ? Complex{kStiff} : around.base_ohm(bus) / z;
}

namespace {

class SourceInjection final : public PhasorInjection {
  public:
    SourceInjection(Source const& source, Surroundings const& around)
        : PhasorInjection{around.bus(source.bus)}, name_{source.name.name}, base_kva_{around.base_kva()},
          nominal_hz_{around.frequency_hz()}, voltage_pu_{source.voltage_pu},
          angle_rad_{source.angle_deg * std::numbers::pi / 180},
          admittance_{around.base_ohm(source.bus) / source.z1_ohm(around.omega())} {}

    Complex flow(double t, std::span<double const>, Complex v, std::span<double>) const override {
        return (emf(t) - v) * admittance_;
    }
    [[nodiscard]] std::vector<SignalDef> signals() const override {
        return {{"source." + name_ + ".p_kw", "kW"}, {"source." + name_ + ".q_kvar", "kvar"}};
    }
    [[nodiscard]] double value(std::size_t signal, double t, std::span<double const>, Complex v) const override {
        Complex const s = v * std::conj((emf(t) - v) * admittance_);
        return (signal == 0 ? s.real() : s.imag()) * base_kva_;
    }
    /// The phase goes on.
    bool set(double t, std::string_view quantity, double value) override {
        if (quantity == "voltage_pu") {
            voltage_pu_ = value;
            return true;
        }
        angle_rad_ += slip_rad_s_ * (t - since_s_);
        since_s_ = t;
        slip_rad_s_ = 2 * std::numbers::pi * (value - nominal_hz_);
        return true;
    }

  private:
    [[nodiscard]] Complex emf(double t) const {
        return std::polar(voltage_pu_, angle_rad_ + slip_rad_s_ * (t - since_s_));
    }
    std::string name_;
    double base_kva_, nominal_hz_, voltage_pu_;
    double angle_rad_, since_s_{0}, slip_rad_s_{0}; ///< at since_s_, and how fast it turns against the reference
    Complex admittance_;
};

} // namespace

std::unique_ptr<PhasorInjection> Source::phasor(Surroundings const& around) const {
    return ideal() ? nullptr : std::make_unique<SourceInjection>(*this, around);
}

void Source::circuit(CircuitFace& face) const {
    double const l = l_mh * 1e-3;
    CircuitFace::SourceData data{voltage_pu,
                                 angle_deg,
                                 emt::PhaseMatrix::sequence(r_ohm, r0_ohm.value_or(r_ohm)),
                                 emt::PhaseMatrix::sequence(l, l0_mh ? *l0_mh * 1e-3 : l),
                                 {}};
    for (Harmonic const& h : harmonics) {
        data.harmonics.push_back({static_cast<int>(h.order), h.percent / 100, h.angle_deg * std::numbers::pi / 180});
    }
    face.source(*this, data);
}

} // namespace gridspace::sim
