// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/unique_fd.hpp"

#include <string>

namespace gridspace::web {

/// A TCP socket listening at "127.0.0.1:8080"; port 0 is a free one.
[[nodiscard]] Result<UniqueFd> listen_at(std::string const& where);
/// "127.0.0.1:8080" of a listening socket.
[[nodiscard]] std::string address_of(UniqueFd const& listening);
/// Only programs of this machine reach an address of 127.0.0.0/8.
[[nodiscard]] bool is_loopback(std::string const& where);

/// A server that other machines can reach asks for a token, and the token does not cross a network in clear.
[[nodiscard]] Result<void> check_exposure(std::string const& where, bool token, bool tls);

} // namespace gridspace::web
