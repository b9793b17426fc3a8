// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <filesystem>
#include <string>

namespace gridspace::launcher {

/// What came of an answer.
struct Answer {
    std::string text;
    bool silent{false}; ///< the socket's patience was over before the other side had ended
};

/// Sends a request over a connected socket with TLS and reads until the other side has said everything. Whoever shows
/// another certificate than `certificate` (PEM; or one that it vouches for) is not talked to; names are not looked at.
[[nodiscard]] Result<Answer> exchange_by_tls(int socket, std::filesystem::path const& certificate,
                                             std::string const& request);

} // namespace gridspace::launcher
