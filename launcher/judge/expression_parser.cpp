// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/expression_node.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <stdexcept>

namespace gridspace::launcher {
namespace {

using Node = Expression::Node;
using Kind = Node::Kind;

struct Mistake : std::runtime_error {
    using std::runtime_error::runtime_error;
};

constexpr std::array<std::pair<std::string_view, double>, 6> kWords{
    {{"false", 0}, {"true", 1}, {"intermediate", 0}, {"open", 1}, {"closed", 2}, {"bad", 3}}};

struct Token {
    enum class Kind { end, number, name, sign } kind{Kind::end};
    std::string_view text;
};

class Parser {
  public:
    explicit Parser(std::string_view text) : text_{text} { advance(); }

    Node run(Expression::Edge& edge) {
        Node root = disjunction();
        if (accept("rises")) {
            edge = Expression::Edge::rises;
        } else if (accept("falls")) {
            edge = Expression::Edge::falls;
        }
        if (token_.kind != Token::Kind::end) {
            throw Mistake{fmt::format("'{}' is not expected here", token_.text)};
        }
        return root;
    }

    std::vector<std::string> signals;

  private:
    /// Without a copy of what is below: lists of initializers copy.
    static Node of_two(Kind kind, Node&& left, Node&& right) {
        Node out{kind, 0, 0, "", {}};
        out.children.reserve(2);
        out.children.push_back(std::move(left));
        out.children.push_back(std::move(right));
        return out;
    }
    Node disjunction() {
        Node left = conjunction();
        while (accept("or")) {
            left = of_two(Kind::logical_or, std::move(left), conjunction());
        }
        return left;
    }
    Node conjunction() {
        Node left = negation();
        while (accept("and")) {
            left = of_two(Kind::logical_and, std::move(left), negation());
        }
        return left;
    }
    Node negation() {
        deeper();
        Node node = accept("not") ? Node{Kind::logical_not, 0, 0, "", {negation()}} : comparison();
        --depth_;
        return node;
    }
    Node comparison() {
        Node left = sum();
        static constexpr std::array<std::pair<std::string_view, Kind>, 6> kSigns{{{">=", Kind::greater_equal},
                                                                                  {"<=", Kind::less_equal},
                                                                                  {"==", Kind::equal},
                                                                                  {"!=", Kind::not_equal},
                                                                                  {">", Kind::greater},
                                                                                  {"<", Kind::less}}};
        for (auto const& [sign, kind] : kSigns) {
            if (accept(sign)) {
                return of_two(kind, std::move(left), sum());
            }
        }
        if (accept("in")) {
            expect("[");
            Node low = sum();
            expect(",");
            Node high = sum();
            expect("]");
            return Node{Kind::inside, 0, 0, "", {std::move(left), std::move(low), std::move(high)}};
        }
        return left;
    }
    Node sum() {
        Node left = product();
        while (true) {
            if (accept("+")) {
                left = of_two(Kind::add, std::move(left), product());
            } else if (accept("-")) {
                left = of_two(Kind::subtract, std::move(left), product());
            } else {
                return left;
            }
        }
    }
    Node product() {
        Node left = unary();
        while (true) {
            if (accept("*")) {
                left = of_two(Kind::multiply, std::move(left), unary());
            } else if (accept("/")) {
                left = of_two(Kind::divide, std::move(left), unary());
            } else {
                return left;
            }
        }
    }
    Node unary() {
        deeper();
        Node node = accept("-") ? Node{Kind::negate, 0, 0, "", {unary()}} : primary();
        --depth_;
        return node;
    }
    void deeper() {
        if (++depth_ > kDeepest) {
            throw Mistake{"brackets or signs are nested too deeply"};
        }
    }
    Node primary() {
        if (accept("(")) {
            Node inside = disjunction();
            expect(")");
            return inside;
        }
        if (token_.kind == Token::Kind::number) {
            double value = 0;
            auto const [end, error] =
                std::from_chars(token_.text.data(), token_.text.data() + token_.text.size(), value);
            if (error != std::errc{}) {
                throw Mistake{fmt::format("{} is out of range", token_.text)};
            }
            advance();
            return Node{Kind::number, value, 0, "", {}};
        }
        if (token_.kind != Token::Kind::name) {
            throw Mistake{token_.kind == Token::Kind::end ? "it ends too early"
                                                          : fmt::format("'{}' is not expected here", token_.text)};
        }
        std::string const name{token_.text};
        advance();
        if (accept("(")) {
            return function(name);
        }
        if (double const word = word_value(name); !std::isnan(word)) {
            return Node{Kind::number, word, 0, "", {}};
        }
        if (name.find('.') == std::string::npos) {
            throw Mistake{
                fmt::format("'{}' is neither a signal (kind.element.quantity) nor a word of the language", name)};
        }
        signals.push_back(name);
        return Node{Kind::signal, 0, signals.size() - 1, "", {}};
    }
    Node function(std::string const& name) {
        static constexpr std::array<std::string_view, 5> kFunctions{"min", "max", "mean", "sum", "abs"};
        if (std::find(kFunctions.begin(), kFunctions.end(), name) == kFunctions.end()) {
            throw Mistake{fmt::format("there is no function '{}'; there are min, max, mean, sum and abs", name)};
        }
        Node node{Kind::function, 0, 0, name, {}};
        do {
            node.children.push_back(disjunction());
        } while (accept(","));
        expect(")");
        return node;
    }

