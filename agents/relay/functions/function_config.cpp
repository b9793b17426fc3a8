// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/function_config.hpp"

#include "agents/relay/functions/breaker_failure.hpp"
#include "agents/relay/functions/direction.hpp"
#include "agents/relay/functions/distance.hpp"
#include "agents/relay/functions/frequency.hpp"
#include "agents/relay/functions/overcurrent.hpp"
#include "agents/relay/functions/reclosing.hpp"
#include "agents/relay/functions/synchrocheck.hpp"
#include "agents/relay/functions/voltage.hpp"
#include "common/elementary.hpp"
#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <numbers>

namespace gridspace::relay {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;
using config::Ref;

/// A function as it stands, in the order in which all are worked on.
struct Named {
    Ref name;
    NodeClass of{NodeClass::ptoc};
    Node const* settings{nullptr};
};

/// Reads the settings of one function after the other.
class Reader {
  public:
    Reader(FunctionContext const& context, std::vector<Named> const& all, Diagnostics& diagnostics)
        : context_{context}, all_{all}, diagnostics_{diagnostics} {}

    NamedFunction read(Named const& one) {
        reading_ = static_cast<std::size_t>(&one - all_.data());
        NamedFunction out{one.name.name, one.of, one.of < NodeClass::rsyn && one.of != NodeClass::rdir, nullptr, false};
        bool const measures = one.of == NodeClass::ptoc || one.of == NodeClass::pioc || one.of == NodeClass::pdis;
        config::read_fields(*one.settings, "functions." + one.name.name, diagnostics_, [&](Fields& f) {
            if (out.trips) {
                f.flag("trip", out.trips, {.doc = "operating, it trips the relay"});
            }
            if (measures) {
                f.flag("publish_values", out.publishes,
                       {.doc = "currents, or impedances of the loops that count, of each sample as signals"});
            }
            out.function = make(one.of, f);
        });
        return out;
    }

  private:
    std::unique_ptr<Function> make(NodeClass of, Fields& f) {
        switch (of) {
        case NodeClass::rdir:
            return rdir(f);
        case NodeClass::ptoc:
            return ptoc(f);
        case NodeClass::pioc:
            return pioc(f);
        case NodeClass::pdis:
            return pdis(f);
        case NodeClass::ptuv:
        case NodeClass::ptov:
            return voltage(f, of == NodeClass::ptov);
        case NodeClass::ptuf:
        case NodeClass::ptof:
        case NodeClass::pfrc:
            return frequency(f, of);
        case NodeClass::rsyn:
            return rsyn(f);
        case NodeClass::rbrf:
            return rbrf(f);
        case NodeClass::rrec:
            return rrec(f);
        }
        return nullptr;
    }

    static void seconds(Fields& f, std::string_view key, double& value_s, std::string_view doc, bool required = false) {
        double ms = value_s * 1e3;
        f.number(key, ms, {.doc = doc, .required = required, .min = 0, .max = 1e7});
        value_s = ms / 1e3;
    }

