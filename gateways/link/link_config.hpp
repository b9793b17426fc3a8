// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "gateways/link/impairment.hpp"
#include "gateways/streams/stream.hpp"

#include <vector>

namespace gridspace::gateways {

/// Impairments of one cable.
struct LinkConfig {
    std::vector<config::Ref> between; ///< a host and a link
    enum class Direction { from_host, to_host, both } direction{Direction::from_host};
    std::vector<config::Ref> streams; ///< only these; empty: all frames of SMV and GOOSE
    Impairments impairments;
    struct NamedSample {
        config::Ref name, stream;
        SampleImpairment impairment; ///< its stream is found by make_plan()
    };
    std::vector<NamedSample> samples;
};
void describe(config::Fields& f, LinkConfig& config);

/// Finds the streams that it names among the declared ones; otherwise errors where they are named.
[[nodiscard]] ImpairmentPlan make_plan(LinkConfig const& config, std::vector<streams::Stream> const& declared,
                                       config::Diagnostics& diagnostics);

} // namespace gridspace::gateways