    bool accept(std::string_view text) {
        if (token_.kind == Token::Kind::end || token_.text != text) {
            return false;
        }
        advance();
        return true;
    }
    void expect(std::string_view text) {
        if (!accept(text)) {
            throw Mistake{fmt::format("expected '{}'{}", text,
                                      token_.kind == Token::Kind::end ? " at the end"
                                                                      : fmt::format(" before '{}'", token_.text))};
        }
    }
    void advance() {
        while (at_ < text_.size() && std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
            ++at_;
        }
        std::size_t const start = at_;
        token_ = {};
        if (at_ == text_.size()) {
            return;
        }
        if (++words_ > kMostWords) { // each may be a level of the tree
            throw Mistake{fmt::format("it has more than {} words and signs", kMostWords)};
        }
        auto const is_digit = [](char c) { return std::isdigit(static_cast<unsigned char>(c)) != 0; };
        auto const in_name = [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' || c == '*' || c == '?';
        };
        char const c = text_[at_];
        if (is_digit(c)) {
            double ignored = 0;
            auto const [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), ignored);
            at_ = static_cast<std::size_t>(end - text_.data());
            token_.kind = Token::Kind::number;
        } else if (std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_') {
            while (at_ < text_.size() && in_name(text_[at_])) {
                ++at_;
            }
            token_.kind = Token::Kind::name;
        } else {
            std::string_view const two = text_.substr(at_, 2);
            at_ += two == ">=" || two == "<=" || two == "==" || two == "!=" ? 2 : 1;
            token_.kind = Token::Kind::sign;
        }
        token_.text = text_.substr(start, at_ - start);
    }

    static constexpr int kDeepest = 100, kMostWords = 2000;
    std::string_view text_;
    std::size_t at_{0};
    int depth_{0}, words_{0};
    Token token_;
};

} // namespace

double word_value(std::string_view word) {
    for (auto const& [name, value] : kWords) {
        if (name == word) {
            return value;
        }
    }
    return std::numeric_limits<double>::quiet_NaN();
}

Result<ParsedExpression> parse_expression(std::string_view text) {
    ParsedExpression out;
    Parser parser{text};
    try {
        out.root = parser.run(out.edge);
    } catch (Mistake const& mistake) {
        return fail(ExitCode::usage, fmt::format("'{}' is not an expression: {}", text, mistake.what()));
    }
    out.signals = std::move(parser.signals);
    return out;
}

} // namespace gridspace::launcher
