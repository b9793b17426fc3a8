// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

namespace gridspace::iec61850 {

/// What we send is strict: a stream that cannot be written as the standard says is a mistake in its description.
inline std::unexpected<Error> unencodable(std::string message, std::string remedy = {}) {
    return fail(ExitCode::usage, std::move(message), std::move(remedy));
}

/// Visible characters only, 1 to `limit` of them; otherwise a message that names `what`.
[[nodiscard]] Result<void> check_visible(std::string_view what, std::string_view text, std::size_t limit);

} // namespace gridspace::iec61850