    std::optional<std::size_t> refer(Fields& f, std::string_view key, Ref const& ref, std::optional<NodeClass> of) {
        for (std::size_t i = 0; i < all_.size(); ++i) {
            if (all_[i].name == ref && (!of || all_[i].of == *of)) {
                return i;
            }
        }
        std::vector<std::string> names;
        for (Named const& n : all_) {
            if (!of || n.of == *of) {
                names.push_back(n.name.name);
            }
        }
        f.error(key,
                of ? fmt::format("there is no {} called '{}'", name_of(*of), ref.name)
                   : fmt::format("there is no function called '{}'", ref.name),
                spelling_hint(ref.name, names));
        return std::nullopt;
    }
    std::vector<std::size_t> initiators(Fields& f) {
        std::vector<Ref> refs;
        std::vector<std::size_t> out;
        f.references("initiated_by", refs, {.doc = "functions whose operation begins it; every trip when not given"});
        for (Ref const& ref : refs) {
            if (auto const i = refer(f, "initiated_by", ref, std::nullopt)) {
                out.push_back(*i);
            }
        }
        return out;
    }
    void direction(Fields& f, CurrentOf measures, Direction& out) {
        Ref of;
        f.reference("directional", of, {.doc = "an RDIR function; every direction when not given"});
        f.choice<bool>("direction", out.forward, {{"forward", true}, {"reverse", false}},
                       {.doc = "with `directional`: the direction that counts"});
        if (!of.empty()) {
            out.of = refer(f, "directional", of, NodeClass::rdir);
            bool const by_phase = out.of && std::ranges::find(by_phase_, *out.of) != by_phase_.end();
            if (by_phase && measures != CurrentOf::phases) {
                f.error("directional",
                        fmt::format("{} gives a direction to each phase, and this current is of none", of.name),
                        "`polarisation:` of a direction for such currents: zero_sequence, negative_sequence");
            }
        } else if (f.has("direction")) {
            f.error("direction", "a direction by which function?", "`directional: RDIR1`, and an RDIR1 of its own");
        }
    }
    static void current(Fields& f, CurrentOf& measures, double& pickup_a, double& dropout_ratio) {
        f.choice<CurrentOf>("measures", measures,
                            {{"phases", CurrentOf::phases},
                             {"residual", CurrentOf::residual},
                             {"negative_sequence", CurrentOf::negative_sequence}},
                            {.doc = "the currents that are compared; residual: 3 I0"});
        f.number("pickup_a", pickup_a, {.doc = "r.m.s., primary", .required = true, .above = 0});
        f.number("dropout_ratio", dropout_ratio,
                 {.doc = "it drops out below this times the pickup", .max = 1, .above = 0});
    }

    std::unique_ptr<Function> rdir(Fields& f) {
        RdirParams p;
        f.choice<Polarisation>("polarisation", p.polarisation,
                               {{"positive_sequence", Polarisation::positive_sequence},
                                {"cross", Polarisation::cross},
                                {"negative_sequence", Polarisation::negative_sequence},
                                {"zero_sequence", Polarisation::zero_sequence}},
                               {.doc = "the voltage that the current is compared with"});
        f.number("characteristic_angle_deg", p.characteristic_angle_deg,
                 {.doc = "by which the current of a forward fault lags", .min = -90, .max = 90});
        f.number("sector_deg", p.sector_deg, {.doc = "to both sides of it", .max = 90, .above = 0});
        f.number("minimum_a", p.minimum_a, {.doc = "current below which there is no direction", .min = 0});
        f.number("minimum_v", p.minimum_v, {.doc = "voltage below which there is none", .min = 0});
        if (p.polarisation == Polarisation::cross) {
            by_phase_.push_back(reading_);
        }
        return std::make_unique<Rdir>(p);
    }

    std::unique_ptr<Function> ptoc(Fields& f) {
        using Reset = PtocParams::Reset;
        PtocParams p;
        p.rate_hz = context_.rate_hz;
        current(f, p.measures, p.pickup_a, p.dropout_ratio);
        direction(f, p.measures, p.direction);
        f.choice<Curve>("curve", p.curve,
                        {{"definite_time", Curve::definite_time},
                         {"iec_normal_inverse", Curve::iec_normal_inverse},
                         {"iec_very_inverse", Curve::iec_very_inverse},
                         {"iec_extremely_inverse", Curve::iec_extremely_inverse},
                         {"ieee_moderately_inverse", Curve::ieee_moderately_inverse},
                         {"ieee_very_inverse", Curve::ieee_very_inverse},
                         {"ieee_extremely_inverse", Curve::ieee_extremely_inverse}},
                        {.doc = "IEC 60255-151, table A.1; IEEE C37.112, table 1"});
        bool const definite = p.curve == Curve::definite_time;
        f.number("time_multiplier", p.time_multiplier, {.doc = "of a curve", .max = 100, .above = 0});
        seconds(f, "delay_ms", p.delay_s, "definite_time: from the start to the operation");
        seconds(f, "minimum_ms", p.minimum_s, "of a curve: it operates no sooner");
        f.choice<Reset>("reset", p.reset,
                        {{"instantaneous", Reset::instantaneous},
                         {"definite_time", Reset::definite_time},
                         {"dependent", Reset::dependent}},
                        {.doc = "what becomes of the time that has run when the current falls"});
        seconds(f, "reset_ms", p.reset_s, "reset: definite_time");
        for (std::string_view const key : {"time_multiplier", "minimum_ms"}) {
            if (definite && f.has(key)) {
                f.error(key, "definite_time has no curve", "delay_ms is its time");
            }
        }
        if (!definite && f.has("delay_ms")) {
            f.error("delay_ms", "the time of a curve follows from the current", "time_multiplier, minimum_ms");
        }
        if (p.reset == Reset::dependent && !has_dependent_reset(p.curve)) {
            f.error("reset", "this curve has no dependent reset time", "the ieee_ curves have one");
        }
        return std::make_unique<Ptoc>(p);
    }

