// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/faces/two_port.hpp"
#include "sim/components/line/frequency_table.hpp"
#include "sim/components/line/tower.hpp"

namespace gridspace::sim {

/// Parameters per km, positive and zero sequence.
struct LineType final : Element {
    static constexpr Kind kKind{.section = "line_types", .doc = "line data per km", .word = "line type"};
    double r_ohm_per_km{0};
    std::optional<double> x_ohm_per_km, l_mh_per_km; ///< exactly one of the two
    double c_nf_per_km{0};
    std::optional<double> r0_ohm_per_km, x0_ohm_per_km, l0_mh_per_km, c0_nf_per_km;
    /// Lower triangle of the phase impedance matrix: aa, ab, bb, ac, bc, cc; empty: from the sequences. The sequence
    /// values are then those of the transposed line.
    std::vector<double> phase_r_ohm_per_km, phase_x_ohm_per_km;

    /// Instead of all of them, or of all but the capacitances. Sequence values are then those at the nominal frequency.
    Tower tower;
    FrequencyTable table;

    [[nodiscard]] bool by_frequency() const { return tower.given() || table.given(); }
    [[nodiscard]] SequencesPerMetre per_metre(double omega) const; ///< when by_frequency()
    /// What makes it no line by frequency.
    [[nodiscard]] std::string mistake() const;
    [[nodiscard]] bool by_phase() const { return !phase_r_ohm_per_km.empty(); }
    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return by_phase() ? "unequal phases: they transpose the lines of type" : "";
    }
};

enum class LineModel { pi, bergeron, frequency_dependent };

/// A line's totals, whichever way it was written.
struct LineTotals {
    double r_ohm{0}, l_h{0}, c_f{0};
    double r0_ohm{0}, l0_h{0}, c0_f{0};
};

/// Three-phase line between two buses: total values, or a type and a length. A pi, or travelling waves in waveforms.
struct Line final : TwoPort {
    static constexpr Kind kKind{
        .section = "lines", .doc = "lines", .word = "line", .prefix = "line", .commands = kInService};
    Ref type;
    std::optional<double> length_km;
    std::optional<double> r_ohm, x_ohm, l_mh, c_nf;
    std::optional<double> r0_ohm, x0_ohm, l0_mh, c0_nf;
    LineModel model{LineModel::pi};
    std::vector<double> fault_places_percent; ///< where a fault can lie inside a frequency-dependent line

    [[nodiscard]] LineTotals totals(Surroundings const& around) const;

    [[nodiscard]] Kind const& kind() const override { return kKind; }
    void fields(config::Fields& f) override;
    void check(ElementCheck& check) const override;
    [[nodiscard]] std::string_view unseen_by_phasors() const override {
        return model != LineModel::pi ? "the travelling waves of line" : "";
    }
    [[nodiscard]] bool unbalanced(Surroundings const& around) const override;
    [[nodiscard]] Admittances admittances(Surroundings const& around, Ends closed) const override;
    [[nodiscard]] std::optional<Pi> pi(Surroundings const& around) const override;
    [[nodiscard]] EarthPaths earth_paths(Surroundings const& around, Ends closed) const override;
    Result<void> phases(PhaseNetworkFace& face, Surroundings const& around) const override;
    [[nodiscard]] std::optional<Refusal> refuses_fault(double percent) const override;
    Result<void> circuit(emt::Circuit& circuit, emt::TwoPortParts& parts, Surroundings const& around) const override;
};

} // namespace gridspace::sim
