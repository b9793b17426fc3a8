// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/iec61850/frame.hpp"
#include "gateways/scl/xml.hpp"

#include <map>
#include <optional>
#include <utility>

namespace gridspace::scl {

/// Where a control block is.
struct ControlPlace {
    std::string ied, access_point, ld_inst, block;
};

/// The SubNetworks' addresses by control block: files have thousands.
class Addresses {
  public:
    explicit Addresses(Element const& root);

    /// The GSE or SMV (`kind`) of a control block; null when there is none. One at another access point of the IED
    /// counts where its own has none: it serves the same logical devices (ServerAt).
    [[nodiscard]] Element const* find(ControlPlace const& place, char const* kind) const;

  private:
    std::map<std::string, std::vector<std::pair<std::string, Element const*>>> by_block_; ///< with the access point
};

/// "4021", with or without "0x".
[[nodiscard]] std::optional<unsigned> hexadecimal(std::string text);

/// "01-0C-CD-04-00-21" as the schema wants it, and the same with other separators or none.
[[nodiscard]] std::optional<iec61850::Mac> mac_of(std::string text);

} // namespace gridspace::scl
