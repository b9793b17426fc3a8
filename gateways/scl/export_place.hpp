// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "gateways/streams/stream.hpp"

#include <string>
#include <utility>
#include <vector>

namespace gridspace::scl {

/// Where a stream stands in the model of an SCL file.
struct Place {
    std::string ied, inst, ld_name; ///< ld_name: empty when it is ied + inst
    std::string block, data_set;
};

/// A stream that cannot be written, and why. The message goes on after its name: "the member 'x' is …".
struct Refusal {
    config::Ref stream;
    Error why;
};

struct Placed {
    std::vector<std::pair<streams::Stream const*, Place>> streams; ///< those that can be written
    std::vector<Refusal> refused;
};

/// Places the streams, and refuses those for which SCL has no words. What a frame carries (gocbRef, datSet) is never
/// renamed: it must come out of the file as it is sent, so a name that SCL does not allow, or that two streams of a
/// device have, is refused. What no frame carries (device and control block of sampled values) is made up.
/// The result points into `streams`.
[[nodiscard]] Placed place_streams(std::vector<streams::Stream> const& streams);

} // namespace gridspace::scl
