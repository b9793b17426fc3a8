// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/matlab_case.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cctype>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <optional>
#include <stdexcept>
#include <utility>

namespace gridspace::sim {
namespace {

// The constants that idx_bus, idx_brch and idx_gen of MATPOWER define (column numbers from 1).
std::map<std::string, double> const& column_names() {
    static std::map<std::string, double> const names{
        {"PQ", 1},     {"PV", 2},       {"REF", 3},    {"NONE", 4},       {"BUS_I", 1},    {"BUS_TYPE", 2},
        {"PD", 3},     {"QD", 4},       {"GS", 5},     {"BS", 6},         {"BUS_AREA", 7}, {"VM", 8},
        {"VA", 9},     {"BASE_KV", 10}, {"ZONE", 11},  {"VMAX", 12},      {"VMIN", 13},    {"F_BUS", 1},
        {"T_BUS", 2},  {"BR_R", 3},     {"BR_X", 4},   {"BR_B", 5},       {"RATE_A", 6},   {"RATE_B", 7},
        {"RATE_C", 8}, {"TAP", 9},      {"SHIFT", 10}, {"BR_STATUS", 11}, {"GEN_BUS", 1},  {"PG", 2},
        {"QG", 3},     {"QMAX", 4},     {"QMIN", 5},   {"VG", 6},         {"MBASE", 7},    {"GEN_STATUS", 8},
        {"PMAX", 9},   {"PMIN", 10},
    };
    return names;
}

constexpr char kContinued = '\v'; ///< stands for '...' and its line end: white space that ends no row
constexpr int kDeepest = 100;     ///< brackets and signs in each other

struct Mistake : std::runtime_error {
    using std::runtime_error::runtime_error;
};

using Matrix = std::vector<std::vector<double>>;

Matrix scalar(double v) {
    return {{v}};
}
bool is_scalar(Matrix const& m) {
    return m.size() == 1 && m[0].size() == 1;
}

/// Element by element; a scalar goes with everything.
template <class Op>
Matrix combine(Matrix const& a, Matrix const& b, Op const& op) {
    Matrix const& shape = is_scalar(a) ? b : a;
    if (!is_scalar(a) && !is_scalar(b) && (a.size() != b.size() || a[0].size() != b[0].size())) {
        throw Mistake{"matrices of different size"};
    }
    Matrix out = shape;
    for (std::size_t r = 0; r < shape.size(); ++r) {
        for (std::size_t c = 0; c < shape[r].size(); ++c) {
            out[r][c] = op(is_scalar(a) ? a[0][0] : a[r][c], is_scalar(b) ? b[0][0] : b[r][c]);
        }
    }
    return out;
}

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
                throw Mistake{"only [..] = idx_bus, idx_brch or idx_gen is understood"};
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
            throw Mistake{fmt::format("'{}' is not understood here", text_.substr(at_))};
        }
    }

  private:
    using Part = std::pair<std::vector<std::size_t>, std::vector<std::size_t>>;

    void assign(std::string const& field, bool of_case, std::optional<Part> const& part, Matrix const& value) {
        if (part) {
            Matrix& whole = matrix(field);
            for (std::size_t r = 0; r < part->first.size(); ++r) {
                for (std::size_t c = 0; c < part->second.size(); ++c) {
                    bool const one = is_scalar(value);
                    if (!one && (r >= value.size() || c >= value[r].size())) {
                        throw Mistake{"the two sides have different sizes"};
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

    Matrix& matrix(std::string const& field) {
        auto const it = case_.matrices.find(field);
        if (it == case_.matrices.end()) {
            throw Mistake{fmt::format("'{}' has not been assigned", field)};
        }
        return it->second.rows;
    }

    Part indices(Matrix const& of) {
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
        Matrix const list = expression();
        for (auto const& row : list) {
            for (double const v : row) {
                if (v < 1 || v > static_cast<double>(count) || v != std::floor(v)) {
                    throw Mistake{fmt::format("index {} is outside 1 to {}", v, count)};
                }
                out.push_back(static_cast<std::size_t>(v) - 1);
            }
        }
        return out;
    }

    Matrix expression() {
        Matrix left = term();
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

    Matrix term() {
        Matrix left = factor();
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

    Matrix factor() {
        skip();
        if (++nested_ > kDeepest) {
            throw Mistake{"brackets or signs are nested too deeply"};
        }
        Matrix value = signed_value();
        --nested_;
        return value;
    }

    Matrix signed_value() {
        if (peek() == '-') {
            ++at_;
            return combine(scalar(0), factor(), [](double a, double b) { return a - b; });
        }
        if (peek() == '+') {
            ++at_;
            return factor();
        }
        Matrix base = primary();
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

    Matrix primary() {
        skip();
        char const c = peek();
        if (c == '(') {
            ++at_;
            int const outer = std::exchange(depth_, 0);
            Matrix const inside = expression();
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
        if (double (*function)(double) = function_of(word); function != nullptr) {
            expect('(');
            Matrix const argument = expression();
            expect(')');
            return combine(argument, scalar(0), [&](double a, double) { return function(a); });
        }
        if (auto const it = column_names().find(word); it != column_names().end()) {
            return scalar(it->second);
        }
        if (auto const it = case_.scalars.find(word); it != case_.scalars.end()) {
            return scalar(it->second);
        }
        if (case_.matrices.contains(word)) {
            return selected(matrix(word));
        }
        throw Mistake{fmt::format("'{}' is not understood", word)};
    }

    Matrix selected(Matrix const& whole) {
        if (peek() != '(') {
            return whole;
        }
        Part const part = indices(whole);
        Matrix out;
        for (std::size_t const r : part.first) {
            out.emplace_back();
            for (std::size_t const c : part.second) {
                out.back().push_back(whole[r][c]);
            }
        }
        return out;
    }

    Matrix literal() {
        expect('[');
        ++depth_;
        Matrix rows{{}};
        std::vector<std::size_t> begins{at_};
        // Nearly all of a case is plain numbers, each followed by a separator: no expression is made of these.
        auto const digit_at = [&](std::size_t at) {
            return at < text_.size() && std::isdigit(static_cast<unsigned char>(text_[at])) != 0;
        };
        auto const begins_number = [&](std::size_t at) {
            return digit_at(at) || (at < text_.size() && text_[at] == '-' && digit_at(at + 1));
        };
        auto const plain = [&]() -> std::optional<double> {
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
            bool const ends =
                next < text_.size() && std::string_view{"\n;,]"}.find(text_[next]) != std::string_view::npos;
            if (!ends && !(next > end && begins_number(next))) {
                return std::nullopt;
            }
            at_ = end;
            return v;
        };
        while (true) {
            skip();
            char const c = peek();
            if (c == '\0') {
                at_ = begins.front();
                throw Mistake{"a '[' is not closed"};
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
                if (auto const v = plain()) {
                    rows.back().push_back(*v);
                    continue;
                }
                Matrix const element = expression();
                rows.back().insert(rows.back().end(), element[0].begin(), element[0].end());
            }
        }
        --depth_;
        if (rows.back().empty() && rows.size() > 1) {
            rows.pop_back();
        }
        rows_at_.clear();
        std::size_t counted = 0;
        int line = line_;
        for (std::size_t r = 0; r < rows.size(); ++r) {
            if (rows[r].size() != rows.front().size()) {
                at_ = begins[r];
                throw Mistake{
                    fmt::format("the matrix has rows of {} and of {} numbers", rows.front().size(), rows[r].size())};
            }
            for (; counted < begins[r]; ++counted) { // as line_of, but each character once
                line += text_[counted] == '\n' || text_[counted] == kContinued ? 1 : 0;
            }
            rows_at_.push_back(line);
        }
        return rows;
    }

    static double (*function_of(std::string const& word))(double) {
        if (word == "sin")
            return [](double v) { return std::sin(v); };
        if (word == "cos")
            return [](double v) { return std::cos(v); };
        if (word == "tan")
            return [](double v) { return std::tan(v); };
        if (word == "acos")
            return [](double v) { return std::acos(v); };
        if (word == "sqrt")
            return [](double v) { return std::sqrt(v); };
        return nullptr;
    }

    [[nodiscard]] int line_of(std::size_t at) const {
        auto const passed = text_.substr(0, std::min(at, text_.size()));
        return line_ + static_cast<int>(std::count_if(passed.begin(), passed.end(),
                                                      [](char c) { return c == '\n' || c == kContinued; }));
    }
    [[nodiscard]] char peek() const { return at_ < text_.size() ? text_[at_] : '\0'; }
    void skip() {
        while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r' ||
                                      text_[at_] == kContinued || (text_[at_] == '\n' && depth_ == 0))) {
            ++at_;
        }
    }
    void expect(char c) {
        skip();
        if (peek() != c) {
            throw Mistake{fmt::format("expected '{}' before '{}'", c, text_.substr(at_, 20))};
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
            throw Mistake{fmt::format("expected a name before '{}'", text_.substr(at_, 20))};
        }
        return std::string{text_.substr(start, at_ - start)};
    }
    double number() {
        double v = 0;
        auto const [end, error] = std::from_chars(text_.data() + at_, text_.data() + text_.size(), v);
        if (error != std::errc{}) {
            throw Mistake{"expected a number"};
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

MatlabCase read_matlab_case(std::string_view text, std::shared_ptr<config::SourceText const> const& source,
                            config::Diagnostics& diagnostics) {
    MatlabCase out;
    // Statements end with ';' or a line end, outside of brackets; '%' starts a comment, '...' continues a line.
    std::string statement;
    int depth = 0, start_line = 1, line_number = 0, comment_depth = 0;
    auto const finish = [&] {
        if (!trim(statement).empty()) {
            Statement evaluation{statement, start_line, out};
            try {
                evaluation.run();
            } catch (Mistake const& mistake) {
                diagnostics.error({source, evaluation.line(), 1},
                                  fmt::format("not understood in a case file: {}", mistake.what()),
                                  "matrices, numbers and unit conversions are; other MATLAB code is not");
            }
        }
        statement.clear();
    };
    for (std::string const& line : split(text, '\n')) {
        ++line_number;
        std::string_view const bare = trim(line);
        if (bare == "%{" || bare == "#{" || (comment_depth > 0 && (bare == "%}" || bare == "#}"))) {
            comment_depth += bare[1] == '{' ? 1 : -1;
            continue;
        }
        if (comment_depth > 0) {
            continue;
        }
        bool in_text = false;
        bool continued = false;
        for (std::size_t i = 0; i < line.size(); ++i) {
            char const c = line[i];
            if (c == '\'' &&
                (in_text || statement.empty() || std::isalnum(static_cast<unsigned char>(statement.back())) == 0)) {
                in_text = !in_text;
            }
            if (!in_text && (c == '%' || c == '#')) {
                break;
            }
            if (!in_text && line.compare(i, 3, "...") == 0) {
                continued = true;
                break;
            }
            if (!in_text && (c == '[' || c == '{' || c == '(')) {
                ++depth;
            }
            if (!in_text && (c == ']' || c == '}' || c == ')')) {
                --depth;
            }
            if (!in_text && c == ';' && depth == 0) {
                finish();
                continue;
            }
            if (trim(statement).empty()) {
                start_line = line_number;
            }
            statement.push_back(c);
        }
        if (continued) {
            statement.push_back(kContinued);
        } else {
            if (depth == 0) {
                finish();
            } else {
                statement.push_back('\n');
            }
        }
    }
    finish();
    return out;
}

} // namespace gridspace::sim