    std::unique_ptr<Function> pioc(Fields& f) {
        PiocParams p;
        p.rate_hz = context_.rate_hz;
        current(f, p.measures, p.pickup_a, p.dropout_ratio);
        direction(f, p.measures, p.direction);
        f.integer("confirm_samples", p.confirm_samples, {.doc = "samples in a row above it", .min = 1, .max = 1000});
        return std::make_unique<Pioc>(p);
    }

    std::unique_ptr<Function> pdis(Fields& f) {
        using Characteristic = PdisParams::Characteristic;
        PdisParams p;
        p.rate_hz = context_.rate_hz;
        p.confirm_s = 0.25 / context_.frequency_hz;
        f.choice<Characteristic>("characteristic", p.characteristic,
                                 {{"mho", Characteristic::mho}, {"quadrilateral", Characteristic::quadrilateral}},
                                 {.doc = "form of the zone"});
        f.choice<bool>("direction", p.forward, {{"forward", true}, {"reverse", false}}, {.doc = "where the zone lies"});
        f.number("reach_ohm", p.reach_ohm, {.doc = "positive sequence, primary", .required = true, .above = 0});
        f.number("angle_deg", p.angle_deg, {.doc = "of the line's impedance", .max = 90, .above = 10});
        p.r_ohm = p.r_earth_ohm = p.reach_ohm;
        f.number("r_ohm", p.r_ohm, {.doc = "quadrilateral: resistive reach; as the reach when not given", .above = 0});
        p.r_earth_ohm = f.has("r_ohm") ? p.r_ohm : p.r_earth_ohm;
        f.number("r_earth_ohm", p.r_earth_ohm, {.doc = "quadrilateral: of loops to earth", .above = 0});
        double k0 = 0, k0_deg = 0;
        f.number("k0", k0, {.doc = "magnitude of (Z0 - Z1) / (3 Z1) of the line", .min = 0, .max = 10});
        f.number("k0_deg", k0_deg, {.doc = "its angle", .min = -180, .max = 180});
        double const k0_angle = k0_deg * std::numbers::pi / 180;
        p.k0 = k0 * Complex{elementary::cos(k0_angle), elementary::sin(k0_angle)};
        f.number("minimum_a", p.minimum_a, {.doc = "current of a loop below which it does not count", .min = 0});
        f.number("minimum_residual_a", p.minimum_residual_a, {.doc = "3 I0 above which a fault is to earth", .min = 0});
        seconds(f, "delay_ms", p.delay_s, "from the start to the operation");
        seconds(f, "confirm_ms", p.confirm_s, "that a fault must be seen before it starts; a quarter of a cycle");
        if (p.characteristic == Characteristic::mho && (f.has("r_ohm") || f.has("r_earth_ohm"))) {
            f.error(f.has("r_ohm") ? "r_ohm" : "r_earth_ohm", "a mho has no resistive reach",
                    "characteristic: quadrilateral");
        }
        return std::make_unique<Pdis>(p);
    }

