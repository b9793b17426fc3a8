// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/sweep/design.hpp"

#include "common/text.hpp"
#include "launcher/judge/expression.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numeric>
#include <random>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

/// FNV-1a: the same on every machine, as std::hash is not.
std::uint64_t hash_of(std::string_view text) {
    std::uint64_t hash = 0xcbf29ce484222325;
    for (char const c : text) {
        hash = (hash ^ static_cast<unsigned char>(c)) * 0x100000001b3;
    }
    return hash;
}

/// `count` draws. Latin hypercube: one in each of `count` equally likely parts of the range, in a random order.
std::vector<Node> draw(Parameter const& p, Study::Sampling const& sampling, std::size_t count) {
    // The generator's numbers are laid down by the standard; those of std::uniform_real_distribution and std::shuffle
    // are not.
    std::mt19937_64 random{static_cast<std::uint64_t>(sampling.seed) ^ hash_of(p.name.name)};
    auto const uniform = [&] { return (static_cast<double>(random() >> 11U) + 0.5) * 0x1p-53; };
    std::vector<std::size_t> parts(count);
    std::iota(parts.begin(), parts.end(), std::size_t{0});
    for (std::size_t i = count; i > 1; --i) {
        std::swap(parts[i - 1], parts[random() % i]);
    }
    std::vector<Node> out;
    for (std::size_t const part : parts) {
        double const u =
            sampling.latin_hypercube ? (static_cast<double>(part) + uniform()) / static_cast<double>(count) : uniform();
        double value = quantile(*p.distribution, u);
        if (p.round_to > 0) {
            value = std::round(value / p.round_to) * p.round_to;
        }
        out.push_back(Node::scalar(fmt::format("{:.9g}", value), p.name.where));
    }
    return out;
}

/// How many draws are made together.
std::size_t draws_of(Study const& s, Diagnostics& diagnostics) {
    Parameter const* drawn = nullptr;
    std::size_t length = 0;
    for (Parameter const& p : s.parameters) {
        drawn = p.distribution ? &p : drawn;
        length = std::max(length, p.values.size());
    }
    if (drawn == nullptr) {
        if (s.sampling.samples > 0) {
            diagnostics.error(s.parameters_mark, "`sampling` says how many draws, and nothing is drawn",
                              "leave `samples` out, or let a parameter have a distribution");
        }
        return 1;
    }
    if (s.combine == Study::Combine::zip && length > 0) {
        return length;
    }
    if (s.sampling.samples == 0) {
        diagnostics.error(drawn->name.where, fmt::format("'{}' is drawn, and nothing says how often", drawn->name.name),
                          "sampling: {samples: 100}", static_cast<int>(drawn->name.name.size()));
    }
    return static_cast<std::size_t>(std::max<std::int64_t>(s.sampling.samples, 1));
}

/// Zipped: all parameters side by side. Crossed: every listed value with every other, and all of these with each draw.
std::vector<Point> combine(Study const& s, Diagnostics& diagnostics) {
    std::size_t const draws = draws_of(s, diagnostics);
    bool const zip = s.combine == Study::Combine::zip;
    std::size_t count = draws;
    for (Parameter const& p : s.parameters) {
        if (p.distribution) {
            continue;
        }
        if (zip) {
            Parameter const& first = *std::find_if(s.parameters.begin(), s.parameters.end(),
                                                   [](Parameter const& other) { return !other.distribution; });
            if (p.values.size() != first.values.size()) {
                diagnostics.error(p.name.where,
                                  fmt::format("'{}' has {} values, and '{}' has {}: they cannot be zipped", p.name.name,
                                              p.values.size(), first.name.name, first.values.size()),
                                  "as many of each, or `combine: cross`", static_cast<int>(p.name.name.size()));
                return {};
            }
            count = p.values.size();
        } else if (count > kMaxStudyRuns / std::max<std::size_t>(p.values.size(), 1)) {
            diagnostics.error(s.parameters_mark, fmt::format("more than {} points", kMaxStudyRuns),
                              "fewer values, or draws instead of a grid");
            return {};
        } else {
            count *= p.values.size();
        }
    }
    if (count > kMaxStudyRuns / static_cast<std::size_t>(s.repetitions)) {
        diagnostics.error(s.parameters_mark,
                          fmt::format("{} points with {} repetitions each are more than {} runs", count, s.repetitions,
                                      kMaxStudyRuns),
                          "fewer of either");
        return {};
    }
    if (!diagnostics.ok()) {
        return {};
    }
    std::vector<std::vector<Node>> columns;
    for (Parameter const& p : s.parameters) {
        columns.push_back(p.distribution ? draw(p, s.sampling, draws) : p.values);
    }
    std::vector<Point> points(count);
    for (std::size_t i = 0; i < count; ++i) {
        std::size_t rest = i / draws;
        points[i].resize(columns.size());
        for (std::size_t c = columns.size(); c-- > 0;) {
            bool const drawn = s.parameters[c].distribution.has_value();
            std::size_t const place = zip ? i : drawn ? i % draws : rest % columns[c].size();
            rest = zip || drawn ? rest : rest / columns[c].size();
            points[i][c] = columns[c][place];
        }
    }
    return points;
}

