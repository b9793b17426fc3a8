// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/opendss/dss_numbers.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <utility>

namespace gridspace::opendss {
namespace {

constexpr double kDegree = std::numbers::pi / 180;

using Unary = double (*)(double);
using Binary = double (*)(double, double);
constexpr std::pair<std::string_view, Unary> kUnary[] = {{"sqrt", [](double x) { return std::sqrt(x); }},
                                                         {"sqr", [](double x) { return x * x; }},
                                                         {"inv", [](double x) { return 1 / x; }},
                                                         {"exp", [](double x) { return std::exp(x); }},
                                                         {"ln", [](double x) { return std::log(x); }},
                                                         {"log10", [](double x) { return std::log10(x); }},
                                                         {"sin", [](double x) { return std::sin(x * kDegree); }},
                                                         {"cos", [](double x) { return std::cos(x * kDegree); }},
                                                         {"tan", [](double x) { return std::tan(x * kDegree); }},
                                                         {"asin", [](double x) { return std::asin(x) / kDegree; }},
                                                         {"acos", [](double x) { return std::acos(x) / kDegree; }},
                                                         {"atan", [](double x) { return std::atan(x) / kDegree; }}};
constexpr std::pair<std::string_view, Binary> kBinary[] = {
    {"+", [](double y, double x) { return y + x; }},
    {"-", [](double y, double x) { return y - x; }},
    {"*", [](double y, double x) { return y * x; }},
    {"/", [](double y, double x) { return y / x; }},
    {"^", [](double y, double x) { return std::pow(y, x); }},
    {"atan2", [](double y, double x) { return std::atan2(y, x) / kDegree; }}};

template <class Function, std::size_t n>
Function find(std::pair<std::string_view, Function> const (&table)[n], std::string_view name) {
    auto const* const it =
        std::find_if(std::begin(table), std::end(table), [&](auto const& row) { return row.first == name; });
    return it == std::end(table) ? nullptr : it->second;
}

/// A stack calculator; the last entry is on top. An operator without its operands returns false.
class Calculator {
  public:
    void enter(double x) { stack_.push_back(x); }
    [[nodiscard]] std::optional<double> result() const {
        return stack_.empty() || !std::isfinite(stack_.back()) ? std::nullopt : std::optional{stack_.back()};
    }

    bool apply(std::string_view name) {
        if (name == "pi") {
            enter(std::numbers::pi);
            return true;
        }
        if (Unary const unary = find(kUnary, name)) {
            if (stack_.empty()) {
                return false;
            }
            stack_.back() = unary(stack_.back());
            return true;
        }
        Binary const binary = find(kBinary, name);
        bool const moves = name == "swap" || name == "rollup" || name == "rolldn";
        if (stack_.size() < 2 || (binary == nullptr && !moves)) {
            return false;
        }
        if (binary != nullptr) {
            double const x = stack_.back();
            stack_.pop_back();
            stack_.back() = binary(stack_.back(), x);
        } else if (name == "swap") {
            std::swap(stack_.back(), stack_[stack_.size() - 2]);
        } else if (name == "rollup") {
            std::rotate(stack_.begin(), stack_.begin() + 1, stack_.end());
        } else {
            std::rotate(stack_.rbegin(), stack_.rbegin() + 1, stack_.rend());
        }
        return true;
    }
    [[nodiscard]] static bool known(std::string_view name) {
        return name == "pi" || name == "swap" || name == "rollup" || name == "rolldn" ||
               find(kUnary, name) != nullptr || find(kBinary, name) != nullptr;
    }

  private:
    std::vector<double> stack_;
};

} // namespace

std::optional<double> number(std::string_view text) {
    if (text.starts_with('+')) {
        text.remove_prefix(1);
    }
    double value = 0;
    auto const [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    bool const whole = error == std::errc{} && end == text.data() + text.size() && !text.empty();
    return whole && std::isfinite(value) ? std::optional{value} : std::nullopt;
}

std::optional<double> evaluate(Word const& word, config::Diagnostics& diagnostics) {
    int const width = std::max(1, static_cast<int>(word.value.size()));
    if (!word.enclosed) {
        auto const value = number(word.value);
        if (!value) {
            diagnostics.error(word.where, fmt::format("'{}' is not a number", word.value), "expected a number", width);
        }
        return value;
    }
    Calculator calculator;
    for (Word const& item : items_of(word, diagnostics)) {
        std::string const name = lower(item.value);
        if (auto const value = number(name)) {
            calculator.enter(*value);
        } else if (!Calculator::known(name)) {
            diagnostics.error(item.where, fmt::format("'{}' is neither a number nor an operator", item.value),
                              "expected reverse Polish notation, as in (8 1000 /)",
                              std::max(1, static_cast<int>(item.value.size())));
            return std::nullopt;
        } else if (!calculator.apply(name)) {
            diagnostics.error(item.where, fmt::format("'{}' comes before its operands", item.value),
                              "expected reverse Polish notation, as in (8 1000 /)");
            return std::nullopt;
        }
    }
    auto const value = calculator.result();
    if (!value) {
        diagnostics.error(word.where, fmt::format("'{}' has no value", word.value), "expected a finite number", width);
    }
    return value;
}

std::optional<std::vector<std::vector<double>>> rows_of(Word const& word, config::Diagnostics& diagnostics) {
    std::vector<std::vector<double>> rows(1);
    for (Word const& item : items_of(word, diagnostics)) {
        if (item.value == "|" && !item.enclosed) {
            rows.emplace_back();
            continue;
        }
        auto const value = evaluate(item, diagnostics);
        if (!value) {
            return std::nullopt;
        }
        rows.back().push_back(*value);
    }
    if (rows.size() > 1 && rows.back().empty()) {
        rows.pop_back();
    }
    return rows;
}

} // namespace gridspace::opendss