    std::unique_ptr<Function> voltage(Fields& f, bool over) {
        VoltageParams p;
        p.rate_hz = context_.rate_hz;
        p.over = over;
        f.choice<VoltageOf>("measures", p.measures,
                            {{"phase_to_earth", VoltageOf::phase_to_earth},
                             {"phase_to_phase", VoltageOf::phase_to_phase},
                             {"positive_sequence", VoltageOf::positive_sequence},
                             {"residual", VoltageOf::residual}},
                            {.doc = "the voltages that are compared; residual: 3 V0"});
        f.flag("all_phases", p.all_phases, {.doc = "only when all of them are beyond; otherwise one is enough"});
        f.number("pickup_v", p.pickup_v, {.doc = "r.m.s., primary", .required = true, .above = 0});
        f.number("dropout_ratio", p.dropout_ratio, {.doc = "of over; under: its inverse", .max = 1, .above = 0});
        f.choice<bool>("curve", p.inverse, {{"definite_time", false}, {"inverse", true}},
                       {.doc = "inverse: T / |1 - V / pickup|"});
        seconds(f, "delay_ms", p.delay_s, "definite_time: from the start to the operation");
        f.number("time_multiplier", p.time_multiplier, {.doc = "inverse: T, s", .above = 0});
        if (!over) {
            f.number("block_below_v", p.block_below_v, {.doc = "a line that is off is no undervoltage", .min = 0});
        }
        return std::make_unique<VoltageFunction>(p);
    }

    std::unique_ptr<Function> frequency(Fields& f, NodeClass of) {
        using Kind = FrequencyFunctionParams::Kind;
        FrequencyFunctionParams p;
        p.rate_hz = context_.rate_hz;
        p.kind = of == NodeClass::ptuf ? Kind::under : of == NodeClass::ptof ? Kind::over : Kind::rate;
        if (p.kind == Kind::rate) {
            f.number("pickup_hz_per_s", p.pickup_hz_per_s, {.doc = "negative: falling", .required = true});
        } else {
            f.number("pickup_hz", p.pickup_hz, {.doc = "frequency", .required = true, .above = 0});
        }
        seconds(f, "delay_ms", p.delay_s, "from the start to the operation");
        return std::make_unique<FrequencyFunction>(p);
    }

    std::unique_ptr<Function> rsyn(Fields& f) {
        RsynParams p;
        p.rate_hz = context_.rate_hz;
        p.nominal_hz = context_.frequency_hz;
        p.samples_per_cycle = context_.samples_per_cycle;
        f.number("live_v", p.live_v, {.doc = "to earth, above which a side is live", .required = true, .above = 0});
        f.number("dead_v", p.dead_v, {.doc = "below which it is dead", .required = true, .above = 0});
        f.number("difference_v", p.difference_v, {.doc = "of the magnitudes, at most", .required = true, .above = 0});
        f.number("difference_deg", p.difference_deg, {.doc = "of the angles", .max = 90, .above = 0});
        f.number("difference_hz", p.difference_hz, {.doc = "of the frequencies", .max = 5, .above = 0});
        f.flag("dead_line", p.dead_line, {.doc = "releases onto a dead line from a live bus"});
        f.flag("dead_bus", p.dead_bus, {.doc = "releases onto a dead bus from a live line"});
        seconds(f, "hold_ms", p.hold_s, "that the conditions must hold");
        return std::make_unique<Rsyn>(p);
    }

    std::unique_ptr<Function> rbrf(Fields& f) {
        RbrfParams p;
        p.rate_hz = context_.rate_hz;
        p.initiated_by = initiators(f);
        f.number("pickup_a", p.pickup_a, {.doc = "current of a closed pole", .required = true, .above = 0});
        seconds(f, "delay_ms", p.delay_s, "from the trip on");
        return std::make_unique<Rbrf>(std::move(p));
    }

    std::unique_ptr<Function> rrec(Fields& f) {
        RrecParams p;
        p.rate_hz = context_.rate_hz;
        p.initiated_by = initiators(f);
        std::vector<double> dead_ms{500};
        f.numbers("dead_times_ms", dead_ms, {.doc = "of each shot", .min = 0, .max = 1e7});
        p.dead_times_s.clear();
        for (double const ms : dead_ms) {
            p.dead_times_s.push_back(ms / 1e3);
        }
        Ref release;
        f.reference("synchrocheck", release, {.doc = "an RSYN function that has to release the closing"});
        if (!release.empty()) {
            p.synchrocheck = refer(f, "synchrocheck", release, NodeClass::rsyn);
        }
        seconds(f, "wait_release_ms", p.wait_release_s, "for it, then lockout");
        f.number("open_below_a", p.open_below_a,
                 {.doc = "the breaker is open when no pole carries more", .required = true, .above = 0});
        seconds(f, "wait_open_ms", p.wait_open_s, "after a trip, then lockout");
        seconds(f, "pulse_ms", p.pulse_s, "of the closing command");
        seconds(f, "reclaim_ms", p.reclaim_s, "without a trip, after which the shots begin anew");
        return std::make_unique<Rrec>(std::move(p));
    }

