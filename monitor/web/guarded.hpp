// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/log.hpp"

#include <exception>

namespace gridspace::web {

/// False when `f` throws: whatever one client asks for, the others are served on.
template <class F>
bool guarded(char const* what, F&& f) {
    try {
        f();
        return true;
    } catch (std::exception const& error) {
        log::warning("{} failed: {}", what, error.what());
        return false;
    }
}

} // namespace gridspace::web
