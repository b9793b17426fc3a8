// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/subscription_supervision.hpp"

namespace gridspace::iec61850 {
namespace {

/// A refused message among good ones (a test set next to the device) must not make the state flicker.
constexpr std::int64_t kProblemStaysNs = 100'000'000;

SubscriptionProblem problem_of(GooseEvent event) noexcept {
    switch (event) {
    case GooseEvent::identity_mismatch:
        return SubscriptionProblem::identity;
    case GooseEvent::conf_rev_mismatch:
        return SubscriptionProblem::conf_rev;
    case GooseEvent::data_set_mismatch:
        return SubscriptionProblem::data_set;
    case GooseEvent::simulation_refused:
        return SubscriptionProblem::simulation;
    case GooseEvent::inconsistent:
    case GooseEvent::stale:
    case GooseEvent::unconfirmed_jump:
        return SubscriptionProblem::contradiction;
    case GooseEvent::needs_commissioning:
    case GooseEvent::no_time_to_live:
        return SubscriptionProblem::commissioning;
    default: // taken, or a copy: PRP and rings bring those
        return SubscriptionProblem::none;
    }
}

SubscriptionProblem problem_of(SvEvent event) noexcept {
    switch (event) {
    case SvEvent::identity_mismatch:
        return SubscriptionProblem::identity;
    case SvEvent::conf_rev_mismatch:
        return SubscriptionProblem::conf_rev;
    case SvEvent::size_mismatch:
        return SubscriptionProblem::data_set;
    case SvEvent::simulation_refused:
        return SubscriptionProblem::simulation;
    case SvEvent::unconfirmed:
        return SubscriptionProblem::contradiction;
    default:
        return SubscriptionProblem::none;
    }
}

/// What both kinds do with a message: `problem` none and not `accepted` is a copy of what was there.
void judge(SupervisionState& state, SubscriptionProblem problem, bool accepted, std::int64_t now_ns,
           std::int64_t& refused_ns) noexcept {
    if (problem != SubscriptionProblem::none) {
        state.problem = problem;
        refused_ns = now_ns;
    } else if (accepted && now_ns - refused_ns >= kProblemStaysNs) {
        state.problem = SubscriptionProblem::none;
    }
    state.needs_commissioning = state.problem == SubscriptionProblem::conf_rev ||
                                state.problem == SubscriptionProblem::data_set ||
                                state.problem == SubscriptionProblem::commissioning;
}

} // namespace

bool GooseSupervision::receive(GooseFrame const& message, std::int64_t now_ns, std::int64_t utc_ns) noexcept {
    auto const verdict = subscriber_.receive(message, now_ns, utc_ns);
    if (verdict.event == GooseEvent::not_ours) {
        return false;
    }
    SupervisionState const before = state_;
    SubscriptionProblem const problem = problem_of(verdict.event);
    judge(state_, problem, verdict.accepted, now_ns, refused_ns_);
    state_.alive = subscriber_.status() == GooseStatus::good;
    if (problem != SubscriptionProblem::identity && problem != SubscriptionProblem::simulation) {
        state_.conf_rev = message.conf_rev;
    }
    if (verdict.accepted) {
        state_.simulated = message.simulated();
        state_.counter = message.st_num;
        state_.quality = 0;
        for (std::size_t i = 0; i < subscriber_.leaves().size(); ++i) {
            if (subscriber_.leaves()[i].type == BasicType::quality) {
                state_.quality |= static_cast<std::uint32_t>(subscriber_.value(i).bits);
            }
        }
    }
    return verdict.changed || state_ != before;
}

bool GooseSupervision::expire(std::int64_t now_ns) noexcept {
    if (!subscriber_.expire(now_ns)) {
        return false;
    }
    state_.alive = state_.simulated = false;
    return true;
}

SvSupervision::SvSupervision(SvSubscription subscription, DataSet const& data_set)
    : subscriber_{std::move(subscription)}, layout_{data_set} {
    for (std::size_t i = 0; i < layout_.slots().size(); ++i) {
        if (layout_.slots()[i].leaf.type == BasicType::quality) {
            qualities_.push_back(i);
        }
    }
}

bool SvSupervision::receive(FrameHeader const& header, Asdu const& asdu, std::int64_t now_ns) noexcept {
    if (!subscriber_.is_mine(asdu)) {
        return false;
    }
    SupervisionState const before = state_;
    auto const arrival = subscriber_.receive(header, asdu, now_ns);
    SubscriptionProblem const problem = problem_of(arrival.event);
    judge(state_, problem, arrival.accepted, now_ns, refused_ns_);
    state_.alive = subscriber_.alive();
    if (problem != SubscriptionProblem::identity && problem != SubscriptionProblem::simulation) {
        state_.conf_rev = asdu.conf_rev;
    }
    if (arrival.accepted) {
        state_.simulated = header.simulated();
        state_.counter = asdu.smp_synch;
        state_.quality = 0;
        for (std::size_t const i : qualities_) {
            state_.quality |= static_cast<std::uint32_t>(layout_.read(i, asdu.sample).bits);
        }
    }
    return state_ != before;
}

bool SvSupervision::expire(std::int64_t now_ns) noexcept {
    if (!subscriber_.expire(now_ns)) {
        return false;
    }
    state_.alive = state_.simulated = false;
    return true;
}

} // namespace gridspace::iec61850
