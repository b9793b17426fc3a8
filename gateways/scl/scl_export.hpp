// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/streams/stream.hpp"

namespace gridspace::scl {

/// Writes the streams as an SCL file (schema 2007B4): an IED for each logical-device name, its control blocks, data
/// sets and types. Members become data objects of a GGIO, structures whole data objects. Fails for what SCL has no
/// words for (arrays, octet and bit strings, entry times), naming the stream and the member. Streams of a device that
/// name the same data set share it; fails when they mean different ones by it.
[[nodiscard]] Result<std::string> export_streams(std::vector<streams::Stream> const& streams, std::string const& id);

} // namespace gridspace::scl
