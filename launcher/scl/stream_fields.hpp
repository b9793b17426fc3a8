// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "gateways/scl/scl_import.hpp"
#include "gateways/streams/stream.hpp"

namespace gridspace::launcher {

/// `fields:` of a mapping from the samples of a bay: currents and voltages by phase, scaled as the file says (sVC) or
/// 9-2LE does. `source`: "samples" for `each`, "samples.19" for a sample of a message. Empty: nothing fits.
[[nodiscard]] config::Node sampled_fields(scl::ControlBlock const& block, streams::Stream const& stream,
                                          std::string const& source);

/// `fields:` of a mapping without a source: a closed breaker, no trip, good quality, behaviour on.
[[nodiscard]] config::Node constant_fields(scl::ControlBlock const& block, streams::Stream const& stream);

} // namespace gridspace::launcher
