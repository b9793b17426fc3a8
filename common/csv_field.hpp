// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>

namespace gridspace {

/// A field of a CSV file: quoted where it has to be (RFC 4180, 2).
[[nodiscard]] inline std::string csv_field(std::string text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) {
        return text;
    }
    std::string out = "\"";
    for (char const c : text) {
        out += c == '"' ? "\"\"" : std::string{c};
    }
    return out + "\"";
}

} // namespace gridspace
