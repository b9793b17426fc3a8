// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

/// Loads, generators and photovoltaic systems: what consumes or gives power by phase.
namespace gridspace::opendss {
namespace {

/// kvar by kW; a negative power factor is that of vars in the other direction. 0: none.
double kvar_by_kw(double pf) {
    return std::copysign(pf == 0 ? 0 : std::sqrt(std::max(0.0, 1 / (pf * pf) - 1)), pf);
}

/// Two of kW, kvar, kVA and power factor, as OpenDSS keeps them: what was given last decides.
struct RatedPower {
    enum class Given { kw_pf, kw_kvar, kva_pf, kwh_pf } given{Given::kw_pf};
    double kw{10}, kvar{0}, kva{0}, pf{0.88};
    bool pf_given{false};
    double kwh{0}, kwh_days{30}, kwh_factor{4}; ///< of a bill: the mean power, times a factor for the peak

    /// At the end of a command: the other quantities follow.
    void settle() {
        if (given == Given::kw_kvar) {
            kva = std::hypot(kw, kvar);
            pf = kva > 0 ? std::abs(kw) / kva * (kw * kvar < 0 ? -1 : 1) : pf;
            return;
        }
        kw = given == Given::kva_pf   ? kva * std::abs(pf)
             : given == Given::kwh_pf ? kwh / (24 * kwh_days) * kwh_factor
                                      : kw;
        kvar = kw * kvar_by_kw(pf);
        kva = std::hypot(kw, kvar);
    }
    /// At an hour, kW and kvar. Of a shape of kW without kvar these follow from a power factor, if that was given.
    [[nodiscard]] Complex shaped(ShapeValue const& by) const {
        if (!by.actual) {
            return {kw * by.p, kvar * by.q};
        }
        return {by.p, by.q == 0 && pf_given ? by.p * kvar_by_kw(pf) : by.q};
    }
    Meaning meaning() {
        return {{"kw", [this](Value const& v) { kw = v.number(), given = Given::kw_pf; }},
                {"kvar", [this](Value const& v) { kvar = v.number(), given = Given::kw_kvar, pf_given = false; }},
                {"kva", [this](Value const& v) { kva = v.not_negative(), given = Given::kva_pf; }},
                {"pf", [this](Value const& v) {
                     pf = v.number();
                     pf_given = true;
                     if (!(std::abs(pf) <= 1) || pf == 0) {
                         v.wrong("is outside -1 to 1, or 0", "expected a power factor");
                         pf = 1;
                     }
                     given = given == Given::kw_kvar ? Given::kw_pf : given;
                 }}};
    }
};

/// The properties of a load's energy, of which each says that it counts.
void energy_meaning(RatedPower& power, Meaning& meaning) {
    auto const part = [&power](double RatedPower::* member) {
        return [&power, member](Value const& v) {
            power.*member = member == &RatedPower::kwh_days ? v.positive() : v.not_negative();
            power.given = RatedPower::Given::kwh_pf;
        };
    };
    meaning["kwh"] = part(&RatedPower::kwh);
    meaning["kwhdays"] = part(&RatedPower::kwh_days);
    meaning["cfactor"] = part(&RatedPower::kwh_factor);
}

/// Where a load lies, and its range of voltage.
struct Place {
    int phases{3};
    double kv{12.47};
    bool delta{false};
    double neutral_r{-1}, neutral_x{0};
    std::string bus, daily;
    config::SourceMark where, daily_where;

    void add_to(Meaning& meaning, LoadLaw& law) {
        meaning["phases"] = [this](Value const& v) { phases = v.integer(1, kMaxPhases); };
        meaning["bus1"] = [this](Value const& v) { bus = v.text(), where = v.where(); };
        meaning["kv"] = [this](Value const& v) { kv = v.positive(); };
        meaning["conn"] = [this](Value const& v) { delta = v.delta(); };
        meaning["vminpu"] = [&law](Value const& v) { law.least_pu = v.not_negative(); };
        meaning["vmaxpu"] = [&law](Value const& v) { law.most_pu = v.positive(); };
        meaning["daily"] = [this](Value const& v) { daily = v.text(), daily_where = v.where(); };
    }
    [[nodiscard]] double phase_v() const { return kv * 1e3 / (!delta && (phases == 2 || phases == 3) ? kSqrt3 : 1); }
    [[nodiscard]] int conductors() const { return delta && phases > 2 ? phases : phases + 1; }
};

/// What is wanted of a photovoltaic system's inverter, and its limits.
struct Inverter {
    double kva{500}, pf{1}, kvar{0};
    bool by_kvar{false}, watts_first{false}, pf_first{false};
    std::optional<double> most_kvar, most_absorbed_kvar; ///< without them its kVA

