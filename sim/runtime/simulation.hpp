// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"
#include "sim/engine/engine.hpp"
#include "sim/events/event.hpp"

#include <functional>
#include <map>
#include <memory>
#include <string>
#include <vector>

namespace gridspace::sim {

/// An engine on its time grid, with the scenario's physical events and the commands of others. Pure: whoever drives it
/// decides when and with whom the results are shared.
class Simulation {
  public:
    struct Options {
        TimeBase base;
        SimSpan step;
    };
    Simulation(std::unique_ptr<Engine> engine, Options options, std::vector<TimedAction> const& timeline);

    /// A change that takes effect at `at`; in the past (real time only): at once. At equal times the scenario's events
    /// come first, then commands in the order in which they were given.
    void command(SimTime at, Action action);
    /// The same for somebody who may ask for what the engine refuses: then nothing changes, and on_refusal hears of it.
    /// `what` is asked for, in words.
    void request(SimTime at, Action action, std::string what);
    void on_refusal(std::function<void(SimTime, std::string const& what, Error const&)> callback) {
        on_refusal_ = std::move(callback);
    }
    /// Forgets commands for which `drop` is true and that have not taken effect.
    void cancel(std::function<bool(SimTime at, Action const&)> const& drop);

    /// Called at every step, the initial state included, before changes of that instant take effect: measurements at t
    /// show the system before the switching at t.
    using Observer = std::function<void(SimTime)>;

    [[nodiscard]] Result<void> start(Observer const& observer);
    /// Simulates up to and including `until`; steps that lie in between are observed.
    [[nodiscard]] Result<void> run_until(SimTime until, Observer const& observer);

    /// From `from` on nothing opens the breaker: its mechanism is stuck. It can still be closed.
    void fail_to_open(std::string breaker, SimTime from);
    /// Called when a stuck breaker gets an opening command.
    void on_failure(std::function<void(SimTime, std::string const& breaker)> callback) {
        on_failure_ = std::move(callback);
    }

    /// Called when a physical event takes effect.
    void on_event(std::function<void(SimTime, TimedAction const&)> callback) { on_event_ = std::move(callback); }

    /// Called when an element did something by itself.
    void on_happening(std::function<void(Happening const&)> callback) { on_happening_ = std::move(callback); }

    /// The scenario's event that the engine refused, when that is what ended start() or run_until().
    [[nodiscard]] TimedAction const* refused_event() const { return refused_event_; }

    /// The last thing that somebody asked for and that took effect, in words; empty when there was none.
    [[nodiscard]] std::string last_request() const;

    [[nodiscard]] Engine& engine() { return *engine_; }
    [[nodiscard]] SimTime now() const { return now_; }

  private:
    struct Change {
        Action action;
        TimedAction const* event{nullptr};
        std::string request{}; ///< what is asked for; empty: it may not be refused
    };
    [[nodiscard]] Result<void> apply_changes();
    [[nodiscard]] bool is_held_back(Action const& action);

    std::unique_ptr<Engine> engine_;
    Options options_;
    std::vector<TimedAction> timeline_;
    std::multimap<std::pair<SimTime, int>, Change> changes_; ///< (time, 0 events / 1 commands), in order of insertion
    std::function<void(SimTime, TimedAction const&)> on_event_;
    std::function<void(Happening const&)> on_happening_;
    std::map<std::string, SimTime> stuck_; ///< breakers, and since when
    std::function<void(SimTime, std::string const&)> on_failure_;
    std::function<void(SimTime, std::string const&, Error const&)> on_refusal_;
    TimedAction const* refused_event_{nullptr};
    std::pair<SimTime, Change> last_request_; ///< when it took effect
    SimTime now_;
    SimTime next_step_;
};

} // namespace gridspace::sim
