// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/stream_condition.hpp"

#include "agents/attacker/sv_forger.hpp"
#include "common/text.hpp"
#include "gateways/port/subscriptions.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

namespace gridspace::attacker {

std::optional<std::size_t> boolean_leaf(streams::Stream const& stream, std::string_view name) {
    std::vector<iec61850::Leaf> const leaves = iec61850::leaves_of(stream.data_set);
    auto const found = std::ranges::find_if(leaves, [&](iec61850::Leaf const& leaf) {
        return leaf.type == iec61850::BasicType::boolean && (name.empty() || leaf.name == name);
    });
    return found == leaves.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - leaves.begin())};
}

StreamCondition::Said::Said(streams::Stream const& stream) : heard{gateways::goose_subscription(stream)} {}

Result<StreamCondition> StreamCondition::create(streams::Stream const& stream, std::string const& attack,
                                                AttackConfig::Condition const& condition,
                                                std::vector<std::string> const& channels) {
    auto const bad = [&](std::string what, std::string remedy) {
        return fail(ExitCode::usage, fmt::format("attack '{}' waits for {}", attack, what), std::move(remedy));
    };
    StreamCondition out;
    if (condition.said) {
        std::string const name = channels.empty() ? "" : channels.front();
        auto const leaf = stream.kind == streams::Kind::goose ? boolean_leaf(stream, name) : std::nullopt;
        if (!leaf) {
            return bad(fmt::format("what '{}' says, and it has no Boolean member{}", stream.name.name,
                                   name.empty() ? "" : fmt::format(" '{}'", name)),
                       "`said` goes with a GOOSE stream, `above_a` with sampled values");
        }
        out.said_.emplace(stream);
        out.said_->leaf = *leaf;
        out.said_->value = *condition.said;
        return out;
    }
    std::vector<std::string> const phases =
        stream.kind == streams::Kind::smv ? phase_channels(stream) : std::vector<std::string>{};
    out.currents_.emplace(stream);
    out.currents_->above_a = *condition.above_a;
    for (std::string const& phase : channels.empty() ? phases : channels) {
        if (std::ranges::find(phases, phase) == phases.end()) {
            return bad(fmt::format("the current '{}' of '{}'", phase, stream.name.name),
                       phases.empty() ? "" : fmt::format("its currents are {}", join(phases, ", ")));
        }
        auto const slot = *out.currents_->target.layout().index_of(phase);
        out.currents_->slots.emplace_back(slot, out.currents_->target.amperes(slot));
    }
    if (out.currents_->slots.empty()) {
        return bad(fmt::format("a current of '{}', and it has none", stream.name.name),
                   "`above_a` goes with sampled values, `said` with a GOOSE stream");
    }
    return out;
}

bool StreamCondition::met(iec61850::Octets frame, std::int64_t time_ns) {
    if (time_ns < 0) {
        return false;
    }
    if (said_) {
        return iec61850::decode_goose(frame, said_->decoded).has_value() &&
               said_->heard.receive(said_->decoded, time_ns).accepted &&
               said_->heard.value(said_->leaf).boolean() == said_->value;
    }
    if (!currents_->target.decode(frame, currents_->decoded)) {
        return false;
    }
    return std::ranges::any_of(currents_->decoded.view(), [&](iec61850::Asdu const& asdu) {
        return std::ranges::any_of(currents_->slots, [&](auto const& slot) {
            double const value = currents_->target.layout().read(slot.first, asdu.sample).number() * slot.second;
            return std::fabs(value) > currents_->above_a;
        });
    });
}

} // namespace gridspace::attacker
