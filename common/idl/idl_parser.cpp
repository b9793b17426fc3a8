// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/idl_lexer.hpp"
#include "common/idl/idl_model.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::idl {
namespace {

constexpr std::uint32_t kLargestBound = 1U << 24U;
constexpr int kDeepest = 64; ///< modules and sequences in each other; a file of nothing but '{' must not end the stack

class Parser {
  public:
    Parser(std::string_view text, Unsupported unsupported)
        : lexer_{text, unsupported == Unsupported::kept}, keeps_{unsupported == Unsupported::kept} {}

    Model run() {
        while (lexer_.peek().kind != Token::Kind::end) {
            definition();
        }
        return std::move(model_);
    }

  private:
    /// What a decoder must know of the annotations before a definition or a member.
    struct Annotations {
        bool key{false};
        std::uint32_t bit_bound{32};
        std::string unsupported; ///< one that changes how samples are written
    };
    Annotations annotations() {
        Annotations out;
        while (lexer_.accept("@")) {
            int const line = lexer_.peek().line;
            std::string name = lexer_.expect_name();
            while (lexer_.accept("::")) {
                name = lexer_.expect_name();
            }
            Token value;
            if (lexer_.accept("(")) {
                value = lexer_.peek();
                for (int depth = 1; depth > 0;) {
                    Token const token = lexer_.take();
                    if (token.kind == Token::Kind::end) {
                        throw SyntaxError{token.line, "an annotation is not closed"};
                    }
                    depth += token.text == "(" ? 1 : token.text == ")" ? -1 : 0;
                }
            }
            bool const off = value.text == "FALSE" || value.text == "false";
            out.key = out.key || (name == "key" && !off);
            if (name == "bit_bound" && value.kind == Token::Kind::number) {
                out.bit_bound = to_number(value);
            }
            if ((name == "optional" && !off) || name == "mutable" ||
                (name == "extensibility" && value.text == "MUTABLE")) {
                out.unsupported =
                    fmt::format("line {}: @{} is not supported", line, name == "optional" ? name : "mutable");
            }
        }
        return out;
    }

    /// A type that is known by name alone; refused where such types are.
    std::size_t unsupported(int line, std::string const& what, std::string name = {}) {
        if (!keeps_) {
            throw SyntaxError{line, what};
        }
        Type type;
        type.kind = Kind::unsupported;
        type.name = std::move(name);
        type.unsupported = fmt::format("line {}: {}", line, what);
        return type.name.empty() ? add(std::move(type)) : define(std::move(type));
    }

    /// `<...>` or `{...}` with all that is between, if it is next.
    void skip_balanced(std::string_view open, std::string_view close) {
        int depth = 0;
        do {
            Token const token = lexer_.peek();
            if (depth == 0 && token.text != open) {
                return;
            }
            if (token.kind == Token::Kind::end) {
                throw SyntaxError{token.line, fmt::format("a '{}' is not closed", open)};
            }
            depth += token.text == open ? 1 : token.text == close ? -1 : 0;
            lexer_.take();
        } while (depth > 0);
    }

    void unsupported_definition() {
        Token const word = lexer_.take();
        std::string const name = lexer_.expect_name();
        while (lexer_.peek().text != "{" && lexer_.peek().text != ";" && lexer_.peek().kind != Token::Kind::end) {
            lexer_.take(); // of a union what it switches on
        }
        if (lexer_.peek().text == "{") {
            unsupported(word.line, fmt::format("'{}' is not supported", word.text), scoped(name));
        }
        skip_balanced("{", "}");
    }

    void definition() {
        Annotations const annotated = annotations();
        Token const word = lexer_.peek();
        if (lexer_.accept(";")) {
            return;
        }
        if (lexer_.accept("module")) {
            scope_.push_back(lexer_.expect_name());
            if (scope_.size() > kDeepest) {
                throw SyntaxError{word.line, "modules are nested too deeply"};
            }
            lexer_.expect("{");
            while (!lexer_.accept("}")) {
                if (lexer_.peek().kind == Token::Kind::end) {
                    throw SyntaxError{lexer_.peek().line, fmt::format("module '{}' is not closed", scope_.back())};
                }
                definition();
            }
            scope_.pop_back();
        } else if (lexer_.accept("struct")) {
            structure(annotated);
        } else if (lexer_.accept("enum")) {
            enumeration(annotated);
        } else if (lexer_.accept("const")) {
            constant();
        } else if (lexer_.accept("typedef")) {
            std::size_t const type = type_spec();
            do {
                std::string const name = lexer_.expect_name();
                typedefs_[scoped(name)] = array_of(type);
            } while (lexer_.accept(","));
        } else if (keeps_ && (word.text == "union" || word.text == "bitmask" || word.text == "bitset")) {
            unsupported_definition();
        } else {
            throw SyntaxError{word.line, fmt::format("'{}' is not supported", word.text)};
        }
        lexer_.accept(";");
    }

