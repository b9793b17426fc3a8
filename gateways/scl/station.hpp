// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/scl/scl_import.hpp"

namespace gridspace::scl {

/// A device of the file.
struct Ied {
    std::string name, manufacturer, type;
    config::SourceMark where;
};

/// A stream that an IED hears: by ExtRefs of its inputs, or by a supervision (LGOS, LSVS) alone.
struct StreamSubscription {
    std::string ied;
    std::size_t block{0};             ///< of Import::blocks
    std::vector<std::string> members; ///< those that ExtRefs name, in the order of the data set
    std::size_t ext_refs{0};
    std::string supervisor; ///< "LD0/LGOS1"; empty: none
};

/// What an SCL file says of a station: who sends what, and who hears it.
struct Station {
    Import import; ///< of all IEDs, with the findings of everything
    std::vector<Ied> ieds;
    std::vector<StreamSubscription> subscriptions; ///< by IED in the order of the file, then by stream
};

/// Reads control blocks and subscriptions of all IEDs. ExtRefs of every edition: with a control block (srcCBName), with
/// serviceType alone, or with neither, which are then looked for in the data sets of the publisher.
[[nodiscard]] Result<Station> read_station(Document const& document, double nominal_hz);

} // namespace gridspace::scl
