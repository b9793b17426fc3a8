// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/breaker/breaker_config.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {

void describe(config::Fields& f, BreakerConfig& config) {
    using OnLoss = BreakerConfig::OnLoss;
    f.reference("from", config.from, {.doc = "stream and member of its data set, as STREAM.member", .required = true});
    f.reference("to", config.to, {.doc = "DDS topic of trip commands", .required = true});
    f.choice<OnLoss>("on_loss", config.on_loss, {{"hold", OnLoss::hold}, {"open", OnLoss::open}},
                     {.doc = "what a lost stream does: nothing, or open"});
    f.flag("accept_test", config.accept_test, {.doc = "act on messages that are marked as simulated"});
    describe(f, config.first_line);
    f.fraction(
        "latency_us", config.latency_us,
        {.doc = "from the message to the effect of the command; in real time it takes effect no sooner", .min = 0});
    if (!config.from.empty() && config.field().empty()) {
        f.error("from", fmt::format("'{}' names no member", config.from.name),
                "expected STREAM.member, for example TRIP2.status");
    }
}

} // namespace gridspace::gateways
