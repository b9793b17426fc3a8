// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/number_specs.hpp"
#include "sim/components/faces/two_port.hpp"
#include "sim/components/transformer/tap_changer.hpp"

namespace gridspace::sim {

enum class Winding { wye_grounded, wye, delta };

/// Two-slope saturation. (Outside of its owner: clang cannot make an optional of a nested class with default values.)
struct TransformerSaturation {
    double knee_pu{1.2};         ///< flux linkage at the knee, p.u. of rated peak
    double air_core_percent{30}; ///< reactance above the knee, of the rating
};

/// Two-winding transformer: an ideal one at the `from` end of a pi [MATPOWER User's Manual, branch model]; leakage at
/// `to`, magnetising at `from`. By phase and in waveforms three limbs, with their connections wired as given.
struct Transformer final : TwoPort {
    static constexpr Quantity kSettable[] = {
        {"tap_ratio",
         elements::positive("off-nominal ratio at its `from` side; with waveforms not of one that saturates")}};
    static constexpr Kind kKind{.section = "transformers",
                                .doc = "two-winding transformers",
                                .word = "transformer",
                                .prefix = "transformer",
                                .commands = kInService,
                                .settable = kSettable};
    double rating_kva{0};
    double r_percent{0}, x_percent{0}; ///< of the rating, both windings together
    double tap_ratio{1};               ///< off-nominal ratio, on the `from` side
    double phase_shift_deg{0};         ///< `to` lags by it
    Winding from_winding{Winding::wye_grounded}, to_winding{Winding::wye_grounded};
    double magnetising_percent{0}; ///< magnetising current, of the rated current; 0: none
    double charging_percent{0};    ///< total shunt susceptance, half at each winding, of the rating
    using Saturation = TransformerSaturation;
    std::optional<Saturation> saturation;
    std::optional<TapChanger> tap_changer; ///< tap_ratio is then that of its position

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return saturation ? "the saturation of transformer" : "";
    }
    [[nodiscard]] Admittances admittances(Surroundings const& around, Ends closed) const override;
    [[nodiscard]] Admittances sequence(Sequence sequence, Surroundings const& around) const override;
    [[nodiscard]] EarthPaths earth_paths(Surroundings const& around, Ends closed) const override;
    Result<void> phases(PhaseNetworkFace& face, Surroundings const& around) const override;
    Result<void> circuit(emt::Circuit& circuit, emt::TwoPortParts& parts, Surroundings const& around) const override;
    bool set_in_circuit(emt::Circuit& circuit, emt::TwoPortParts const& parts, std::string_view quantity,
                        double value) override;
    bool set(std::string_view, double value) override {
        tap_ratio = value;
        return true;
    }
    [[nodiscard]] double value(std::string_view, Surroundings const&) const override { return tap_ratio; }

    /// Fails when its phase shift is not one that its windings can make.
    [[nodiscard]] Result<void> check_windings() const;
    /// In a delta, coil k goes from phase k to the next (true) or to the one before: `to` lags by 30 degrees when its
    /// delta goes forward, or when the delta of `from` goes backward.
    [[nodiscard]] bool from_forward() const { return both_delta() || phase_shift_deg <= 0; }
    [[nodiscard]] bool to_forward() const { return both_delta() || phase_shift_deg > 0; }

  private:
    [[nodiscard]] bool both_delta() const { return from_winding == Winding::delta && to_winding == Winding::delta; }
};

} // namespace gridspace::sim