    void structure(Annotations const& annotated) {
        Type type;
        type.kind = Kind::structure;
        type.unsupported = annotated.unsupported;
        std::string const name = lexer_.expect_name();
        type.name = scoped(name);
        if (lexer_.accept(";")) {
            return; // forward declaration
        }
        if (lexer_.accept(":")) {
            std::size_t const base = named_type();
            cannot_be_decoded(type, model_.types[base].unsupported);
            if (model_.types[base].kind != Kind::structure && model_.types[base].kind != Kind::unsupported) {
                throw SyntaxError{lexer_.peek().line, fmt::format("'{}' inherits from what is not a struct", name)};
            }
            type.members = model_.types[base].members;
        }
        lexer_.expect("{");
        while (!lexer_.accept("}")) {
            Annotations const of_member = annotations();
            cannot_be_decoded(type, of_member.unsupported);
            std::size_t const member_type = type_spec();
            do {
                std::string const member = lexer_.expect_name();
                type.members.push_back({member, array_of(member_type), of_member.key});
                cannot_be_decoded(type, model_.types[type.members.back().type].unsupported);
            } while (lexer_.accept(","));
            lexer_.expect(";");
        }
        define(std::move(type));
    }

    /// The first reason is kept.
    static void cannot_be_decoded(Type& type, std::string const& reason) {
        type.unsupported = type.unsupported.empty() ? reason : type.unsupported;
    }

    void enumeration(Annotations const& annotated) {
        Type type;
        type.kind = Kind::enumeration;
        type.octets = annotated.bit_bound <= 8 ? 1 : annotated.bit_bound <= 16 ? 2 : 4;
        type.name = scoped(lexer_.expect_name());
        lexer_.expect("{");
        std::int32_t next = 0;
        while (!lexer_.accept("}")) {
            if (lexer_.accept("@")) { // @value(n)
                std::string const annotation = lexer_.expect_name();
                if (lexer_.accept("(")) {
                    std::uint32_t const value = number();
                    lexer_.expect(")");
                    next = annotation == "value" ? static_cast<std::int32_t>(value) : next;
                }
                continue;
            }
            type.values.emplace_back(lexer_.expect_name(), next++);
            lexer_.accept(",");
        }
        define(std::move(type));
    }

    void constant() {
        type_spec();
        std::string const name = lexer_.expect_name();
        lexer_.expect("=");
        Token const first = lexer_.take();
        if (first.kind == Token::Kind::number) {
            constants_[scoped(name)] = to_number(first);
        }
        while (lexer_.peek().kind != Token::Kind::end && lexer_.peek().text != ";") {
            lexer_.take(); // texts and expressions: nothing that a bound can use
        }
    }

    std::size_t type_spec() {
        Token const word = lexer_.peek();
        std::optional<Kind> kind;
        if (lexer_.accept("unsigned")) {
            kind = lexer_.accept("short") ? Kind::uint16 : long_kind(true);
        } else if (lexer_.accept("long")) {
            kind = lexer_.accept("long") ? Kind::int64 : Kind::int32;
            if (lexer_.accept("double")) {
                return unsupported(word.line, "long double is not supported");
            }
        } else if (keeps_ && (lexer_.accept("wstring") || lexer_.accept("wchar") || lexer_.accept("map") ||
                              lexer_.accept("fixed") || lexer_.accept("any"))) {
            skip_balanced("<", ">");
            return unsupported(word.line, fmt::format("'{}' is not supported", word.text));
        } else if (lexer_.accept("sequence")) {
            return sequence();
        } else if (lexer_.accept("string")) {
            Type type;
            type.kind = Kind::string;
            if (lexer_.accept("<")) {
                type.bound = number();
                lexer_.expect(">");
            }
            return add(std::move(type));
        } else {
            static std::map<std::string, Kind, std::less<>> const words{
                {"boolean", Kind::boolean}, {"octet", Kind::octet},    {"uint8", Kind::octet},
                {"char", Kind::character},  {"int8", Kind::int8},      {"short", Kind::int16},
                {"int16", Kind::int16},     {"uint16", Kind::uint16},  {"int32", Kind::int32},
                {"uint32", Kind::uint32},   {"int64", Kind::int64},    {"uint64", Kind::uint64},
                {"float", Kind::float32},   {"double", Kind::float64},
            };
            if (auto const it = words.find(word.text); it != words.end()) {
                lexer_.take();
                kind = it->second;
            }
        }
        if (!kind) {
            return named_type();
        }
        Type type;
        type.kind = *kind;
        return add(std::move(type));
    }

    Kind long_kind(bool is_unsigned) {
        lexer_.expect("long");
        bool const wide = lexer_.accept("long");
        return wide ? (is_unsigned ? Kind::uint64 : Kind::int64) : (is_unsigned ? Kind::uint32 : Kind::int32);
    }

