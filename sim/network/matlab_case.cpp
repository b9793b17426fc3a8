// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/network/matlab_case.hpp"

#include "common/text.hpp"
#include "sim/network/matlab_statement.hpp"

#include <cctype>
#include <fmt/format.h>

namespace gridspace::sim {

MatlabCase read_matlab_case(std::string_view text, std::shared_ptr<config::SourceText const> const& source,
                            config::Diagnostics& diagnostics) {
    MatlabCase out;
    // Statements end with ';' or a line end, outside of brackets; '%' starts a comment, '...' continues a line.
    std::string statement;
    int depth = 0, start_line = 1, line_number = 0, comment_depth = 0;
    auto const finish = [&] {
        if (!trim(statement).empty()) {
            if (auto const mistake = run_matlab_statement(statement, start_line, out)) {
                diagnostics.error({source, mistake->line, 1},
                                  fmt::format("not understood in a case file: {}", mistake->what),
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
            statement.push_back(kMatlabContinued);
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
