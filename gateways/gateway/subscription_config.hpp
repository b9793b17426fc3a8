// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/fields.hpp"
#include "common/program/declaration.hpp"
#include "gateways/streams/stream.hpp"

#include <string>
#include <vector>

namespace gridspace::gateways {

using config::Ref;

/// A stream that a gateway hears and supervises, and nothing more.
struct SubscriptionConfig {
    Ref name;
    Ref stream;              ///< of `streams:`; its name where it is not given
    bool accept_test{false}; ///< LPHD.Sim: take simulated messages, instead of real ones
    std::vector<Ref> watch;  ///< members whose values are signals
};
void describe(config::Fields& f, std::vector<SubscriptionConfig>& subscriptions);

/// Whether a member of this type is a signal: a number, or counted like one.
[[nodiscard]] bool can_be_watched(iec61850::BasicType type);

/// Everything that is wrong, at its place in the file.
void check_subscriptions(std::vector<SubscriptionConfig> const& subscriptions,
                         std::vector<streams::Stream> const& streams, config::Diagnostics& diagnostics);

/// Its signals in the order of their columns: `subscription.{process}.NAME.alive`, …, and the watched members.
[[nodiscard]] std::vector<program::Signal> subscription_signals(SubscriptionConfig const& config,
                                                                streams::Stream const& stream);
/// The watched members as places among the leaves of the data set.
[[nodiscard]] std::vector<std::size_t> watched_leaves(SubscriptionConfig const& config, streams::Stream const& stream);

} // namespace gridspace::gateways
