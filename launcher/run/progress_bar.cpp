// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/progress_bar.hpp"

#include <algorithm>
#include <string_view>

namespace gridspace::launcher {

std::string progress_bar(double share, int cells) {
    static constexpr std::string_view kEighths[] = {"", "▏", "▎", "▍", "▌", "▋", "▊", "▉"};
    auto const eighths = static_cast<int>(std::clamp(share, 0.0, 1.0) * cells * 8);
    std::string out;
    for (int i = 0; i < eighths / 8; ++i) {
        out += "█";
    }
    int used = eighths / 8;
    if (eighths % 8 != 0) {
        out += kEighths[eighths % 8];
        ++used;
    }
    return out + std::string(static_cast<std::size_t>(cells - used), ' ');
}

} // namespace gridspace::launcher
