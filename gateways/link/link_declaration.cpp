// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/link/link_declaration.hpp"

#include "gateways/link/link_config.hpp"

namespace gridspace::gateways {

program::Declaration link_declaration() {
    program::Declaration out{.name = "gridspace-link",
                             .description = "impairments of the cable between a host and a switch",
                             .settings = config::keys_of<LinkConfig>()};
    for (char const* name : kLinkCounters) {
        out.signals.push_back({std::string{"link.{process}."} + name, "", 1});
    }
    return out;
}

} // namespace gridspace::gateways
