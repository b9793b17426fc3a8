// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/iec61850/frame.hpp"

#include <array>
#include <chrono>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::ethernet {

enum class LinkState : std::uint8_t {
    up,      ///< carrier
    down,    ///< switched off or without carrier
    missing, ///< no such interface
    renamed, ///< it is there under another name
};
[[nodiscard]] std::string_view state_name(LinkState state) noexcept;

/// Looks at an interface by its name. `index`: what it was when it was opened (0: never).
[[nodiscard]] LinkState link_state(std::string const& interface, unsigned index = 0);

/// Waits for an interface that is not there yet: a board's may come after its programs. One that is down is not waited
/// for but for the moment that a carrier takes. Says so in the log when either takes long; whether it is there then,
/// opening it tells.
void wait_for_interface(std::string const& interface, std::chrono::milliseconds patience);

/// The kernel's index of an interface. The error names it and lists those that there are.
[[nodiscard]] Result<unsigned> interface_index(std::string const& interface);
[[nodiscard]] Result<iec61850::Mac> interface_mac(std::string const& interface);
/// Its first IPv4 address; nothing when it has none.
[[nodiscard]] std::optional<std::array<std::uint8_t, 4>> interface_ipv4(std::string const& interface);
[[nodiscard]] std::vector<std::string> interfaces();
/// Frames of any kind that the interface has received since it was made; nothing when the kernel does not say.
[[nodiscard]] std::optional<std::uint64_t> interface_received(std::string const& interface);
/// "veth", "bridge", ... of a virtual one, the driver ("e1000e") of another; empty when the kernel does not say.
[[nodiscard]] std::string interface_kind(std::string const& interface);

} // namespace gridspace::ethernet
