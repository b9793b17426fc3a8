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

} // namespace gridspace::sim
