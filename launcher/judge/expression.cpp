// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/expression_node.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace gridspace::launcher {
namespace {

using Node = Expression::Node;
using Kind = Node::Kind;
using Bindings = Expression::Bindings;

/// The values at an instant. A division by zero is remembered: no comparison may make a truth of it.
struct Instant {
    Bindings const& bindings;
    std::span<double const> values;
    bool undefined{false};
};

double evaluate_node(Node const& n, Instant& instant);

/// The values that an argument of a function stands for: all signals of a pattern, or one number.
void gather(Node const& n, Instant& instant, std::vector<double>& out) {
    if (n.kind == Kind::signal) {
        for (std::size_t const place : instant.bindings[n.signal]) {
            out.push_back(instant.values[place]);
        }
    } else {
        out.push_back(evaluate_node(n, instant));
    }
}

double evaluate_function(Node const& n, Instant& instant) {
    std::vector<double> arguments; // of this call: there are functions of functions
    for (Node const& child : n.children) {
        gather(child, instant, arguments);
    }
    if (n.function == "min" || n.function == "max") { // of those that are measured: NaN is no number to compare with
        std::erase_if(arguments, [](double v) { return std::isnan(v); });
    }
    if (arguments.empty()) {
        return std::numeric_limits<double>::quiet_NaN();
    }
    if (n.function == "min") {
        return *std::min_element(arguments.begin(), arguments.end());
    }
    if (n.function == "max") {
        return *std::max_element(arguments.begin(), arguments.end());
    }
    if (n.function == "abs") {
        return std::abs(arguments.front());
    }
    double sum = 0;
    for (double const v : arguments) {
        sum += v;
    }
    return n.function == "mean" ? sum / static_cast<double>(arguments.size()) : sum;
}

double evaluate_node(Node const& n, Instant& instant) {
    auto const child = [&](std::size_t i) { return evaluate_node(n.children[i], instant); };
    switch (n.kind) {
    case Kind::number:
        return n.number;
    case Kind::signal:
        return instant.bindings[n.signal].empty() ? std::numeric_limits<double>::quiet_NaN()
                                                  : instant.values[instant.bindings[n.signal].front()];
    case Kind::negate:
        return -child(0);
    case Kind::add:
        return child(0) + child(1);
    case Kind::subtract:
        return child(0) - child(1);
    case Kind::multiply:
        return child(0) * child(1);
    case Kind::divide: {
        double const quotient = child(0) / child(1);
        instant.undefined = instant.undefined || !std::isfinite(quotient);
        return quotient;
    }
    case Kind::less:
        return child(0) < child(1);
    case Kind::less_equal:
        return child(0) <= child(1);
    case Kind::greater:
        return child(0) > child(1);
    case Kind::greater_equal:
        return child(0) >= child(1);
    case Kind::equal:
        return child(0) == child(1);
    case Kind::not_equal:
        return child(0) != child(1);
    case Kind::inside: {
        double const v = child(0);
        return v >= child(1) && v <= child(2);
    }
    case Kind::logical_and:
        return child(0) != 0 && child(1) != 0;
    case Kind::logical_or:
        return child(0) != 0 || child(1) != 0;
    case Kind::logical_not:
        return child(0) == 0;
    case Kind::function:
        return evaluate_function(n, instant);
    }
    return 0;
}

} // namespace

Result<Expression> Expression::parse(std::string_view text) {
    auto parsed = parse_expression(text);
    if (!parsed) {
        return std::unexpected{parsed.error()};
    }
    Expression out;
    out.text_ = std::string{text};
    out.root_ = std::make_shared<Node const>(std::move(parsed->root));
    out.edge_ = parsed->edge;
    out.signals_ = std::move(parsed->signals);
    return out;
}

bool Expression::is_plain_signal() const {
    return root_->kind == Kind::signal && edge_ == Edge::none;
}

double Expression::evaluate(Bindings const& bindings, std::span<double const> values) const {
    Instant instant{bindings, values};
    double const value = evaluate_node(*root_, instant);
    return instant.undefined ? std::numeric_limits<double>::quiet_NaN() : value;
}

} // namespace gridspace::launcher
