// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sdk/timers.hpp"

#include <algorithm>

namespace gridspace::sdk {

int Timers::every(SimSpan period, SimTime first) {
    std::int64_t const multiple = std::max<std::int64_t>(first.quanta, 0) / period.quanta;
    return add(SimTime{multiple * period.quanta}, period);
}

int Timers::at(SimTime time) {
    return add(time, {});
}

int Timers::add(SimTime time, SimSpan period) {
    auto const free = std::find_if(timers_.begin(), timers_.end(), [](Timer const& t) { return !t.time; });
    auto const number = static_cast<int>(free - timers_.begin());
    if (free == timers_.end()) {
        timers_.push_back({time, period});
    } else {
        *free = {time, period};
    }
    return number;
}

bool Timers::cancel(int timer) {
    if (timer < 0 || static_cast<std::size_t>(timer) >= timers_.size()) {
        return false;
    }
    timers_[static_cast<std::size_t>(timer)].time.reset();
    return true;
}

std::optional<Timers::Due> Timers::next() const {
    std::optional<Due> out;
    for (std::size_t i = 0; i < timers_.size(); ++i) {
        if (timers_[i].time && (!out || *timers_[i].time < out->time)) {
            out = Due{*timers_[i].time, static_cast<int>(i)};
        }
    }
    return out;
}

void Timers::passed(int timer) {
    Timer& t = timers_[static_cast<std::size_t>(timer)];
    if (t.time && t.period.quanta > 0) {
        t.time = *t.time + t.period;
    } else {
        t.time.reset();
    }
}

} // namespace gridspace::sdk
