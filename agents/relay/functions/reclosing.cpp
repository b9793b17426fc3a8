// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/relay/functions/reclosing.hpp"

#include <algorithm>

namespace gridspace::relay {

void Rrec::enter(State state) {
    shot_ = state == State::ready ? 0 : shot_;
    state_ = state;
    since_ = 0;
}

/// The measurement is gone: what was begun cannot be finished safely.
void Rrec::reset() {
    if (state_ != State::ready && state_ != State::reclaim) {
        enter(State::lockout);
    }
}

FunctionState Rrec::step(FunctionInput const& input) {
    bool wanted = params_.initiated_by.empty() && input.trip;
    for (std::size_t const f : params_.initiated_by) {
        wanted = wanted || (input.trip && input.others[f].op);
    }
    bool const tripped = input.trip && !tripped_; // an edge
    tripped_ = input.trip;
    ++since_;
    if (tripped && !wanted) {
        enter(State::lockout); // somebody tripped who is not to be followed by a closing
    } else {
        go_on(input, tripped);
    }
    FunctionState out;
    out.str = state_ != State::ready && state_ != State::lockout;
    out.op = state_ == State::closing;
    return out;
}

void Rrec::go_on(FunctionInput const& input, bool tripped) {
    Abc const current = magnitudes(input.measured.i);
    bool const is_open = std::max({current[0], current[1], current[2]}) < params_.open_below_a;
    switch (state_) {
    case State::ready:
    case State::reclaim:
        if (tripped) {
            enter(shot_ < params_.dead_times_s.size() ? State::wait_open : State::lockout);
        } else if (state_ == State::reclaim && has_lasted(params_.reclaim_s)) {
            enter(State::ready);
        }
        return;
    case State::wait_open:
        if (is_open) {
            enter(State::dead_time);
        } else if (has_lasted(params_.wait_open_s)) {
            enter(State::lockout);
        }
        return;
    case State::dead_time:
        if (has_lasted(params_.dead_times_s[shot_])) {
            enter(params_.synchrocheck ? State::wait_release : State::closing);
        }
        return;
    case State::wait_release:
        if (input.others[*params_.synchrocheck].op) {
            enter(State::closing);
        } else if (has_lasted(params_.wait_release_s)) {
            enter(State::lockout);
        }
        return;
    case State::closing:
        if (tripped) { // onto a fault that is still there
            enter(++shot_ < params_.dead_times_s.size() ? State::wait_open : State::lockout);
        } else if (has_lasted(params_.pulse_s)) {
            ++shot_;
            enter(State::reclaim);
        }
        return;
    case State::lockout:
        return;
    }
}

} // namespace gridspace::relay
