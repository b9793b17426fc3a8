// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/components/elements.hpp"

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <string>
#include <string_view>
#include <unordered_map>
#include <vector>

/// The network as a user writes it: plain data in SI units of the file, no behaviour. Each engine converts what it
/// needs once, when it is built. The meaning of every parameter is in docs/reference/components.md.
namespace gridspace::sim {

/// A voltage phasor.
struct Polar {
    double v_pu{1}, angle_deg{0};
};

struct Bus : Element {
    double voltage_v{0}; ///< nominal, line to line, r.m.s.
    std::optional<double> diagram_x, diagram_y;
    /// Where a power flow begins, when the network came with a solution (MATPOWER's VM and VA).
    std::optional<Polar> start;
};

/// Ideal three-phase source behind an impedance.
struct Source : Element {
    Ref bus;
    double voltage_pu{1}, angle_deg{0};
    double r_ohm{0}, l_mh{0};
    std::optional<double> r0_ohm, l0_mh; ///< zero sequence; positive sequence values when not given
    struct Harmonic {
        std::int64_t order{1};
        double percent{0}, angle_deg{0};
    };
    std::vector<Harmonic> harmonics;
};

/// Parameters per km, positive and zero sequence.
struct LineType : Element {
    double r_ohm_per_km{0};
    std::optional<double> x_ohm_per_km, l_mh_per_km; ///< exactly one of the two
    double c_nf_per_km{0};
    std::optional<double> r0_ohm_per_km, x0_ohm_per_km, l0_mh_per_km, c0_nf_per_km;
    /// Lower triangle of the phase impedance matrix: aa, ab, bb, ac, bc, cc; empty: from the sequences. The sequence
    /// values are then those of the transposed line.
    std::vector<double> phase_r_ohm_per_km, phase_x_ohm_per_km;
};

enum class LineModel { pi, bergeron };

/// Three-phase line between two buses: total values, or a type and a length.
struct Line : Element {
    Ref from, to;
    Ref type;
    std::optional<double> length_km;
    std::optional<double> r_ohm, x_ohm, l_mh, c_nf;
    std::optional<double> r0_ohm, x0_ohm, l0_mh, c0_nf;
    LineModel model{LineModel::pi};
};

enum class Winding { wye_grounded, wye, delta };

/// Two-slope saturation. (Outside of its owner: clang cannot make an optional of a nested class with default values.)
struct TransformerSaturation {
    double knee_pu{1.2};         ///< flux linkage at the knee, p.u. of rated peak
    double air_core_percent{30}; ///< reactance above the knee, of the rating
};

/// Two-winding transformer.
struct Transformer : Element {
    Ref from, to;
    double rating_kva{0};
    double r_percent{0}, x_percent{0}; ///< of the rating, both windings together
    double tap_ratio{1};               ///< off-nominal ratio, on the `from` side
    double phase_shift_deg{0};         ///< `to` lags by it
    Winding from_winding{Winding::wye_grounded}, to_winding{Winding::wye_grounded};
    double magnetising_percent{0}; ///< magnetising current, of the rated current; 0: none
    double charging_percent{0};    ///< total shunt susceptance, half at each winding, of the rating
    using Saturation = TransformerSaturation;
    std::optional<Saturation> saturation;
};

enum class LineEnd { from, to };

struct BreakerType : Element {
    double mechanism_ms{0};
    enum class Opens { each_pole_at_current_zero, at_once } opens{Opens::each_pole_at_current_zero};
    double chop_a{0};   ///< a pole that opens interrupts a current below
    bool latched{true}; ///< a false trip signal never closes it
};

/// Three-pole breaker at one end of a line.
struct Breaker : Element {
    Ref line;
    LineEnd end{LineEnd::from};
    Ref type;
    bool closed{true};
};

enum class InstrumentFilter { none, butterworth2 };

/// Two-slope core of a current transformer and what it drives, seen from its secondary.
struct CtSaturation {
    double knee_v{0};         ///< r.m.s. secondary voltage at base frequency at which the core leaves its first slope
    double magnetising_ma{0}; ///< r.m.s. secondary current there
    double winding_ohm{0}, burden_ohm{0};
    double air_core_mh{0};       ///< inductance beyond the knee
    double remanence_percent{0}; ///< of the flux at the knee, at the start, in every phase
};

struct CtType : Element {
    std::string ratio{"1:1"};
    double primary_a{1}, secondary_a{1}; ///< of the ratio
    double error_percent{0};
    InstrumentFilter filter{InstrumentFilter::none};
    double cutoff_hz{0};  ///< of the filter
    double quantum_ma{0}; ///< values are rounded to whole quanta; 0: not
    std::optional<CtSaturation> saturation;
};

/// Two-slope core of a voltage transformer, seen from its primary.
struct VtSaturation {
    double knee_pu{1.9};      ///< flux linkage at the knee, of that of nominal voltage
    double magnetising_ma{0}; ///< r.m.s. primary current there
    double winding_ohm{0};    ///< of the primary
    double air_core_mh{0};    ///< inductance beyond the knee
};

struct VtType : Element {
    std::string ratio{"1:1"};
    double primary_v{1}, secondary_v{1};
    double error_percent{0};
    InstrumentFilter filter{InstrumentFilter::none};
    double cutoff_hz{0};
    double quantum_mv{0}; ///< primary values are rounded to whole quanta; 0: not
    std::optional<VtSaturation> saturation;
};

/// Voltage transformers of the three phases, phase to earth, at a bus.
struct Vt : Element {
    Ref bus;
    Ref type;
};

enum class CtPolarity { from_to, into_line };

/// Current transformers of the three phases, on the line side of the breaker.
struct Ct : Element {
    Ref line;
    LineEnd end{LineEnd::from};
    Ref type;
    CtPolarity positive{CtPolarity::from_to};
};

struct Avr {
    double ka{0}, ta_s{0}, tr_s{0};
    double efd_min_pu{0}, efd_max_pu{0};
};

struct Governor {
    double droop_percent{4};
    double tg_s{0}, tt_s{0};
    double integral_ki{0};
};

/// `full`: one field winding and one damper per axis. `classical`: constant voltage behind xd1.
enum class MachineModel { full, classical };

/// Synchronous machine constants, p.u. on the machine's own rating.
struct MachineType : Element {
    MachineModel model{MachineModel::full};
    struct Constants {
        double xd{0}, xq{0}, xd1{0}, xd2{0}, xq2{0}, xl{0}, x0{0}, ra{0};
    } pu;
    double td01_s{0}, td02_s{0}, tq02_s{0};
    double inertia_h_s{0};
    double damping_pu{0};
    std::optional<Avr> avr;
    std::optional<Governor> governor;
};

struct Machine : Element {
    Ref bus;
    Ref type;
    double rating_kva{0};
    double p_kw{0};
    double voltage_setpoint_pu{1};
    std::optional<double> inertia_h_s; ///< overrides the type's
    std::optional<Governor> governor;  ///< overrides the type's
};

enum class GeneratorRole { slack, pv, pq };

/// Generator without dynamics of its own: holds voltage and power, or powers (power flow, quasi-static runs).
struct Generator : Element {
    Ref bus;
    double rating_kva{0};
    GeneratorRole role{GeneratorRole::pv};
    double voltage_setpoint_pu{1}, angle_deg{0};
    double p_kw{0}, q_kvar{0};
    std::optional<double> q_min_kvar, q_max_kvar;
};

struct ProfileHalfSine {
    double rise_h{6}, set_h{18}, exponent{1};
};

struct Profile : Element {
    enum class Time { since_start, hour_of_day } time{Time::since_start};
    std::vector<double> hours, values; ///< linear between points, constant outside
    using HalfSine = ProfileHalfSine;
    std::optional<HalfSine> half_sine;
    struct Cloud {
        double at_h{12}, depth_percent{0}, width_h{0.1};
    };
    std::vector<Cloud> clouds;
};

struct Network : OnePorts {
    std::string name;
    double frequency_hz{60};
    double power_kva{100}; ///< base power
    std::vector<Bus> buses;
    std::vector<Source> sources;
    std::vector<LineType> line_types;
    std::vector<Line> lines;
    std::vector<Transformer> transformers;
    std::vector<BreakerType> breaker_types;
    std::vector<Breaker> breakers;
    std::vector<CtType> ct_types;
    std::vector<Ct> cts;
    std::vector<VtType> vt_types;
    std::vector<Vt> vts;
    std::vector<MachineType> machine_types;
    std::vector<Machine> machines;
    std::vector<Generator> generators;
    std::vector<Profile> profiles;
    config::SourceMark where; ///< the file
};

/// The element of that name; nullptr when there is none.
template <class T>
[[nodiscard]] T const* find(std::vector<T> const& elements, std::string_view name) {
    for (T const& element : elements) {
        if (element.name.name == name) {
            return &element;
        }
    }
    return nullptr;
}

template <class T>
[[nodiscard]] std::size_t index_of(std::vector<T> const& elements, std::string_view name) {
    T const* found = find(elements, name);
    return found == nullptr ? elements.size() : static_cast<std::size_t>(found - elements.data());
}

/// The positions of elements by their names, for who asks often: index_of reads the list each time. The elements must
/// outlive it.
class NameIndex {
  public:
    template <class T>
    explicit NameIndex(std::vector<T> const& elements) {
        for (std::size_t i = 0; i < elements.size(); ++i) {
            at_.try_emplace(elements[i].name.name, i);
        }
    }
    /// The number of elements when there is none of that name.
    [[nodiscard]] std::size_t operator[](std::string_view name) const {
        auto const it = at_.find(name);
        return it == at_.end() ? at_.size() : it->second;
    }

  private:
    std::unordered_map<std::string_view, std::size_t> at_;
};

/// A line's totals, whichever way it was written.
struct LineTotals {
    double r_ohm{0}, l_h{0}, c_f{0};
    double r0_ohm{0}, l0_h{0}, c0_f{0};
};
[[nodiscard]] LineTotals line_totals(Network const& network, Line const& line);

/// The value of a profile at a simulated time (hours since start) when simulated time 0 is `start_hour_of_day`.
[[nodiscard]] double profile_value(Profile const& profile, double hours_since_start, double start_hour_of_day);

/// The same as a function of simulated seconds; 1 when the network has none of that name.
[[nodiscard]] Scale scale_of(Network const& network, Ref const& profile, double start_hour_of_day);

} // namespace gridspace::sim
