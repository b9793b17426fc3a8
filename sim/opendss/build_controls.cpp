// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include "sim/opendss/dss_numbers.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

/// Regulators and controls of capacitors.
namespace gridspace::opendss {
namespace {

/// A phase by its number, or max, min, avg.
void read_phase(Value const& v, Watched& watched, int& phase) {
    std::string const word = lower(v.text());
    watched = word.starts_with("max")   ? Watched::largest
              : word.starts_with("min") ? Watched::smallest
              : word.starts_with("avg") ? Watched::mean
                                        : Watched::one;
    if (watched == Watched::one) {
        phase = v.integer(1, kMaxPhases) - 1;
    }
}

/// What a capacitor's control goes by: one word, of which the first letter counts.
void read_kind(Value const& v, CapacitorControl& c) {
    using Kind = CapacitorControl::Kind;
    static constexpr std::pair<char, Kind> kKinds[] = {
        {'c', Kind::current}, {'v', Kind::voltage}, {'k', Kind::kvar}, {'p', Kind::power_factor}, {'t', Kind::time}};
    std::string const word = lower(v.text());
    auto const known =
        std::find_if(std::begin(kKinds), std::end(kKinds), [&](auto const& k) { return word.starts_with(k.first); });
    if (known == std::end(kKinds)) {
        v.wrong(fmt::format("is '{}'", v.text()), "expected current, voltage, kvar, pf or time");
        return;
    }
    c.kind = known->second;
    CapacitorControl const usual;
    c.pf_on = usual.pf_on; // what was set before was no power factor
    c.pf_off = usual.pf_off;
}

/// A setting; of a control by power factor -1 to 1, where leading ones are negative.
void read_setting(Value const& v, CapacitorControl const& c, double& setting, double& pf) {
    double const given = v.number();
    if (c.kind != CapacitorControl::Kind::power_factor) {
        setting = given;
    } else if (std::abs(given) <= 1) {
        pf = given < 0 ? 2 + given : given;
    } else {
        v.wrong(fmt::format("is {}", given), "expected a power factor from -1 to 1: leading ones are negative");
    }
}

} // namespace

void Builder::regulator(Object const& object) {
    Regulator r;
    r.name = fmt::format("regcontrol.{}", object.name);
    int winding = 1, tap_winding = 0, position = 0;
    bool remote_ratio = false, at_position = false;
    std::string transformer, bus;
    config::SourceMark where = object.where, bus_where = object.where;
    auto const into = [](double& number) { return [&number](Value const& v) { number = v.number(); }; };
    replay(object,
           {{"transformer", [&](Value const& v) { transformer = lower(v.text()), where = v.where(); }},
            {"winding", [&](Value const& v) { winding = v.integer(1, 20), tap_winding = 0; }},
            {"tapwinding", [&](Value const& v) { tap_winding = v.integer(1, 20); }},
            {"vreg", [&](Value const& v) { r.setpoint_v = v.positive(); }},
            {"band", [&](Value const& v) { r.band_v = v.positive(); }},
            {"ptratio", [&](Value const& v) { r.pt_ratio = v.positive(); }},
            {"ctprim", [&](Value const& v) { r.ct_primary_a = v.positive(); }},
            {"r", into(r.r_v)},
            {"x", into(r.x_v)},
            {"bus", [&](Value const& v) { bus = v.text(), bus_where = v.where(); }},
            {"delay", [&](Value const& v) { r.delay_s = v.not_negative(); }},
            {"inversetime", [&](Value const& v) { r.inverse_time = v.yes(); }},
            {"maxtapchange", [&](Value const& v) { r.most_steps = v.integer(0, 10000); }},
            {"vlimit", [&](Value const& v) { r.limit_v = v.not_negative(); }},
            {"ptphase", [&](Value const& v) { read_phase(v, r.watched, r.phase); }},
            {"remoteptratio", [&](Value const& v) { r.remote_ratio = v.positive(), remote_ratio = true; }},
            {"tapnum", [&](Value const& v) { position = v.integer(-10000, 10000), at_position = true; }},
            {"reversible",
             [&](Value const& v) {
                 if (v.yes()) {
                     circuit_.left_out.push_back({v.where(), fmt::format("the reverse settings of {}", r.name), false});
                 }
             }}},
           diagnostics_);
    auto const element = circuit_.find_element("transformer." + transformer);
    if (!element) {
        Object const* disabled = script_.find("transformer", transformer);
        if (disabled == nullptr) {
            error(where, fmt::format("{}: there is no transformer '{}'", r.name, transformer));
        }
        return;
    }
    Transformer& t = circuit_.transformers.at(*element);
    tap_winding = tap_winding == 0 ? winding : tap_winding;
    auto const count = static_cast<int>(t.windings.size());
    if (winding > count || tap_winding > count || r.phase >= t.phases) {
        error(object.where,
              fmt::format("{}: transformer '{}' has {} windings and {} phases", r.name, transformer, count, t.phases));
        return;
    }
    r.element = *element;
    r.winding = static_cast<std::size_t>(winding) - 1;
    r.tap_winding = static_cast<std::size_t>(tap_winding) - 1;
    r.remote_ratio = remote_ratio ? r.remote_ratio : r.pt_ratio;
    if (!bus.empty()) {
        r.remote = connect(bus, bus_where, t.phases, t.phases);
    }
    if (at_position) {
        WindingData& w = t.windings[r.tap_winding];
        w.tap = (w.least_tap + w.most_tap) / 2 + position * w.step();
        circuit_.elements[*element].y = t.admittance();
    }
    circuit_.regulators.push_back(std::move(r));
}

void Builder::capacitor_control(Object const& object) {
    CapacitorControl c;
    c.name = fmt::format("capcontrol.{}", object.name);
    std::string capacitor, element;
    int terminal = 1;
    double least_percent = 50;
    std::optional<config::SourceMark> override_bus;
    auto const into = [](double& number) { return [&number](Value const& v) { number = v.number(); }; };
    replay(object,
           {{"element", [&](Value const& v) { element = lower(v.text()); }},
            {"capacitor", [&](Value const& v) { capacitor = lower(v.text()); }},
            {"terminal", [&](Value const& v) { terminal = v.integer(1, 20); }},
            {"type", [&](Value const& v) { read_kind(v, c); }},
            {"ptratio", [&](Value const& v) { c.pt_ratio = v.positive(); }},
            {"ctratio", [&](Value const& v) { c.ct_ratio = v.positive(); }},
            {"onsetting", [&](Value const& v) { read_setting(v, c, c.on, c.pf_on); }},
            {"offsetting", [&](Value const& v) { read_setting(v, c, c.off, c.pf_off); }},
            {"pctminkvar", into(least_percent)},
            {"vbus", [&](Value const& v) { override_bus = v.where(); }},
            {"voltoverride", [&](Value const& v) { c.voltage_overrides = v.yes(); }},
            {"vmax", into(c.most_v)},
            {"vmin", into(c.least_v)},
            {"delay", into(c.delay_s)},
            {"delayoff", into(c.delay_off_s)},
            {"ctphase", [&](Value const& v) { read_phase(v, c.of_currents, c.current_phase); }},
            {"ptphase", [&](Value const& v) { read_phase(v, c.of_voltages, c.voltage_phase); }}},
           diagnostics_);
    auto const bank = circuit_.find_element("capacitor." + capacitor);
    auto const monitored = circuit_.find_element(element);
    if (!bank || !monitored) {
        error(object.where, bank ? fmt::format("{}: there is no element '{}'", c.name, element)
                                 : fmt::format("{}: there is no capacitor '{}'", c.name, capacitor));
        return;
    }
    Element const& e = circuit_.elements[*monitored];
    int const phase = std::max(c.voltage_phase, c.current_phase);
    if (std::cmp_greater(std::int64_t{terminal} * e.conductors, e.nodes.size()) || phase >= e.conductors) {
        error(object.where, fmt::format("{}: {} has no terminal {}, phase {}", c.name, element, terminal, phase + 1));
        return;
    }
    if (override_bus && c.voltage_overrides) {
        circuit_.left_out.push_back(
            {*override_bus, fmt::format("Vbus of {}: its own terminal overrides", c.name), true});
    }
    if (c.kind == CapacitorControl::Kind::time && !hour_) {
        circuit_.left_out.push_back({object.where, fmt::format("{} goes by the time of day", c.name), true});
        return;
    }
    Element const& switched = circuit_.elements[*bank];
    c.between_phases = std::cmp_equal(switched.nodes.size(), switched.conductors); // a star has an other end
    c.least_kvar = least_percent / 100 * bank_kvar_[*bank];
    c.capacitor = *bank;
    c.monitored = *monitored;
    c.terminal = terminal - 1;
    circuit_.capacitor_controls.push_back(std::move(c));
}

} // namespace gridspace::opendss
