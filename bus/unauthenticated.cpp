// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/unauthenticated.hpp"

#include "common/log.hpp"

#include <mutex>
#include <utility>

namespace gridspace::bus {
namespace {

struct Told {
    std::mutex mutex; ///< also while the handler is called
    UnauthenticatedHandler handler;
};
Told& told() {
    static Told the;
    return the;
}

} // namespace

void on_unauthenticated(UnauthenticatedHandler handler) {
    std::lock_guard const lock{told().mutex};
    told().handler = std::move(handler);
}

void tell_unauthenticated(std::string const& text) {
    log::warning("{}", text);
    std::lock_guard const lock{told().mutex};
    if (told().handler) {
        told().handler(text);
    }
}

} // namespace gridspace::bus
