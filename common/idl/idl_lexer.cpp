// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/idl_lexer.hpp"

#include <cctype>
#include <sstream>

namespace gridspace::idl {
namespace {

bool is_letter(char c) {
    return std::isalpha(static_cast<unsigned char>(c)) != 0 || c == '_';
}
bool is_digit(char c) {
    return std::isdigit(static_cast<unsigned char>(c)) != 0;
}

} // namespace

void Lexer::skip_blank() {
    while (at_ < text_.size()) {
        if (text_[at_] == '\n') {
            ++line_;
            ++at_;
        } else if (std::isspace(static_cast<unsigned char>(text_[at_])) != 0) {
            ++at_;
        } else if (text_.compare(at_, 2, "//") == 0) {
            while (at_ < text_.size() && text_[at_] != '\n') {
                ++at_;
            }
        } else if (text_.compare(at_, 2, "/*") == 0) {
            std::size_t const end = text_.find("*/", at_ + 2);
            if (end == std::string_view::npos) {
                throw SyntaxError{line_, "a comment is not closed"};
            }
            for (; at_ < end + 2; ++at_) {
                line_ += text_[at_] == '\n' ? 1 : 0;
            }
        } else if (text_[at_] == '#' && skips_directives_) {
            skip_directive();
        } else {
            return;
        }
    }
}

void Lexer::skip_directive() {
    std::size_t const start = at_;
    while (at_ < text_.size() && (text_[at_] != '\n' || text_[at_ - 1] == '\\')) {
        line_ += text_[at_] == '\n' ? 1 : 0;
        ++at_;
    }
    std::istringstream words{std::string{text_.substr(start + 1, at_ - start - 1)}};
    std::string directive, name, value;
    words >> directive >> name >> value;
    includes_ = includes_ || directive == "include";
    if (directive == "define" && !value.empty()) {
        defined_[name] = value;
    }
}

void Lexer::advance() {
    skip_blank();
    token_ = {Token::Kind::end, "", line_};
    if (at_ >= text_.size()) {
        return;
    }
    char const c = text_[at_];
    std::size_t const start = at_;
    if (c == '#') {
        throw SyntaxError{line_, "preprocessor lines are not supported: one self-contained text is needed"};
    }
    if (is_letter(c)) {
        while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]))) {
            ++at_;
        }
        token_.kind = Token::Kind::name;
    } else if (is_digit(c)) {
        while (at_ < text_.size() && (is_letter(text_[at_]) || is_digit(text_[at_]) || text_[at_] == '.')) {
            ++at_;
        }
        token_.kind = Token::Kind::number;
    } else if (c == '"' || c == '\'') {
        std::size_t const end = text_.find(c, at_ + 1);
        if (end == std::string_view::npos) {
            throw SyntaxError{line_, "a text is not closed"};
        }
        at_ = end + 1;
        token_.kind = Token::Kind::text;
    } else {
        at_ += text_.compare(at_, 2, "::") == 0 ? 2 : 1;
        token_.kind = Token::Kind::sign;
    }
    token_.text = std::string{text_.substr(start, at_ - start)};
}

Token Lexer::take() {
    Token out = token_;
    advance();
    return out;
}

bool Lexer::accept(std::string_view sign) {
    if (token_.kind == Token::Kind::end || token_.text != sign) {
        return false;
    }
    advance();
    return true;
}

void Lexer::expect(std::string_view sign) {
    if (!accept(sign)) {
        throw SyntaxError{token_.line, "expected '" + std::string{sign} + "' before '" + token_.text + "'"};
    }
}

std::string Lexer::expect_name() {
    if (token_.kind != Token::Kind::name) {
        throw SyntaxError{token_.line, "expected a name before '" + token_.text + "'"};
    }
    return take().text;
}

} // namespace gridspace::idl
