// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/exit_code.hpp"

#include <expected>
#include <string>
#include <utility>

namespace gridspace {

/// A failure that the caller can act on or show: what happened, with names and values, and what to do about it.
struct Error {
    ExitCode code{ExitCode::usage};
    std::string message;
    std::string remedy; ///< one line that helps; empty when there is nothing better to say
};

template <class T>
using Result = std::expected<T, Error>;

inline std::unexpected<Error> fail(ExitCode code, std::string message, std::string remedy = {}) {
    return std::unexpected<Error>{Error{code, std::move(message), std::move(remedy)}};
}

/// "message; remedy", on one line.
inline std::string describe(Error const& error) {
    return error.remedy.empty() ? error.message : error.message + "; " + error.remedy;
}

} // namespace gridspace
