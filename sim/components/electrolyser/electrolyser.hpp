// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/electrolyser/stack.hpp"
#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/one_port.hpp"

#include <cstdint>

namespace gridspace::sim {

/// An electrolyser behind a rectifier, as a load that can be controlled. It follows the power that it is asked for
/// along ramps, within its rated power; below its minimum load it stands by: what hydrogen passes into the oxygen would
/// become dangerous. States: power of the rectifier, as a share of its rated power; hydrogen.
struct Electrolyser final : OnePort {
    static constexpr Quantity kSettable[] = {
        {"p_kw", elements::not_negative("power that it is asked to draw; below its minimum load it stands by")}};
    static constexpr Kind kKind{.section = "electrolysers",
                                .doc = "electrolysers behind rectifiers",
                                .word = "electrolyser",
                                .prefix = "electrolyser",
                                .commands = kConverter,
                                .settable = kSettable};
    double rated_kw{0}, p_kw{0}; ///< drawn from the network
    double efficiency{0.95};     ///< of the rectifier
    double power_factor{1};      ///< of the rectifier, lagging
    double min_load_percent{20}; ///< of rated_kw
    double standby_kw{0};
    double ramp_up_s{5}, ramp_down_s{5}; ///< from nothing to the rated power, and back
    std::int64_t cells{21};
    Stack stack;
    Ref scale; ///< profile that multiplies p

    /// What it aims at, as a share of its rated power, at a value of its profile.
    [[nodiscard]] double target(double times) const;
    /// What it draws, kVA, while its rectifier is at this share of rated power.
    [[nodiscard]] Complex drawn_kva(double share, bool stands_by) const;
    [[nodiscard]] double rating_kva() const { return rated_kw / power_factor; }
    /// What a bus of voltage v (p.u.) lets through of what it wants to draw, 0 to 1.
    [[nodiscard]] double let_through(Complex wanted_kva, double v) const;
    /// Current of the stack at this share of rated power.
    [[nodiscard]] double current_a(double share) const { return stack.current_a(1e3 * efficiency * rated_kw * share); }

    /// Signals other than its powers, and their values.
    [[nodiscard]] static std::vector<SignalDef> signals();
    [[nodiscard]] double signal(std::size_t index, double share, double hydrogen_g) const;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override { check.profile(scale); }
    [[nodiscard]] bool earthed(Surroundings const&) const override { return true; } // its filter
    void power_flow(PowerFlowFace& face) const override;
    [[nodiscard]] std::unique_ptr<PhasorInjection> phasor(Surroundings const& around) const override;
    void circuit(CircuitFace& face) const override;
    bool set(std::string_view, double value) override {
        p_kw = value;
        return true;
    }
    [[nodiscard]] double value(std::string_view, Surroundings const&) const override { return p_kw; }
};

} // namespace gridspace::sim
