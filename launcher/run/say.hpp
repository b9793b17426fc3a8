// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdio>
#include <fmt/format.h>
#include <string>
#include <utility>

namespace gridspace {

/// Prints on standard output or standard error, and never throws as fmt::print does: a run goes on, and its report is
/// written, when its terminal is closed, its disk is full or nobody reads its pipe any more. `std::ferror` knows of it.
template <class... A>
void say(std::FILE* stream, fmt::format_string<A...> format, A&&... arguments) {
    std::string const text = fmt::format(format, std::forward<A>(arguments)...);
    (void)std::fwrite(text.data(), 1, text.size(), stream);
}

} // namespace gridspace
