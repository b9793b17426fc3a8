// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/matlab_statement.hpp"

#include "common/text.hpp"
#include "sim/network/matlab_matrix.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <utility>

namespace gridspace::sim {
namespace {

constexpr int kDeepest = 100; ///< brackets and signs in each other

/// One statement, evaluated by recursive descent.
class Statement {
  public:
    Statement(std::string_view text, int line, MatlabCase& out) : text_{text}, line_{line}, case_{out} {}

    /// The line on which evaluation stands: where a mistake is.
    [[nodiscard]] int line() const { return line_of(at_); }

    void run() {
        skip();
        for (std::string_view const word : {"end", "endfunction", "return", "define_constants"}) {
            if (trim(text_) == word) {
                return;
            }
        }
        if (keyword("function")) {
            std::size_t const equals = text_.find('=');
            case_.name = std::string{trim(text_.substr(equals == std::string_view::npos ? at_ : equals + 1))};
            return;
        }
        if (peek() == '[') { // [PQ, PV, REF, ...] = idx_bus
            std::size_t const equals = text_.find('=');
            std::string_view const right = equals == std::string_view::npos ? "" : trim(text_.substr(equals + 1));
            if (right != "idx_bus" && right != "idx_brch" && right != "idx_gen") {
                throw MatlabMistake{"only [..] = idx_bus, idx_brch or idx_gen is understood"};
            }
            return;
        }
        std::string const target = name();
        bool const of_case = target == "mpc";
        std::string field = target;
        if (of_case) {
            expect('.');
            field = name();
        }
        std::optional<std::pair<std::vector<std::size_t>, std::vector<std::size_t>>> part;
        if (peek() == '(') {
            part = indices(matrix(field));
        }
        expect('=');
        skip();
        if (peek() == '\'' || peek() == '"' || peek() == '{') {
            return; // text and cell arrays (version, bus names) do not matter to a power flow
        }
        assign(field, of_case, part, expression());
        skip();
        if (at_ != text_.size()) {
            throw MatlabMistake{fmt::format("'{}' is not understood here", text_.substr(at_))};
        }
    }

  private:
    using Part = std::pair<std::vector<std::size_t>, std::vector<std::size_t>>;

    void assign(std::string const& field, bool of_case, std::optional<Part> const& part, MatlabMatrix const& value) {
        if (part) {
            MatlabMatrix& whole = matrix(field);
            for (std::size_t r = 0; r < part->first.size(); ++r) {
                for (std::size_t c = 0; c < part->second.size(); ++c) {
                    bool const one = is_scalar(value);
                    if (!one && (r >= value.size() || c >= value[r].size())) {
                        throw MatlabMistake{"the two sides have different sizes"};
                    }
                    whole[part->first[r]][part->second[c]] = one ? value[0][0] : value[r][c];
                }
            }
        } else if (is_scalar(value) && !(of_case && (field == "bus" || field == "gen" || field == "branch"))) {
            case_.scalars[field] = value[0][0];
        } else {
            case_.matrices[field] = {value, line_, rows_at_.size() == value.size() ? rows_at_ : std::vector<int>{}};
        }
    }

    MatlabMatrix& matrix(std::string const& field) {
        auto const it = case_.matrices.find(field);
        if (it == case_.matrices.end()) {
            throw MatlabMistake{fmt::format("'{}' has not been assigned", field)};
        }
        return it->second.rows;
    }

    Part indices(MatlabMatrix const& of) {
        expect('(');
        std::vector<std::size_t> const rows = index(of.size());
        expect(',');
        std::vector<std::size_t> const columns = index(of.empty() ? 0 : of[0].size());
        expect(')');
        return {rows, columns};
    }

    std::vector<std::size_t> index(std::size_t count) {
        skip();
        std::vector<std::size_t> out;
        if (peek() == ':') {
            ++at_;
            for (std::size_t i = 0; i < count; ++i) {
                out.push_back(i);
            }
            return out;
        }
        MatlabMatrix const list = expression();
        for (auto const& row : list) {
            for (double const v : row) {
                if (v < 1 || v > static_cast<double>(count) || v != std::floor(v)) {
                    throw MatlabMistake{fmt::format("index {} is outside 1 to {}", v, count)};
                }
                out.push_back(static_cast<std::size_t>(v) - 1);
            }
        }
        return out;
    }