    std::size_t sequence() {
        Type type;
        type.kind = Kind::sequence;
        lexer_.expect("<");
        if (++nested_ > kDeepest) {
            throw SyntaxError{lexer_.peek().line, "sequences are nested too deeply"};
        }
        type.element = type_spec();
        --nested_;
        if (lexer_.accept(",")) {
            type.bound = number();
        }
        lexer_.expect(">");
        return add(std::move(type));
    }

    /// [n][m] after a name; the last bound is the innermost.
    std::size_t array_of(std::size_t element) {
        std::vector<std::uint32_t> bounds;
        while (lexer_.accept("[")) {
            bounds.push_back(number());
            lexer_.expect("]");
        }
        for (auto bound = bounds.rbegin(); bound != bounds.rend(); ++bound) {
            Type type;
            type.kind = Kind::array;
            type.element = element;
            type.bound = *bound;
            element = add(std::move(type));
        }
        return element;
    }

    std::size_t named_type() {
        int const line = lexer_.peek().line;
        std::string name;
        lexer_.accept("::");
        do {
            name += (name.empty() ? "" : "::") + lexer_.expect_name();
        } while (lexer_.accept("::"));
        // From the innermost module outwards.
        for (std::size_t depth = scope_.size() + 1; depth-- > 0;) {
            std::string full;
            for (std::size_t i = 0; i < depth; ++i) {
                full += scope_[i] + "::";
            }
            full += name;
            if (auto const it = typedefs_.find(full); it != typedefs_.end()) {
                return it->second;
            }
            if (auto const found = model_.find(full)) {
                return *found;
            }
        }
        if (lexer_.includes()) {
            return unsupported(line, fmt::format("the type '{}' is not known, and #include is not followed", name));
        }
        throw SyntaxError{line, fmt::format("the type '{}' is not known", name)};
    }

    std::uint32_t number() {
        Token const token = lexer_.take();
        if (token.kind == Token::Kind::number) {
            return to_number(token);
        }
        if (auto const it = lexer_.defined().find(token.text); it != lexer_.defined().end()) {
            return to_number({Token::Kind::number, it->second, token.line});
        }
        for (std::size_t depth = scope_.size() + 1; depth-- > 0;) {
            std::string full;
            for (std::size_t i = 0; i < depth; ++i) {
                full += scope_[i] + "::";
            }
            if (auto const it = constants_.find(full + token.text); it != constants_.end()) {
                return it->second;
            }
        }
        throw SyntaxError{token.line, fmt::format("'{}' is not a number", token.text)};
    }

    static std::uint32_t to_number(Token const& token) {
        std::string_view digits = token.text;
        int base = 10;
        if (digits.starts_with("0x") || digits.starts_with("0X")) {
            digits.remove_prefix(2);
            base = 16;
        }
        std::uint32_t value = 0;
        auto const [end, error] = std::from_chars(digits.data(), digits.data() + digits.size(), value, base);
        if (error != std::errc{} || end != digits.data() + digits.size() || value > kLargestBound) {
            throw SyntaxError{token.line, fmt::format("'{}' is not a number from 0 to {}", token.text, kLargestBound)};
        }
        return value;
    }

    std::string scoped(std::string const& name) const {
        std::string out;
        for (std::string const& part : scope_) {
            out += part + "::";
        }
        return out + name;
    }

    std::size_t add(Type type) {
        if (type.kind == Kind::sequence || type.kind == Kind::array) {
            type.unsupported = model_.types[type.element].unsupported;
        }
        model_.types.push_back(std::move(type));
        return model_.types.size() - 1;
    }
    std::size_t define(Type type) {
        if (model_.find(type.name)) {
            throw SyntaxError{lexer_.peek().line, fmt::format("'{}' is defined twice", type.name)};
        }
        return add(std::move(type));
    }

    Lexer lexer_;
    bool keeps_; ///< what is not supported
    Model model_;
    std::vector<std::string> scope_;
    int nested_{0}; ///< sequences
    std::map<std::string, std::size_t> typedefs_;
    std::map<std::string, std::uint32_t> constants_;
};

} // namespace

std::optional<std::size_t> Model::find(std::string_view name) const {
    for (std::size_t i = 0; i < types.size(); ++i) {
        bool const named = types[i].kind == Kind::structure || types[i].kind == Kind::enumeration ||
                           (types[i].kind == Kind::unsupported && !types[i].name.empty());
        if (named && types[i].name == name) {
            return i;
        }
    }
    return std::nullopt;
}

bool Model::is_keyed(std::size_t type) const {
    return std::any_of(types[type].members.begin(), types[type].members.end(), [](auto const& m) { return m.key; });
}

Result<Model> parse(std::string_view text, Unsupported unsupported) {
    try {
        return Parser{text, unsupported}.run();
    } catch (SyntaxError const& e) {
        return fail(ExitCode::usage, fmt::format("IDL line {}: {}", e.line, e.what()));
    }
}

} // namespace gridspace::idl
