// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/attacker/goose_forger.hpp"

#include "agents/attacker/stream_condition.hpp"
#include "gateways/port/subscriptions.hpp"

#include <fmt/format.h>

namespace gridspace::attacker {
Result<std::unique_ptr<GooseForger>> GooseForger::create(streams::Stream const& stream, AttackConfig const& config,
                                                         std::uint64_t seed) {
    auto frame = stream.goose_template({});
    if (!frame) {
        return std::unexpected{frame.error()};
    }
    auto const leaf = boolean_leaf(stream, config.channels.empty() ? "" : config.channels.front());
    if (!leaf) {
        return fail(ExitCode::usage,
                    fmt::format("attack '{}': stream '{}' has no Boolean member{}", config.name.name, stream.name.name,
                                config.channels.empty() ? "" : fmt::format(" '{}'", config.channels.front())));
    }
    GooseAttack attack{*config.goose, times_in_ns(config), seed};
    return std::unique_ptr<GooseForger>{new GooseForger{stream, config, std::move(attack), std::move(*frame), *leaf}};
}

GooseForger::GooseForger(streams::Stream const& stream, AttackConfig const& config, GooseAttack attack,
                         iec61850::GooseTemplate frame, std::size_t leaf)
    : heard_{gateways::goose_subscription(stream)}, attack_{std::move(attack)}, template_{std::move(frame)},
      leaf_{leaf}, spoof_{config.spoof} {}

void GooseForger::pass(iec61850::Octets frame, std::int64_t time_ns, Emit const& emit, Tell const& tell) {
    bool const decoded = time_ns >= 0 && iec61850::decode_goose(frame, decoded_).has_value();
    auto const verdict = decoded ? heard_.receive(decoded_, time_ns) : iec61850::GooseVerdict{};
    if (verdict.event == iec61850::GooseEvent::not_ours) {
        if (emit) {
            emit(frame);
        }
        return;
    }
    if (verdict.accepted) {
        for (std::size_t i = 0; i < template_.leaves().size(); ++i) {
            (void)template_.set(i, heard_.value(i));
        }
        real_value_ = heard_.value(leaf_).boolean();
        if (spoof_) {
            template_.set_source(decoded_.header.source);
        }
    }
    GooseState real;
    real.st_num = decoded_.st_num;
    real.sq_num = decoded_.sq_num;
    real.t_ns = decoded_.t.nanoseconds() - utc_base_ns_;
    real.live_ms = decoded_.live_ms;
    real.value = real_value_;
    real.simulated = decoded_.simulated();
    std::optional<GooseState> const on = attack_.pass(time_ns, real);
    count();
    if (!emit) {
        return;
    }
    if (!on) {
        tell_one(real_value_, tell);
    } else if (*on == real) {
        emit(frame);
    } else {
        tell_one(on->value, tell);
        template_.set_source(decoded_.header.source);
        emit(frame_of(*on));
    }
}

void GooseForger::elapse(std::int64_t now_ns, Emit const& emit, Tell const& tell) {
    while (due() && *due() <= now_ns) {
        if (auto const state = attack_.forge(now_ns)) {
            count();
            tell_one(state->value, tell);
            emit(frame_of(*state));
        }
    }
}

iec61850::Octets GooseForger::frame_of(GooseState const& state) {
    (void)template_.set(leaf_, iec61850::Value::of(state.value));
    iec61850::GooseState out;
    out.st_num = state.st_num;
    out.sq_num = state.sq_num;
    out.live_ms = state.live_ms;
    out.t = iec61850::UtcTime::from_nanoseconds(state.t_ns + utc_base_ns_, decoded_.t.quality);
    out.simulation = state.simulated;
    return template_.frame(out);
}

void GooseForger::tell_one(bool sent, Tell const& tell) {
    tell(Label{labels_++, 0, real_value_ ? 1.0 : 0.0, sent ? 1.0 : 0.0});
}

} // namespace gridspace::attacker