    MatlabMatrix expression() {
        MatlabMatrix left = term();
        while (true) {
            skip();
            // Inside [ ], "a -b" is two elements and "a - b" is one: a sign that touches its number starts an element.
            if (depth_ > 0 && at_ + 1 < text_.size() && (peek() == '-' || peek() == '+') && at_ > 0 &&
                std::isspace(static_cast<unsigned char>(text_[at_ - 1])) != 0 &&
                std::isspace(static_cast<unsigned char>(text_[at_ + 1])) == 0) {
                return left;
            }
            if (peek() == '+') {
                ++at_;
                left = combine(left, term(), [](double a, double b) { return a + b; });
            } else if (peek() == '-') {
                ++at_;
                left = combine(left, term(), [](double a, double b) { return a - b; });
            } else {
                return left;
            }
        }
    }

    MatlabMatrix term() {
        MatlabMatrix left = factor();
        while (true) {
            skip();
            std::size_t const before = at_;
            if (peek() == '.' && at_ + 1 < text_.size() && (text_[at_ + 1] == '*' || text_[at_ + 1] == '/')) {
                ++at_;
            }
            if (peek() == '*') {
                ++at_;
                left = combine(left, factor(), [](double a, double b) { return a * b; });
            } else if (peek() == '/') {
                ++at_;
                left = combine(left, factor(), [](double a, double b) { return a / b; });
            } else {
                at_ = before;
                return left;
            }
        }
    }

    MatlabMatrix factor() {
        skip();
        if (++nested_ > kDeepest) {
            throw MatlabMistake{"brackets or signs are nested too deeply"};
        }
        MatlabMatrix value = signed_value();
        --nested_;
        return value;
    }

    MatlabMatrix signed_value() {
        if (peek() == '-') {
            ++at_;
            return combine(scalar(0), factor(), [](double a, double b) { return a - b; });
        }
        if (peek() == '+') {
            ++at_;
            return factor();
        }
        MatlabMatrix base = primary();
        skip();
        if (peek() == '.' && at_ + 1 < text_.size() && text_[at_ + 1] == '^') {
            ++at_;
        }
        if (peek() == '^') {
            ++at_;
            return combine(base, factor(), [](double a, double b) { return std::pow(a, b); });
        }
        return base;
    }

    MatlabMatrix primary() {
        skip();
        char const c = peek();
        if (c == '(') {
            ++at_;
            int const outer = std::exchange(depth_, 0);
            MatlabMatrix const inside = expression();
            depth_ = outer;
            expect(')');
            return inside;
        }
        if (c == '[') {
            return literal();
        }
        if (std::isdigit(static_cast<unsigned char>(c)) != 0 || c == '.') {
            return scalar(number());
        }
        std::string const word = name();
        if (word == "mpc") {
            expect('.');
            std::string const field = name();
            if (auto const it = case_.scalars.find(field); it != case_.scalars.end()) {
                return scalar(it->second);
            }
            return selected(matrix(field));
        }
        if (word == "Inf" || word == "inf") {
            return scalar(HUGE_VAL);
        }
        if (word == "pi") {
            return scalar(std::acos(-1.0));
        }
        if (double (*function)(double) = matlab_function(word); function != nullptr) {
            expect('(');
            MatlabMatrix const argument = expression();
            expect(')');
            return combine(argument, scalar(0), [&](double a, double) { return function(a); });
        }
        if (auto const it = matpower_columns().find(word); it != matpower_columns().end()) {
            return scalar(it->second);
        }
        if (auto const it = case_.scalars.find(word); it != case_.scalars.end()) {
            return scalar(it->second);
        }
        if (case_.matrices.contains(word)) {
            return selected(matrix(word));
        }
        throw MatlabMistake{fmt::format("'{}' is not understood", word)};
    }

    MatlabMatrix selected(MatlabMatrix const& whole) {
        if (peek() != '(') {
            return whole;
        }
        Part const part = indices(whole);
        if (part.first.empty() || part.second.empty()) {
            throw MatlabMistake{"nothing is selected"};
        }
        MatlabMatrix out;
        for (std::size_t const r : part.first) {
            out.emplace_back();
            for (std::size_t const c : part.second) {
                out.back().push_back(whole[r][c]);
            }
        }
        return out;
    }

    MatlabMatrix literal() {
        expect('[');
        ++depth_;
        MatlabMatrix rows{{}};
        std::vector<std::size_t> begins{at_};
        while (true) {
            skip();
            char const c = peek();
            if (c == '\0') {
                at_ = begins.front();
                throw MatlabMistake{"a '[' is not closed"};
            }
            if (c == ']') {
                ++at_;
                break;
            }
            if (c == ';' || c == '\n') {
                ++at_;
                if (!rows.back().empty()) {
                    rows.emplace_back();
                    begins.push_back(at_);
                }
            } else if (c == ',') {
                ++at_;
            } else {
                if (rows.back().empty()) {
                    begins.back() = at_;
                }
                if (auto const v = plain_number()) {
                    rows.back().push_back(*v);
                    continue;
                }
                MatlabMatrix const element = expression();
                rows.back().insert(rows.back().end(), element[0].begin(), element[0].end());
            }
        }
        --depth_;
        if (rows.back().empty() && rows.size() > 1) {
            rows.pop_back();
        }
        note_rows(rows, begins);
        return rows;
    }

