// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/listening.hpp"

#include "monitor/web/listening.hpp"

namespace gridspace::launcher {

Result<ListeningSocket> open_listening(std::string const& where) {
    auto socket = web::listen_at(where);
    if (!socket) {
        return std::unexpected{socket.error()};
    }
    std::string address = web::address_of(*socket);
    return ListeningSocket{std::move(*socket), std::move(address)};
}

} // namespace gridspace::launcher
