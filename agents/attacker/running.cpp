// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/running.hpp"

#include "agents/attacker/frame_forger.hpp"
#include "agents/attacker/goose_forger.hpp"

#include <fmt/format.h>

namespace gridspace::attacker {
namespace {

/// Puts what was made into its place.
template <class Made, class Place>
Result<void> keep(Result<Made> made, Place& place) {
    if (!made) {
        return std::unexpected{made.error()};
    }
    place = std::move(*made);
    return {};
}

Result<StreamCondition> make_condition(AttackConfig const& config, std::vector<streams::Stream> const& streams) {
    AttackConfig::Condition const& when = *config.when;
    streams::Stream const* const stream = streams::find_stream(streams, when.stream.name);
    if (stream == nullptr) {
        return fail(ExitCode::usage,
                    fmt::format("attack '{}': there is no stream '{}'", config.name.name, when.stream.name));
    }
    return StreamCondition::create(*stream, config.name.name, when, when.channels);
}

} // namespace

Result<std::unique_ptr<Running>> make_attack(bus::Node& node, AttackConfig const& config,
                                             AttackerSettings const& settings,
                                             std::vector<streams::Stream> const& streams) {
    auto const seed = static_cast<std::uint64_t>(settings.seed);
    streams::Stream const* const stream =
        config.stream.empty() ? nullptr : streams::find_stream(streams, config.stream.name);
    if (!config.stream.empty() && stream == nullptr) {
        return fail(ExitCode::usage,
                    fmt::format("attack '{}': there is no stream '{}'", config.name.name, config.stream.name));
    }
    auto out = std::make_unique<Running>();
    out->config = &config;
    Result<void> ok;
    if (stream == nullptr) {
        ok = keep(make_topic_attack(node, config, settings), out->topic);
    } else if (config.goose) {
        ok = keep(GooseForger::create(*stream, config, seed), out->messages);
    } else if (config.frames) {
        ok = keep(FrameForger::create(*stream, config, seed), out->messages);
    } else {
        ok = keep(SvForger::create(*stream, config, settings.frequency_hz, seed), out->values);
    }
    if (ok && config.waits_for_other()) {
        ok = keep(make_condition(config, streams), out->condition);
    }
    if (!ok) {
        return std::unexpected{ok.error()};
    }
    return out;
}

} // namespace gridspace::attacker
