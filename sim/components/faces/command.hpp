// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <span>
#include <string_view>

namespace gridspace::sim {

/// In the order of CommandKind in idl/controls.idl.
enum class Command { open, close, connect, disconnect, start, stop, reset, mode };
constexpr std::array<std::string_view, 8> kCommands{"open",  "close", "connect", "disconnect",
                                                    "start", "stop",  "reset",   "mode"};

/// A command that elements of a kind follow.
struct CommandUse {
    Command command{};
    std::string_view doc{};
    bool in_phasors{true}, in_waveforms{true};
};

/// A way in which the regulator of an element can work, for Command::mode.
struct Mode {
    std::string_view word{}, doc{};
};

/// What an element follows that can be taken out of service; a converter; one with a switch of its own.
constexpr CommandUse kInService[] = {{Command::connect, "puts it back into service"},
                                     {Command::disconnect, "takes it out of service"}};
constexpr CommandUse kConverter[] = {
    kInService[0],
    kInService[1],
    {Command::start, "gives its power again: with waveforms as after an outage, with phasors at once"},
    {Command::stop, "stands by: connected, and without current"}};
constexpr CommandUse kSwitched[] = {{Command::open, "opens its poles, each at a zero of its current"},
                                    {Command::close, "closes its poles"},
                                    kInService[0],
                                    kInService[1]};
/// Nothing would bring it to the grid's angle again.
constexpr CommandUse kOnlyOut[] = {kInService[1]};

} // namespace gridspace::sim