/// A condition with the places of its names among the parameters.
struct Condition {
    Expression expression;
    Expression::Bindings places;
};

std::vector<Condition> conditions_of(Study const& s, Diagnostics& diagnostics) {
    std::vector<std::string> names;
    for (Parameter const& p : s.parameters) {
        names.push_back("vary." + p.name.name);
    }
    std::vector<Condition> out;
    for (Ref const& text : s.where) {
        auto expression = Expression::parse(text.name);
        if (!expression) {
            diagnostics.error(
                text.where, fmt::format("the condition '{}' cannot be read: {}", text.name, expression.error().message),
                expression.error().remedy, static_cast<int>(text.name.size()));
            continue;
        }
        Condition condition{*expression, {}};
        for (std::string const& name : condition.expression.signals()) {
            auto const place = std::find(names.begin(), names.end(), name);
            if (place == names.end()) {
                diagnostics.error(text.where,
                                  fmt::format("the condition '{}' uses '{}', which does not vary", text.name, name),
                                  spelling_hint(name, names), static_cast<int>(text.name.size()));
                break;
            }
            condition.places.push_back({static_cast<std::size_t>(place - names.begin())});
        }
        if (condition.expression.edge() != Expression::Edge::none) {
            diagnostics.error(text.where, fmt::format("nothing rises or falls in '{}'", text.name),
                              "a condition compares values: vary.low_kw < vary.high_kw");
        }
        out.push_back(std::move(condition));
    }
    return out;
}

/// The numbers of a point, for conditions. A word is none, and a condition cannot use it.
bool meets(Condition const& condition, Point const& point, Study const& s, Ref const& text, Diagnostics& diagnostics) {
    std::vector<double> values(point.size(), std::numeric_limits<double>::quiet_NaN());
    for (auto const& places : condition.places) {
        auto const number = config::number_of(point[places.front()]);
        if (!number) {
            diagnostics.error(text.where,
                              fmt::format("the condition '{}' needs numbers, and '{}' can be {}", text.name,
                                          s.parameters[places.front()].name.name, describe(point[places.front()])),
                              "", static_cast<int>(text.name.size()));
            return false;
        }
        values[places.front()] = *number;
    }
    double const met = condition.expression.evaluate(condition.places, values);
    return std::isfinite(met) && met != 0;
}

} // namespace

Design make_design(Study const& s, Diagnostics& diagnostics) {
    Design design;
    std::vector<Condition> const conditions = conditions_of(s, diagnostics);
    std::vector<Point> points = combine(s, diagnostics);
    if (!diagnostics.ok()) {
        return design;
    }
    for (Point& point : points) {
        bool met = true;
        for (std::size_t i = 0; i < conditions.size() && met; ++i) {
            met = meets(conditions[i], point, s, s.where[i], diagnostics);
        }
        if (!diagnostics.ok()) {
            return {};
        }
        if (met) {
            design.points.push_back(std::move(point));
        } else {
            ++design.left_out;
        }
    }
    if (design.points.empty()) {
        diagnostics.error(s.where.empty() ? s.parameters_mark : s.where.front().where,
                          fmt::format("none of the {} points meets the conditions of `where`", design.left_out),
                          "nothing would be run");
    }
    return design;
}

} // namespace gridspace::launcher