    [[nodiscard]] bool begins_number(std::size_t at) const {
        auto const digit_at = [this](std::size_t place) {
            return place < text_.size() && std::isdigit(static_cast<unsigned char>(text_[place])) != 0;
        };
        return digit_at(at) || (at < text_.size() && text_[at] == '-' && digit_at(at + 1));
    }
    /// Nearly all of a case is plain numbers, each followed by a separator: no expression is made of these.
    std::optional<double> plain_number() {
        double v = 0;
        if (!begins_number(at_)) {
            return std::nullopt;
        }
        auto const [stop, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), v);
        if (error != std::errc{}) {
            return std::nullopt;
        }
        auto const end = static_cast<std::size_t>(stop - text_.data());
        std::size_t next = end;
        while (next < text_.size() && (text_[next] == ' ' || text_[next] == '\t')) {
            ++next;
        }
        bool const ends = next < text_.size() && std::string_view{"\n;,]"}.find(text_[next]) != std::string_view::npos;
        if (!ends && !(next > end && begins_number(next))) {
            return std::nullopt;
        }
        at_ = end;
        return v;
    }
    /// The rows of a matrix are of one length; where each begins is kept.
    void note_rows(MatlabMatrix const& rows, std::vector<std::size_t> const& begins) {
        rows_at_.clear();
        std::size_t counted = 0;
        int line = line_;
        for (std::size_t r = 0; r < rows.size(); ++r) {
            if (rows[r].size() != rows.front().size()) {
                at_ = begins[r];
                throw MatlabMistake{
                    fmt::format("the matrix has rows of {} and of {} numbers", rows.front().size(), rows[r].size())};
            }
            for (; counted < begins[r]; ++counted) { // as line_of, but each character once
                line += text_[counted] == '\n' || text_[counted] == kMatlabContinued ? 1 : 0;
            }
            rows_at_.push_back(line);
        }
    }

    [[nodiscard]] int line_of(std::size_t at) const {
        auto const passed = text_.substr(0, std::min(at, text_.size()));
        return line_ + static_cast<int>(std::count_if(passed.begin(), passed.end(),
                                                      [](char c) { return c == '\n' || c == kMatlabContinued; }));
    }
    [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r' ||
                                      text_[at_] == kMatlabContinued || (text_[at_] == '\n' && depth_ == 0))) {
            ++at_;
        }
    }
    void expect(char c) {
        skip();
        if (peek() != c) {
            throw MatlabMistake{fmt::format("expected '{}' before '{}'", c, text_.substr(at_, 20))};
        }
        ++at_;
    }
    bool keyword(std::string_view word) {
        if (text_.substr(at_).starts_with(word)) {
            at_ += word.size();
            return true;
        }
        return false;
    }
    std::string name() {
        skip();
        std::size_t const start = at_;
        while (at_ < text_.size() && (std::isalnum(static_cast<unsigned char>(text_[at_])) != 0 || text_[at_] == '_')) {
            ++at_;
        }
        if (start == at_) {
            throw MatlabMistake{fmt::format("expected a name before '{}'", text_.substr(at_, 20))};
        }
        return std::string{text_.substr(start, at_ - start)};
    }
    double number() {
        double v = 0;
        auto const [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), v);
        if (error != std::errc{}) {
            throw MatlabMistake{"expected a number"};
        }
        at_ = static_cast<std::size_t>(end - text_.data());
        return v;
    }

    std::string_view text_;
    int line_;
    MatlabCase& case_;
    std::size_t at_{0};
    int depth_{0};             ///< of [ ]
    int nested_{0};            ///< of brackets and signs
    std::vector<int> rows_at_; ///< lines of the rows of the last literal
};

} // namespace

std::optional<MatlabStatementMistake> run_matlab_statement(std::string_view text, int line, MatlabCase& out) {
    Statement statement{text, line, out};
    try {
        statement.run();
    } catch (MatlabMistake const& mistake) {
        return MatlabStatementMistake{statement.line(), mistake.what()};
    }
    return std::nullopt;
}

} // namespace gridspace::sim
