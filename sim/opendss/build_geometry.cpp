// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/builder.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <optional>

/// Overhead lines by their conductors: WireData, LineSpacing, LineGeometry.
namespace gridspace::opendss {
namespace {

/// A conductor whose place is still to come.
std::optional<Conductor> read_wire(Script const& script, std::string const& name, config::SourceMark const& where,
                                   config::Diagnostics& diagnostics) {
    Object const* wire = script.find("wiredata", lower(name));
    if (wire == nullptr) {
        diagnostics.error(where, fmt::format("there is no wiredata '{}'", name), "expected bare conductors: WireData");
        return std::nullopt;
    }
    double dc = -1, ac = -1, gmr = -1, radius = -1, r_unit = 0, gmr_unit = 0, radius_unit = 0;
    replay(*wire,
           {{"rdc", [&](Value const& v) { dc = v.positive(); }},
            {"rac", [&](Value const& v) { ac = v.positive(); }},
            {"runits", [&](Value const& v) { r_unit = metres(v); }},
            {"gmrac", [&](Value const& v) { gmr = v.positive(); }},
            {"gmrunits", [&](Value const& v) { gmr_unit = metres(v); }},
            {"radius", [&](Value const& v) { radius = v.positive(); }},
            {"diam", [&](Value const& v) { radius = v.positive() / 2; }},
            {"radunits", [&](Value const& v) { radius_unit = metres(v); }}},
           diagnostics);
    auto const scale = [](double unit, double other) { return unit > 0 ? unit : other > 0 ? other : 1; };
    Conductor out;
    out.gmr_m = gmr * scale(gmr_unit, radius_unit);
    out.radius_m = radius * scale(radius_unit, gmr_unit);
    out.gmr_m = gmr > 0 ? out.gmr_m : 0.7788 * out.radius_m;
    out.radius_m = radius > 0 ? out.radius_m : out.gmr_m / 0.7788;
    double const per_m = 1 / scale(r_unit, 0);
    out.dc_ohm_per_m = (dc > 0 ? dc : ac / 1.02) * per_m;
    out.ac_ohm_per_m = (ac > 0 ? ac : dc * 1.02) * per_m;
    if ((dc <= 0 && ac <= 0) || (gmr <= 0 && radius <= 0)) {
        diagnostics.error(wire->where, fmt::format("wiredata.{} lacks its resistance or its radius", name),
                          "expected Rac or Rdc, and GMRac, radius or diam");
        return std::nullopt;
    }
    return out;
}

struct Places {
    int phases{3};
    std::vector<double> x, height; ///< m
};

std::optional<Places> read_spacing(Script const& script, std::string const& name, config::SourceMark const& where,
                                   config::Diagnostics& diagnostics) {
    Object const* spacing = script.find("linespacing", lower(name));
    if (spacing == nullptr) {
        diagnostics.error(where, fmt::format("there is no linespacing '{}'", name));
        return std::nullopt;
    }
    Places out;
    double unit = 0.3048;
    int conductors = 3;
    replay(*spacing,
           {{"nconds", [&](Value const& v) { conductors = v.integer(1, kMaxPhases); }},
            {"nphases", [&](Value const& v) { out.phases = v.integer(1, kMaxPhases); }},
            {"x", [&](Value const& v) { out.x = v.list(); }},
            {"h", [&](Value const& v) { out.height = v.list(); }},
            {"units", [&](Value const& v) { unit = metres(v) > 0 ? metres(v) : unit; }}},
           diagnostics);
    auto const n = static_cast<std::size_t>(conductors);
    if (out.x.size() != n || out.height.size() != n) {
        diagnostics.error(spacing->where, fmt::format("linespacing.{} does not place its {} conductors", name, n),
                          "expected as many values of x and h");
        return std::nullopt;
    }
    for (std::size_t i = 0; i < n; ++i) {
        out.x[i] *= unit;
        out.height[i] *= unit;
    }
    return out;
}

} // namespace

/// It holds for the line, wherever in its command it is said.
Earth Builder::earth_below(Object const& line) const {
    Earth out;
    auto const take_model = [&out](std::string const& word) {
        out.model = lower(word).starts_with("c") ? EarthModel::carson : EarthModel::deri;
    };
    if (auto const model = script_.options.find("earthmodel"); model != script_.options.end()) {
        take_model(model->second.value);
    }
    replay(line,
           {{"rho", [&](Value const& v) { out.rho_ohm_m = v.positive(); }},
            {"earthmodel", [&](Value const& v) { take_model(v.text()); }}},
           diagnostics_);
    return out;
}

std::optional<LineConstants> Builder::constants(std::vector<Conductor> const& conductors, int phases,
                                                Earth const& earth, config::SourceMark const& where) {
    LineConstants out = line_constants(conductors, std::min(phases, static_cast<int>(conductors.size())),
                                       circuit_.frequency_hz, earth.rho_ohm_m, earth.model);
    if (!out.z_ohm_per_m.allFinite() || !out.c_f_per_m.allFinite()) {
        error(where, "these conductors lie in one place, or on the ground");
        return std::nullopt;
    }
    return out;
}

std::optional<LineConstants> Builder::geometry(Value const& name, Earth const& earth) {
    Object const* object = script_.find("linegeometry", lower(name.text()));
    if (object == nullptr) {
        name.wrong(fmt::format("'{}' does not exist", name.text()), "expected the name of a linegeometry");
        return std::nullopt;
    }
    struct Placed {
        std::string wire;
        config::SourceMark where;
        double x{0}, height{0}, unit{-1};
    };
    std::vector<Placed> placed(3);
    std::size_t at = 0;
    double last_unit = 0.3048;
    int phases = 3;
    bool reduces = false, cable = false;
    Meaning meaning{
        {"nconds", [&](Value const& v) { placed.resize(static_cast<std::size_t>(v.integer(1, kMaxPhases))), at = 0; }},
        {"nphases", [&](Value const& v) { phases = v.integer(1, kMaxPhases); }},
        {"cond",
         [&](Value const& v) {
             at = static_cast<std::size_t>(v.integer(1, static_cast<int>(placed.size()))) - 1;
             placed[at].unit = placed[at].unit < 0 ? last_unit : placed[at].unit;
         }},
        {"wire", [&](Value const& v) { placed[at].wire = v.text(), placed[at].where = v.where(); }},
        {"wires",
         [&](Value const& v) {
             std::vector<Word> const names = v.words();
             for (std::size_t i = 0; i < std::min(names.size(), placed.size()); ++i) {
                 placed[i].wire = names[i].value;
                 placed[i].where = names[i].where;
             }
         }},
        {"x", [&](Value const& v) { placed[at].x = v.number(); }},
        {"h", [&](Value const& v) { placed[at].height = v.positive(); }},
        {"units",
         [&](Value const& v) {
             double const unit = metres(v);
             placed[at].unit = last_unit = unit > 0 ? unit : last_unit;
         }},
        {"reduce", [&](Value const& v) { reduces = v.yes(); }},
        {"spacing", [&](Value const& v) {
             auto const places = read_spacing(script_, v.text(), v.where(), diagnostics_);
             for (std::size_t i = 0; places && i < std::min(placed.size(), places->x.size()); ++i) {
                 placed[i].x = places->x[i];
                 placed[i].height = places->height[i];
                 placed[i].unit = 1;
             }
         }}};
    for (char const* property : {"cncable", "tscable", "cncables", "tscables"}) {
        meaning[property] = [&](Value const& v) {
            v.wrong("is given: constants of cables are not computed", "give the matrices of a linecode");
            cable = true;
        };
    }
    replay(*object, meaning, diagnostics_);
    std::vector<Conductor> conductors;
    for (Placed const& p : placed) {
        auto wire =
            cable ? std::nullopt : read_wire(script_, p.wire, p.wire.empty() ? object->where : p.where, diagnostics_);
        if (!wire) {
            return std::nullopt;
        }
        double const unit = p.unit < 0 ? last_unit : p.unit;
        wire->x_m = p.x * unit;
        wire->height_m = p.height * unit;
        conductors.push_back(*wire);
    }
    return constants(conductors, reduces ? phases : static_cast<int>(conductors.size()), earth, object->where);
}

std::optional<LineConstants> Builder::spaced_wires(Value const& spacing, Value const& wires, Earth const& earth) {
    auto const places = read_spacing(script_, spacing.text(), spacing.where(), diagnostics_);
    std::vector<Word> const names = wires.words();
    if (!places) {
        return std::nullopt;
    }
    if (names.size() != places->x.size()) {
        wires.wrong(fmt::format("has {} conductors", names.size()),
                    fmt::format("expected {}, as the linespacing has", places->x.size()));
        return std::nullopt;
    }
    std::vector<Conductor> conductors;
    for (std::size_t i = 0; i < names.size(); ++i) {
        auto wire = read_wire(script_, names[i].value, names[i].where, diagnostics_);
        if (!wire) {
            return std::nullopt;
        }
        wire->x_m = places->x[i];
        wire->height_m = places->height[i];
        conductors.push_back(*wire);
    }
    return constants(conductors, places->phases, earth, spacing.where());
}

} // namespace gridspace::opendss
