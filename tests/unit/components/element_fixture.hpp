// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/yaml.hpp"
#include "sim/emt/emt_engine.hpp"
#include "sim/network/network_config.hpp"
#include "sim/phasor/phasor_engine.hpp"

#include <cmath>
#include <gtest/gtest.h>

/// What the tests of elements share: a network in words, an engine with it, a signal by its name.
namespace gridspace::sim {

/// What is wrong with the network in `text`; `out` is it when there are no errors.
inline config::Diagnostics read_text(std::string const& text, Network& out) {
    config::Diagnostics diagnostics;
    auto const root = config::parse_yaml(text, config::make_source("n.yaml", text), diagnostics);
    if (auto network = read_network(*root, diagnostics)) {
        out = *network;
    }
    return diagnostics;
}

inline void must(Result<void> const& done) {
    ASSERT_TRUE(done.has_value()) << describe(done.error());
}

/// `solver`: "emt" or "phasor"; `step`: of waveforms, in quanta of `base`.
inline std::unique_ptr<Engine> make(std::string const& solver, Network const& n, TimeBase const& base,
                                    SimSpan step = SimSpan{1}) {
    auto made =
        solver == "emt" ? emt::make_emt_engine(n, {base, step, 0}) : phasor::make_phasor_engine(n, {.time_base = base});
    EXPECT_TRUE(made.has_value()) << (made ? "" : describe(made.error()));
    return std::move(*made);
}

inline double read(Engine const& engine, std::string const& name) {
    std::size_t const i = engine.find_signal(name);
    EXPECT_LT(i, engine.signals().size()) << name;
    return i < engine.signals().size() ? engine.value(i) : std::nan("");
}

/// A bus behind a short line, one element on it, and a run that goes by seconds: "phasor", "fixed" (steps of 5 ms) or
/// "emt".
class AtOneBus {
  public:
    /// `element`: "section: {Name: {bus: A, keys...}}"; `more`: further sections.
    static std::string text_with(std::string const& element, std::string const& more = "") {
        return "gridspace_network: 1\nname: t\nbase: {frequency_hz: 50, power_kva: 100}\n"
               "buses: {A: {voltage_v: 400}}\nsources: {S: {bus: A, r_ohm: 0.01, l_mh: 0.05}}\n"
               "loads: {D: {bus: A, p_kw: 1, model: constant_impedance}}\n" +
               element + "\n" + more;
    }
    static Network network_with(std::string const& element, std::string const& more = "") {
        Network n;
        auto const diagnostics = read_text(text_with(element, more), n);
        EXPECT_EQ(diagnostics.errors(), 0) << diagnostics.render();
        return n;
    }
    AtOneBus(std::string const& solver, Network const& n) : base_{Rational{1, solver == "emt" ? 16000 : 1000}} {
        if (solver == "fixed") {
            auto made = phasor::make_phasor_engine(n, {.time_base = base_, .fixed_step_s = 0.005});
            EXPECT_TRUE(made.has_value());
            engine_ = std::move(*made);
        } else {
            engine_ = make(solver, n, base_);
        }
        must(engine_->initialise());
    }
    void run_to(double t_s) {
        auto const end = static_cast<std::int64_t>(std::lround(t_s * static_cast<double>(base_.quantum_s().den())));
        for (; now_ < end; ++now_) {
            must(engine_->advance(SimTime{now_ + 1}));
        }
    }
    Engine& engine() const { return *engine_; }

  private:
    TimeBase base_;
    std::unique_ptr<Engine> engine_;
    std::int64_t now_{0};
};

} // namespace gridspace::sim
