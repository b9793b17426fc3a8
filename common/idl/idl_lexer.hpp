// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <map>
#include <stdexcept>
#include <string>
#include <string_view>

namespace gridspace::idl {

struct SyntaxError : std::runtime_error {
    SyntaxError(int at_line, std::string const& what) : std::runtime_error{what}, line{at_line} {}
    int line;
};

struct Token {
    enum class Kind { end, name, number, text, sign } kind{Kind::end};
    std::string text;
    int line{1};
};

/// Splits IDL into names, numbers, quoted texts and signs ("::" is one sign); comments are skipped.
class Lexer {
  public:
    /// `skips_directives`: instead of refusing lines for the preprocessor.
    Lexer(std::string_view text, bool skips_directives) : text_{text}, skips_directives_{skips_directives} {
        advance();
    }
    [[nodiscard]] Token const& peek() const { return token_; }
    Token take();
    bool accept(std::string_view sign); ///< takes the token when it is this sign or name
    void expect(std::string_view sign);
    std::string expect_name();
    [[nodiscard]] std::map<std::string, std::string> const& defined() const { return defined_; } ///< by #define, so far
    [[nodiscard]] bool includes() const { return includes_; }                                    ///< another file

  private:
    void advance();
    void skip_blank();
    void skip_directive();
    std::string_view text_;
    bool skips_directives_, includes_{false};
    std::map<std::string, std::string> defined_;
    std::size_t at_{0};
    int line_{1};
    Token token_;
};

} // namespace gridspace::idl
