// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "launcher/judge/expression.hpp"

#include <cstddef>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// An operation of an expression and what it is applied to.
struct Expression::Node {
    enum class Kind {
        number,
        signal,
        negate,
        add,
        subtract,
        multiply,
        divide,
        less,
        less_equal,
        greater,
        greater_equal,
        equal,
        not_equal,
        inside,
        logical_and,
        logical_or,
        logical_not,
        function
    };
    Kind kind{Kind::number};
    double number{0};
    std::size_t signal{0};
    std::string function;
    std::vector<Node> children;
};

struct ParsedExpression {
    Expression::Node root;
    Expression::Edge edge{Expression::Edge::none};
    std::vector<std::string> signals; ///< names and patterns, in the order of the text
};
/// The error says what is wrong with it.
[[nodiscard]] Result<ParsedExpression> parse_expression(std::string_view text);

} // namespace gridspace::launcher
