// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A grid-forming battery alone on an island, its control and current limit as behavioural sources of ngspice: through a
// step of load, and through a fault that its current limit holds.
#include "common/config/yaml.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"
#include "tests/integration/ngspice/ngspice_fixture.hpp"

#include <array>
#include <cmath>
#include <complex>
#include <numbers>

namespace gridspace::sim::emt {
namespace {

using Complex = std::complex<double>;

constexpr double kHz = 60, kOmega = 2 * std::numbers::pi * kHz;
constexpr double kRatedVa = 150e3, kRatedV = 480;
double const kPeakV = kRatedV * std::sqrt(2.0 / 3), kPeakA = 2 * kRatedVa / (3 * kPeakV), kBaseOhm = kPeakV / kPeakA;
// The battery, p.u.; the line and the load.
constexpr double kR = 0.02, kX = 0.15, kDroop = 0.03, kH = 0.2, kVoltageKi = 20, kFilterS = 0.02, kVoltageDroop = 0.05,
                 kLimit = 1.3;
constexpr double kLineOhm = 0.02, kLineH = 0.1e-3, kLoadKw = 60, kLoadKvar = 20, kMoreKw = 50;

Network island() {
    std::string const text = fmt::format(
        "gridspace_network: 1\nname: t\nbase: {{frequency_hz: 60, power_kva: 100}}\n"
        "buses: {{A: {{voltage_v: 480}}, B: {{voltage_v: 480}}}}\n"
        "lines: {{L: {{from: A, to: B, r_ohm: {0}, l_mh: {1}, r0_ohm: {0}, l0_mh: {1}}}}}\n"
        "loads: {{D: {{bus: B, p_kw: {2}, q_kvar: {3}, model: constant_impedance}}}}\n"
        "batteries: {{G: {{bus: A, capacity_kwh: 100, rating_kva: 150, control: grid_forming, p_kw: 0, grid_forming: "
        "{{droop_percent: {4}, voltage_droop_percent: {5}, inertia_h_s: {6}, voltage_ki: {7}, power_filter_s: {8}, "
        "r_pu: {9}, x_pu: {10}, current_limit_pu: {11}}}}}}}\n",
        kLineOhm, kLineH * 1e3, kLoadKw, kLoadKvar, 100 * kDroop, 100 * kVoltageDroop, kH, kVoltageKi, kFilterS, kR, kX,
        kLimit);
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    auto network = read_network(*root, diagnostics);
    EXPECT_TRUE(network.has_value()) << diagnostics.render();
    return network.value_or(Network{});
}

/// The same in ngspice, from the equations of docs/reference/components.md ("Grid-forming batteries") and the two lags
/// that it states for waveforms: 0.1 ms of the measured voltage, 0.2 ms of what exceeds the limit. `event`: what
/// happens at bus B.
std::string netlist(Complex emf, Complex amperes, Complex load_amperes, double v_ref, double p0, double q0,
                    std::string const& event) {
    double const w0 = kOmega, third = 2 * std::numbers::pi / 3;
    std::string out =
        // State of the control: speed, angle, internal voltage, reactive power, measured voltage (in its own frame).
        fmt::format("Bw 0 w I=({} - v(p) - v(w)/{})/{}\nCw w 0 1 IC=0\n", p0, kDroop, 2 * kH) +
        fmt::format("Bth 0 th I={}*v(w)\nCth th 0 1 IC={}\n", w0, std::arg(emf)) +
        fmt::format("Be 0 e I={}*({} - {}*(v(qf) - {}) - v(vm) - v(back))\nCe e 0 1 IC={}\n", kVoltageKi, v_ref,
                    kVoltageDroop, q0, std::abs(emf)) +
        fmt::format("Bqf 0 qf I=(v(q) - v(qf))/{}\nCqf qf 0 1 IC={}\n", kFilterS, q0);
    Complex const measured = Complex{1, 0} * v_ref * std::conj(emf) / std::abs(emf); // bus A at angle 0
    out += fmt::format("Bmd 0 md I=(v(vd) - v(md))/1e-4\nCmd md 0 1 IC={}\nBmq 0 mq I=(v(vq) - v(mq))/1e-4\nCmq mq 0 1 "
                       "IC={}\n",
                       measured.real(), measured.imag());
    // Space vectors, p.u., in the frame of the internal voltage.
    out += fmt::format("Bphi phi 0 V={}*time + v(th)\n", w0);
    for (auto const& [name, a, b, c, base] :
         {std::tuple{"v", "v(ta)", "v(tb)", "v(tc)", kPeakV}, std::tuple{"i", "i(Vma)", "i(Vmb)", "i(Vmc)", kPeakA}}) {
        out += fmt::format("B{0}al {0}al 0 V=(2*{1} - {2} - {3})/3/{4}\nB{0}be {0}be 0 V=({2} - {3})/{5}/{4}\n", name,
                           a, b, c, base, std::numbers::sqrt3);
        out += fmt::format("B{0}d {0}d 0 V=v({0}al)*cos(v(phi)) + v({0}be)*sin(v(phi))\n"
                           "B{0}q {0}q 0 V=v({0}be)*cos(v(phi)) - v({0}al)*sin(v(phi))\n",
                           name);
    }
    out += "Bp p 0 V=v(vd)*v(id) + v(vq)*v(iq)\nBq q 0 V=v(vq)*v(id) - v(vd)*v(iq)\n"
           "Bvm vm 0 V=sqrt(v(vd)*v(vd) + v(vq)*v(vq))\nBim im 0 V=sqrt(v(id)*v(id) + v(iq)*v(iq) + 1e-12)\n";
    // The limit: k of the drive across the filter, and what takes down the excess.
    out +=
        fmt::format("Bdr dr 0 V=sqrt((v(e) - v(md))*(v(e) - v(md)) + v(mq)*v(mq) + 1e-12)\n"
                    "Bk k 0 V=min(1, {}/v(dr))\nBback back 0 V=(1 - v(k))*v(dr)\n"
                    "Bx x 0 V={}*max(0, v(im) - {})/v(im)\n"
                    "Bed ed 0 V=v(md) + v(k)*(v(e) - v(md)) - v(x)*v(id)\nBeq eq 0 V=v(mq) - v(k)*v(mq) - v(x)*v(iq)\n",
                    kLimit * std::hypot(kR, kX), kX / w0 / 2e-4, kLimit);
    double const load_ohm = kRatedV * kRatedV / (kLoadKw * 1e3), load_h = kRatedV * kRatedV / (kLoadKvar * 1e3) / w0;
    for (int n = 0; n < 3; ++n) {
        char const k = "abc"[n];
        auto const now = [&](Complex a) { return (a * std::polar(1.0, -n * third)).real(); };
        out += fmt::format("Bs{0} s{0} 0 V={1}*(v(ed)*cos(v(phi) - {2}) - v(eq)*sin(v(phi) - {2}))\n", k, kPeakV,
                           n * third);
        out += fmt::format("Rf{0} s{0} f{0} {1}\nLf{0} f{0} t{0} {2} IC={3}\nVm{0} t{0} m{0} 0\nRl{0} m{0} l{0} {4}\n"
                           "Ll{0} l{0} b{0} {5} IC={3}\nRd{0} b{0} 0 {6}\nLd{0} b{0} 0 {7} IC={8}\n",
                           k, kR * kBaseOhm, kX * kBaseOhm / w0, now(amperes), kLineOhm, kLineH, load_ohm, load_h,
                           now(load_amperes));
        out += fmt::format("Sx{0} b{0} x{0} ctl 0 sw OFF\n{1}", k,
                           event.empty() ? "" : fmt::format("Rx{0} x{0} 0 {1}\n", k, event));
    }
    return out + ".model sw SW(Ron=1e-6 Roff=1e9 Vt=0.5)\n";
}

class GridFormingJudged : public Ngspice {
  protected:
    void SetUp() override {
        Ngspice::SetUp();
        // The steady state, by hand: bus A at 1 p.u. and angle 0 feeds line and load.
        Complex const load = 1.0 / (Complex{kLoadKw, -kLoadKvar} * 1e3 / (kRatedV * kRatedV)), v = kPeakV;
        amperes_ = v / (load + Complex{kLineOhm, kOmega * kLineH});
        load_amperes_ = amperes_ * load / Complex{0, kRatedV * kRatedV / (kLoadKvar * 1e3)};
        Complex const i = amperes_ / kPeakA, s = v / kPeakV * std::conj(i);
        emf_ = v / kPeakV + Complex{kR, kX} * i;
        p0_ = s.real();
        q0_ = s.imag();
    }
    [[nodiscard]] std::string judge_of(std::string const& event, std::string const& control) const {
        return netlist(emf_, amperes_, load_amperes_, 1, p0_, q0_, event) + "Vctl ctl 0 " + control + "\n";
    }
    /// Largest differences over a run, of current (share of the largest), frequency (Hz) and internal voltage (p.u.).
    struct Apart {
        double current{0}, hz{0}, emf{0}, largest_a{0}, moved_hz{0};
    };
    Apart run(Table const& table, std::int64_t steps_per_s, double until_s,
              std::vector<std::pair<double, Action>> const& actions) {
        TimeBase const base{Rational{1, steps_per_s}};
        auto engine = make_emt_engine(island(), {base, SimSpan{1}, 0});
        EXPECT_TRUE(engine && (*engine)->initialise());
        Engine& sut = **engine;
        auto const read = [&](std::string const& name) { return sut.value(sut.find_signal(name)); };
        EXPECT_NEAR(read("battery.G.emf_pu"), std::abs(emf_), 1e-5);
        EXPECT_NEAR(read("battery.G.angle_deg"), std::arg(emf_) * 180 / std::numbers::pi, 1e-3);
        Apart out;
        std::size_t next = 0;
        for (std::int64_t n = 1; static_cast<double>(n) < until_s * static_cast<double>(steps_per_s); ++n) {
            double const before = static_cast<double>(n - 1) / static_cast<double>(steps_per_s);
            if (next < actions.size() && before >= actions[next].first - 1e-9) {
                EXPECT_TRUE(sut.apply(actions[next++].second).has_value());
            }
            EXPECT_TRUE(sut.advance(SimTime{} + SimSpan{n}).has_value());
            double const t = static_cast<double>(n) / static_cast<double>(steps_per_s);
            for (std::size_t k = 0; k < 3; ++k) {
                double const judge = at(table, 1 + k, t);
                out.largest_a = std::max(out.largest_a, std::abs(judge));
                out.current = std::max(out.current, std::abs(read(fmt::format("line.L.from.i.{}", "abc"[k])) - judge));
            }
            double const hz = kHz * (1 + at(table, 4, t));
            out.moved_hz = std::max(out.moved_hz, std::abs(hz - kHz));
            out.hz = std::max(out.hz, std::abs(read("battery.G.frequency_hz") - hz));
            out.emf = std::max(out.emf, std::abs(read("battery.G.emf_pu") - at(table, 5, t)));
        }
        EXPECT_EQ(next, actions.size());
        out.current /= out.largest_a;
        return out;
    }
    Complex amperes_, load_amperes_, emf_;
    double p0_{0}, q0_{0};
};

constexpr char const* kVectors = "i(Vma) i(Vmb) i(Vmc) v(w) v(e)";

TEST_F(GridFormingJudged, AgreesThroughAStepOfLoad) {
    double const ohm = kRatedV * kRatedV / (kMoreKw * 1e3);
    Table const table = judge(judge_of(fmt::format("{}", ohm), "PWL(0 0 50m 0 50.0001m 1)"), 0.4, kVectors, 5);
    Apart const apart = run(table, 48000, 0.4, {{0.05, SetParameter{"loads.D.p_kw", kLoadKw + kMoreKw}}});
    EXPECT_GT(apart.moved_hz, 0.4); // it answered the step
    EXPECT_LT(apart.hz, 2e-3);
    EXPECT_LT(apart.emf, 1e-4);
    EXPECT_LT(apart.current, 0.012); // in the steps after the switching
}

TEST_F(GridFormingJudged, AgreesThroughAFaultThatItsLimitHolds) {
    Table const table = judge(judge_of("0.05", "PWL(0 0 50m 0 50.0001m 1)"), 0.15, kVectors, 2);
    std::vector<std::pair<double, Action>> const fault{
        {0.05, ApplyFault{"", "B", 0, FaultType::three_phase_ground, 0.05, "f"}}};
    Apart const apart = run(table, 192000, 0.15, fault);
    EXPECT_GT(apart.largest_a, kLimit * kPeakA); // the first peak goes beyond
    EXPECT_GT(apart.moved_hz, 0.3);
    EXPECT_LT(apart.hz, 2e-3);
    EXPECT_LT(apart.emf, 1e-4);
    EXPECT_LT(apart.current, 0.02);
}

} // namespace
} // namespace gridspace::sim::emt