    void add_to(Meaning& meaning) {
        meaning["pf"] = [this](Value const& v) { pf = v.number(), by_kvar = false; };
        meaning["kvar"] = [this](Value const& v) { kvar = v.number(), by_kvar = true; };
        meaning["kva"] = [this](Value const& v) { kva = v.positive(); };
        meaning["kvarmax"] = [this](Value const& v) { most_kvar = std::abs(v.number()); };
        meaning["kvarmaxabs"] = [this](Value const& v) { most_absorbed_kvar = std::abs(v.number()); };
        meaning["wattpriority"] = [this](Value const& v) { watts_first = v.yes(); };
        meaning["pfpriority"] = [this](Value const& v) { pf_first = v.yes(); };
    }
    /// kW and kvar with so many kW of the panels. Above its rating it gives up watts, unless they or the power factor
    /// come first.
    [[nodiscard]] Complex output(double kw) const {
        double const wanted = by_kvar ? kvar : kw * kvar_by_kw(pf);
        double const most = most_kvar.value_or(kva);
        double const q = std::clamp(wanted, -most_absorbed_kvar.value_or(most), most);
        double const p = pf_first && wanted != 0 ? kw * (q / wanted) : kw;
        double const size = std::hypot(p, q);
        if (size <= kva) {
            return {p, q};
        }
        if (pf_first) {
            return Complex{p, q} * (kva / size);
        }
        if (!watts_first) {
            return {std::sqrt(std::max(0.0, kva * kva - q * q)), q};
        }
        return p > kva ? Complex{kva, 0} : Complex{p, std::copysign(std::sqrt(kva * kva - p * p), q)};
    }
};

} // namespace

void Builder::consume(Object const& object, std::vector<int> const& nodes, int phases, bool delta, LoadLaw const& law) {
    Consumer consumer{fmt::format("{}.{}", object.info->name, object.name), object.info->name != "load", {}, law};
    for (int k = 0; k < phases; ++k) {
        auto const at = static_cast<std::size_t>(k);
        bool const opened = object.open.contains({1, 0}) || object.open.contains({1, k + 1});
        if (!opened) {
            consumer.phases.emplace_back(nodes[at], delta ? nodes[(at + 1) % nodes.size()] : nodes.back());
        }
    }
    circuit_.consumers.push_back(std::move(consumer));
}

void Builder::load(Object const& object) {
    RatedPower power;
    LoadLaw law;
    Place place;
    place.where = object.where;
    bool fixed = false, exempt = false;
    double transformer_kva = 0, allocation = 0.5;
    bool allocated = false;
    Meaning meaning = power.meaning();
    energy_meaning(power, meaning);
    place.add_to(meaning, law);
    meaning["model"] = [&](Value const& v) { law.model = v.integer(1, 8); };
    meaning["vlowpu"] = [&](Value const& v) { law.low_pu = v.not_negative(); };
    meaning["cvrwatts"] = [&](Value const& v) { law.exponent_p = v.number(); };
    meaning["cvrvars"] = [&](Value const& v) { law.exponent_q = v.number(); };
    meaning["rneut"] = [&](Value const& v) { place.neutral_r = v.number(); };
    meaning["xneut"] = [&](Value const& v) { place.neutral_x = v.number(); };
    meaning["status"] = [&](Value const& v) {
        fixed = lower(v.text()).starts_with('f');
        exempt = lower(v.text()).starts_with('e');
    };
    meaning["zipv"] = [&](Value const& v) {
        std::vector<double> const shares = v.list();
        if (shares.size() != law.shares.size()) {
            v.wrong(fmt::format("has {} values", shares.size()), "expected 7: Z I P of kW, Z I P of kvar, dropout");
            return;
        }
        std::copy(shares.begin(), shares.end(), law.shares.begin());
    };
    meaning["xfkva"] = [&](Value const& v) { transformer_kva = v.not_negative(), allocated = true; };
    meaning["allocationfactor"] = [&](Value const& v) { allocation = v.not_negative(), allocated = true; };
    replay(object, meaning, diagnostics_, [&] {
        if (allocated && transformer_kva > 0) {
            power.kva = transformer_kva * allocation;
            power.given = RatedPower::Given::kva_pf;
            allocated = false;
        }
        power.settle();
    });
    if (place.bus.empty()) {
        error(object.where, fmt::format("load.{} has no bus1", object.name));
        return;
    }
    ShapeValue const at_hour = shape(place.daily, place.daily_where), by = fixed ? ShapeValue{} : at_hour;
    double const times = (fixed || exempt || by.actual ? 1 : load_multiplier_) * 1e3 / place.phases;
    law.nominal_v = place.phase_v();
    law.power_va = power.shaped(by) * times;
    law.fixed_var = power.kvar * 1e3 / place.phases;
    if (law.model == 8 && std::all_of(law.shares.begin(), law.shares.end(), [](double s) { return s == 0; })) {
        error(object.where, fmt::format("load.{} has model 8 and no ZIPV", object.name));
    }
    std::vector<int> const nodes = connect(place.bus, place.where, place.phases, place.conductors());
    if (!place.delta && place.neutral_r >= 0) {
        Complex const z{place.neutral_r, place.neutral_x};
        Object neutral{object.info, object.name + " neutral", object.where, {}, {}};
        add(neutral, {nodes.back()}, 1, Eigen::MatrixXcd::Constant(1, 1, z == Complex{} ? Complex{1e6} : 1.0 / z));
    }
    consume(object, nodes, place.phases, place.delta, law);
}

void Builder::generator(Object const& object) {
    RatedPower power;
    power.kw = 1000;
    LoadLaw law;
    law.least_pu = 0.9;
    law.most_pu = 1.1;
    law.low_pu = 0;
    Place place;
    place.where = object.where;
    int model = 1;
    bool fixed = false;
    Meaning meaning = power.meaning();
    meaning.erase("kva"); // the rating of the machine
    place.add_to(meaning, law);
    meaning["model"] = [&](Value const& v) { model = v.integer(1, 7); };
    meaning["status"] = [&](Value const& v) { fixed = lower(v.text()).starts_with('f'); };
    replay(object, meaning, diagnostics_, [&] { power.settle(); });
    if (place.bus.empty()) {
        error(object.where, fmt::format("generator.{} has no bus1", object.name));
        return;
    }
    if (model > 2) {
        circuit_.left_out.push_back(
            {object.where, fmt::format("model {} of generator.{}: it gives its kW and kvar", model, object.name),
             model != 4});
    }
    ShapeValue const at_hour = shape(place.daily, place.daily_where), by = fixed ? ShapeValue{} : at_hour;
    law.model = model == 2 ? 2 : 1;
    law.nominal_v = place.phase_v();
    law.power_va = (by.actual ? Complex{by.p, by.q} : power.shaped(by)) * (-1e3 / place.phases);
    std::vector<int> const nodes = connect(place.bus, place.where, place.phases, place.conductors());
    consume(object, nodes, place.phases, place.delta, law);
}

void Builder::photovoltaic(Object const& object) {
    LoadLaw law;
    law.least_pu = 0.9;
    law.most_pu = 1.1;
    law.low_pu = 0;
    Place place;
    place.where = object.where;
    double irradiance = 1, pmpp = 500, percent = 100;
    Inverter inverter;
    Meaning meaning;
    place.add_to(meaning, law);
    inverter.add_to(meaning);
    meaning["irradiance"] = [&](Value const& v) { irradiance = v.not_negative(); };
    meaning["pmpp"] = [&](Value const& v) { pmpp = v.not_negative(); };
    meaning["pctpmpp"] = [&](Value const& v) { percent = v.not_negative(); };
    for (char const* curve : {"effcurve", "p-tcurve"}) {
        meaning[curve] = [&, curve](Value const& v) {
            circuit_.left_out.push_back(
                {v.where(), fmt::format("{} of pvsystem.{}: taken as 1", curve, object.name), true});
        };
    }
    replay(object, meaning, diagnostics_);
    if (place.bus.empty()) {
        error(object.where, fmt::format("pvsystem.{} has no bus1", object.name));
        return;
    }
    double const shape_p = shape(place.daily, place.daily_where).p;
    double const kw = std::min(pmpp * irradiance * shape_p, pmpp * percent / 100);
    law.nominal_v = place.phase_v();
    law.power_va = -1e3 / place.phases * inverter.output(kw);
    std::vector<int> const nodes = connect(place.bus, place.where, place.phases, place.conductors());
    consume(object, nodes, place.phases, place.delta, law);
}

} // namespace gridspace::opendss
