// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <string>
#include <string_view>

namespace gridspace::cable {

/// An interface of a host: its name, MAC address, and "10.10.0.4/24", or "-" where it carries no IP.
struct Port {
    std::string name, mac, address;
};

/// "process_bus,02:47:53:02:00:04,-"
[[nodiscard]] Result<Port> parse_port(std::string_view text);

/// Opens a tap device of the present network namespace, which is made if it does not exist. Not blocking.
[[nodiscard]] Result<int> open_tap(std::string const& name);

/// Gives an interface the MAC and IP address of a port and switches it on; also the loopback interface, with "" for
/// both.
[[nodiscard]] Result<void> configure(Port const& port);

} // namespace gridspace::cable
