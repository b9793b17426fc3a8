// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "sim/runtime/simulation.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::sim {

Simulation::Simulation(std::unique_ptr<Engine> engine, Options options, std::vector<TimedAction> const& timeline)
    : engine_{std::move(engine)}, options_{options}, timeline_{timeline}, last_request_{SimTime{}, Change{}} {
    for (TimedAction const& event : timeline_) {
        changes_.insert({{SimTime{} + options_.base.nearest(event.at_s), 0}, {event.action, &event}});
    }
}

void Simulation::command(SimTime at, Action action) {
    changes_.insert({{std::max(at, now_), 1}, {std::move(action), nullptr}});
}

void Simulation::request(SimTime at, Action action, std::string what) {
    changes_.insert({{std::max(at, now_), 1}, {std::move(action), nullptr, std::move(what)}});
}

void Simulation::cancel(std::function<bool(SimTime, Action const&)> const& drop) {
    std::erase_if(changes_, [&](auto const& entry) {
        return entry.second.event == nullptr && drop(entry.first.first, entry.second.action);
    });
}

void Simulation::fail_to_open(std::string breaker, SimTime from) {
    auto const [it, added] = stuck_.try_emplace(std::move(breaker), from);
    it->second = std::min(it->second, from);
}

bool Simulation::is_held_back(Action const& action) {
    if (auto const* repair = std::get_if<Repair>(&action)) {
        std::erase_if(stuck_, [&](auto const& s) { return s.first == repair->breaker && s.second <= now_; });
    }
    auto const* command = std::get_if<SwitchBreaker>(&action);
    if (command == nullptr || command->close) {
        return false;
    }
    auto const stuck = stuck_.find(command->breaker);
    if (stuck == stuck_.end() || stuck->second > now_) {
        return false;
    }
    if (on_failure_) {
        on_failure_(now_, command->breaker);
    }
    return true;
}

Result<void> Simulation::start(Observer const& observer) {
    if (auto ok = engine_->initialise(); !ok) {
        return ok;
    }
    now_ = {};
    next_step_ = SimTime{} + options_.step;
    observer(now_);
    return apply_changes();
}

Result<void> Simulation::run_until(SimTime until, Observer const& observer) {
    // Commands for the present instant may have come since.
    if (auto ok = apply_changes(); !ok) {
        return ok;
    }
    while (now_ < until) {
        SimTime target = std::min(next_step_, until);
        if (!changes_.empty()) {
            target = std::min(target, std::max(changes_.begin()->first.first, now_));
        }
        if (target > now_) {
            // A tick that ends between two steps does not make the engine stop there: the steps decide the results.
            bool const only_the_tick_ends =
                target == until && until != next_step_ && (changes_.empty() || changes_.begin()->first.first != until);
            if (only_the_tick_ends) {
                return {};
            }
            if (auto ok = engine_->advance(target); !ok) {
                return ok;
            }
            now_ = target;
            for (Happening const& happening : engine_->happened()) {
                if (on_happening_) {
                    on_happening_(happening);
                }
            }
        }
        if (now_ == next_step_) {
            next_step_ = next_step_ + options_.step;
            observer(now_);
        }
        if (auto ok = apply_changes(); !ok) {
            return ok;
        }
    }
    return {};
}

Result<void> Simulation::apply_changes() {
    while (!changes_.empty() && changes_.begin()->first.first <= now_) {
        auto const node = changes_.extract(changes_.begin());
        Change const& change = node.mapped();
        if (auto ok = is_held_back(change.action) ? Result<void>{} : engine_->apply(change.action); !ok) {
            if (change.event != nullptr) {
                refused_event_ = change.event;
                return fail(ok.error().code, fmt::format("event '{}': {}", change.event->event, ok.error().message),
                            ok.error().remedy);
            }
            if (change.request.empty()) {
                return ok;
            }
            if (on_refusal_) {
                on_refusal_(now_, change.request, ok.error());
            }
        } else if (!change.request.empty()) {
            last_request_ = {now_, change};
        }
        if (change.event != nullptr && on_event_) {
            on_event_(now_, *change.event);
        }
    }
    return {};
}

std::string Simulation::last_request() const {
    auto const& [at, change] = last_request_;
    if (change.request.empty()) {
        return {};
    }
    auto const* set = std::get_if<SetParameter>(&change.action);
    return fmt::format("{}{} at {} s", change.request, set == nullptr ? "" : fmt::format(" = {}", shortest(set->value)),
                       shortest(options_.base.seconds(at)));
}

} // namespace gridspace::sim