    FunctionContext const& context_;
    std::vector<Named> const& all_;
    Diagnostics& diagnostics_;
    std::size_t reading_{0};            ///< of all_
    std::vector<std::size_t> by_phase_; ///< RDIR functions that answer for each phase; they are read before the others
};

std::vector<Named> named_functions(Node const& functions, Diagnostics& diagnostics) {
    std::vector<Named> out;
    for (Node::Entry const& entry : functions.entries) {
        Named named{{entry.key, entry.where}, NodeClass::ptoc, &entry.value};
        if (class_in(entry.key, named.of)) {
            out.push_back(std::move(named));
        } else {
            diagnostics.error(entry.where, fmt::format("'{}' is not the name of a function", entry.key),
                              "a class of IEC 61850-7-4 and a number, with a prefix if you like: PTOC1, Z2PDIS1; "
                              "PTOC, PIOC, RDIR, PDIS, PTUV, PTOV, PTUF, PTOF, PFRC, RBRF, RREC, RSYN",
                              static_cast<int>(entry.key.size()));
        }
    }
    std::stable_sort(out.begin(), out.end(), [](Named const& a, Named const& b) { return a.of < b.of; });
    return out;
}

std::string names_of(std::uint8_t quantities) {
    std::vector<std::string> out;
    for (auto const& [bit, name] :
         {std::pair{kCurrents, "`currents`"}, {kVoltages, "`voltages`"}, {kBusVoltages, "`bus_voltages`"}}) {
        if ((quantities & bit) != 0) {
            out.emplace_back(name);
        }
    }
    return join(out, " and ");
}

/// Of what a function needs, what the relay has to be given.
std::uint8_t inputs_of(std::uint8_t needs) {
    bool const of_voltages = (needs & (kVoltages | kFrequency | kRocof | kPolarising)) != 0;
    return static_cast<std::uint8_t>((needs & (kCurrents | kBusVoltages)) | (of_voltages ? unsigned{kVoltages} : 0U));
}

} // namespace

std::optional<FunctionSet> make_functions(Node const& functions, FunctionContext const& context,
                                          Diagnostics& diagnostics) {
    if (!functions.is_map() || functions.entries.empty()) {
        diagnostics.error(functions.where, "`functions` names no function",
                          "a map from names to settings: {PTOC1: {pickup_a: 400, delay_ms: 300}}");
        return std::nullopt;
    }
    int const before = diagnostics.errors();
    std::vector<Named> const named = named_functions(functions, diagnostics);
    Reader reader{context, named, diagnostics};
    std::vector<NamedFunction> out;
    for (Named const& one : named) {
        out.push_back(reader.read(one));
        std::uint8_t const lacking =
            out.back().function == nullptr
                ? std::uint8_t{0}
                : static_cast<std::uint8_t>(inputs_of(out.back().function->needs()) & ~context.inputs);
        if (lacking != 0) {
            diagnostics.error(one.name.where, fmt::format("{} needs {}", one.name.name, names_of(lacking)),
                              "a stream of sampled values that the relay is given beside `functions`",
                              static_cast<int>(one.name.name.size()));
        }
    }
    return diagnostics.errors() > before ? std::nullopt : std::optional<FunctionSet>{FunctionSet{std::move(out)}};
}

std::optional<FunctionOutput> find_output(FunctionSet const& set, std::string_view text) {
    std::size_t const dot = text.find('.');
    if (dot == std::string_view::npos || (text.substr(dot) != ".op" && text.substr(dot) != ".str")) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < set.functions().size(); ++i) {
        if (set.functions()[i].name == text.substr(0, dot)) {
            return FunctionOutput{i, text.substr(dot) == ".op"};
        }
    }
    return std::nullopt;
}

} // namespace gridspace::relay
