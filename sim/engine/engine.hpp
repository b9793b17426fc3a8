// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "common/time.hpp"
#include "sim/engine/action.hpp"

#include <span>
#include <string>
#include <vector>

namespace gridspace::sim {

/// A quantity of the simulated system that others may read: `kind.element.quantity[.phase]`.
struct SignalDef {
    std::string name;
    std::string unit;
    bool may_be_unknown{false}; ///< its value may be NaN: nothing happened yet
};

/// What an element did by itself: a fuse melted.
struct Happening {
    double at_s{0};
    std::string element, event; ///< one word: "fuse_melted"
    std::string text;
};

/// A solver with a network in it. The same object serves a co-simulation and an offline run.
class Engine {
  public:
    virtual ~Engine() = default;

    /// Puts the network into its steady state at simulated time 0.
    [[nodiscard]] virtual Result<void> initialise() = 0;

    /// Advances to `until`, at most one step away. Inputs hold since the last call; nothing is stepped over.
    [[nodiscard]] virtual Result<void> advance(SimTime until) = 0;

    /// Changes something now, between two advances.
    [[nodiscard]] virtual Result<void> apply(Action const& action) = 0;

    [[nodiscard]] virtual std::vector<SignalDef> const& signals() const = 0;
    [[nodiscard]] virtual double value(std::size_t signal) const = 0;

    /// In the last advance.
    [[nodiscard]] virtual std::span<Happening const> happened() const { return {}; }

    /// From now on only these signals are read: what serves others alone need not be computed. All, when never called.
    virtual void will_read(std::span<std::size_t const> /*signals*/) {}

    /// The index of a signal; signals().size() when there is none of that name.
    [[nodiscard]] std::size_t find_signal(std::string const& name) const {
        std::vector<SignalDef> const& all = signals();
        for (std::size_t i = 0; i < all.size(); ++i) {
            if (all[i].name == name) {
                return i;
            }
        }
        return all.size();
    }
};

} // namespace gridspace::sim
