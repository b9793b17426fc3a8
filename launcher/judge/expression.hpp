// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::launcher {

/// An expression over signals: numbers, signal names, + - * /, comparisons, `in [a, b]`, and/or/not, min() max() mean()
/// sum() abs() over signals and patterns, the words true, false, open, closed, intermediate, bad, and `rises` / `falls`
/// at its end. Times and separators need blanks around `*`, which is also part of patterns: `bus.*.v_pu`.
class Expression {
  public:
    [[nodiscard]] static Result<Expression> parse(std::string_view text);

    /// Names and patterns of the signals it uses, in the order of the text.
    [[nodiscard]] std::vector<std::string> const& signals() const { return signals_; }

    enum class Edge { none, rises, falls };
    [[nodiscard]] Edge edge() const { return edge_; }
    /// A single signal or pattern, nothing around it.
    [[nodiscard]] bool is_plain_signal() const;
    [[nodiscard]] std::string const& text() const { return text_; }

    /// What a pattern stands for: indices of values, in the order of signals().
    using Bindings = std::vector<std::vector<std::size_t>>;
    /// Evaluates with the present values; `bindings[i]` are the places of signals()[i] in `values`. True is 1, false is
    /// 0; NaN after a division by zero, whatever it was compared with (`x == 0 or y / x > 2` does not divide where x is
    /// 0).
    [[nodiscard]] double evaluate(Bindings const& bindings, std::span<double const> values) const;

    struct Node;

  private:
    std::string text_;
    std::shared_ptr<Node const> root_;
    std::vector<std::string> signals_;
    Edge edge_{Edge::none};
};

/// The number that a word of the language stands for ("open" is 1, a double-point value); NaN for other words.
[[nodiscard]] double word_value(std::string_view word);

} // namespace gridspace::launcher
