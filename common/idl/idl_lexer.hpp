// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

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
    explicit Lexer(std::string_view text) : text_{text} { advance(); }
    [[nodiscard]] Token const& peek() const { return token_; }
    Token take();
    bool accept(std::string_view sign); ///< takes the token when it is this sign or name
    void expect(std::string_view sign);
    std::string expect_name();

  private:
    void advance();
    void skip_blank();
    std::string_view text_;
    std::size_t at_{0};
    int line_{1};
    Token token_;
};

} // namespace gridspace::idl
