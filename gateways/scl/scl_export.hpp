// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/scl/export_place.hpp"

namespace gridspace::scl {

struct Export {
    std::string text;             ///< an SCL file (schema 2007B4) of all streams but the refused ones
    std::vector<Refusal> refused; ///< those for which SCL has no words
};

/// Writes the streams as an SCL file: an IED for each logical-device name, its control blocks, data sets and types.
/// Members become data objects of a GGIO, structures whole data objects, arrays attributes with a count. Streams of a
/// device that name the same data set share it.
[[nodiscard]] Export export_streams(std::vector<streams::Stream> const& streams, std::string const& id);

} // namespace gridspace::scl
