// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "sim/controls/control.hpp"

#include <functional>
#include <map>
#include <set>
#include <string_view>

namespace gridspace::sim {

/// `simulation.controls` at work: set-points and commands in, requests to the simulation out. Who sends them may be
/// anybody's program: what is not allowed, not possible or too late does nothing, and is reported.
class Controls {
  public:
    Controls(std::vector<ControlConfig> const& configs, Network const& network, bool waveform,
             Control::Grid const& grid);

    /// What all have in common that agents send. In the order of `effect`.
    struct Asked {
        SimTime effect;           ///< when it takes effect: `stamp`, or now when that is over
        SimTime stamp;            ///< when it should
        std::string_view process; ///< who sent it
        std::string_view source;  ///< on whose behalf, as it says
        std::string_view element; ///< "battery.BAT1"
        double valid_for_s{0};
    };
    void set_point(Simulation& simulation, Asked const& asked, std::string_view quantity, double value);
    /// `command`: index in kCommands; `mode`: the word of Command::mode.
    void command(Simulation& simulation, Asked const& asked, std::size_t command, std::string_view mode = {});
    /// Ramps, losses and fallbacks up to `until`, after all that takes effect until then.
    void advance(Simulation& simulation, SimTime until);

    /// What is reported: (when, kind of event, sentence). Refusals of one kind from one process for one thing once,
    /// until it is obeyed again.
    void on_event(std::function<void(SimTime, std::string_view, std::string const&)> tell) { tell_ = std::move(tell); }
    /// The engine has refused what was asked for `name`.
    void refused_by_engine(SimTime at, std::string const& name, Error const& error);
    [[nodiscard]] std::uint64_t refused() const { return refused_; }

  private:
    struct Steered {
        Control control;
        std::vector<std::string> from;
    };
    struct Commands {
        std::vector<std::string> from;
        std::set<Command> allowed;
        std::vector<std::string> modes;
    };
    /// Why something is refused: a kind that stays the same, and a sentence.
    struct Why {
        std::string_view kind;
        std::string text;
    };
    [[nodiscard]] std::optional<Why> wrong_with(Asked const& asked, std::vector<std::string> const* from) const;
    [[nodiscard]] Why unknown(std::string_view element, std::string_view quantity) const;
    /// `thing`: what said_ knows it by; `what`: the same with its value.
    void refuse(std::string_view event, Asked const& asked, std::string const& thing, std::string const& what,
                Why const& why);

    Control::Grid grid_;
    std::map<std::string, Steered, std::less<>> quantities_; ///< by "battery.BAT1.p_kw"
    std::map<std::string, Commands, std::less<>> commands_;  ///< by "breaker.CB1"
    std::set<std::string, std::less<>> elements_;            ///< all of the network
    std::function<void(SimTime, std::string_view, std::string const&)> tell_;
    std::map<std::pair<std::string, std::string>, std::string_view> said_; ///< by process and thing: kind of refusal
    std::uint64_t refused_{0};
};

} // namespace gridspace::sim
