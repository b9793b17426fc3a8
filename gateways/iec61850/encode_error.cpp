// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/encode_error.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::iec61850 {

Result<void> check_visible(std::string_view what, std::string_view text, std::size_t limit) {
    if (text.empty()) {
        return unencodable(fmt::format("{} is empty", what), fmt::format("1 to {} characters", limit));
    }
    if (text.size() > limit) {
        return unencodable(fmt::format("{} has {} characters", what, text.size()), fmt::format("at most {}", limit));
    }
    if (std::any_of(text.begin(), text.end(), [](char c) { return c < 0x20 || c > 0x7E; })) {
        return unencodable(fmt::format("{} has a character that is not visible ASCII", what));
    }
    return {};
}

} // namespace gridspace::iec61850
