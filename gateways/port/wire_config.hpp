// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/streams/stream.hpp"

#include <optional>
#include <string>
#include <vector>

namespace gridspace::gateways {

/// A place on a link.
struct WirePlace {
    std::string link;         ///< name of the link in the scenario; free without one
    std::string receive_link; ///< where frames come from, when something sits in the cable; otherwise empty
    std::string interface;    ///< network interface
};

/// Where a process is on the wire, and the streams that it knows. Written by `gridspace run`; by hand for a device of
/// its own.
struct WireConfig : WirePlace {
    std::optional<WirePlace>
        lan_b;       ///< a doubly attached node of PRP: the other network; the place itself is on network A
    double speed{1}; ///< of the simulation clock in real time: streams run so much faster than their rate
    std::vector<streams::Stream> streams;

    /// The place, and with PRP that on network B.
    [[nodiscard]] std::vector<WirePlace const*> places() const {
        return lan_b ? std::vector<WirePlace const*>{this, &*lan_b} : std::vector<WirePlace const*>{this};
    }
};
/// Keys `wire: {link, interface, prp_lan_b}` and `streams:`.
void describe_wire(config::Fields& f, WireConfig& wire);

/// Finds the stream that `ref` names, of this kind; otherwise an error at `ref`.
[[nodiscard]] streams::Stream const* stream_of(std::vector<streams::Stream> const& declared, config::Ref const& ref,
                                               streams::Kind kind, config::Diagnostics& diagnostics);

} // namespace gridspace::gateways
