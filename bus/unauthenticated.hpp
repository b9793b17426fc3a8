// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <functional>
#include <string>

namespace gridspace::bus {

/// Who wanted to join a secured bus and could not show who he is, as a line of text; once each, on threads of DDS. One
/// handler for all participants of this process; setting another waits for a call that is under way.
using UnauthenticatedHandler = std::function<void(std::string const& text)>;
void on_unauthenticated(UnauthenticatedHandler handler);

/// By participants: calls the handler, and logs where there is none.
void tell_unauthenticated(std::string const& text);

} // namespace gridspace::bus
