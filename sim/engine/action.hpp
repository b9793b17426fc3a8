// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <string>
#include <variant>

namespace gridspace::sim {

/// A breaker, or an element with a switch of its own, by its name.
struct SwitchBreaker {
    std::string breaker;
    bool close{false};
    std::array<bool, 3> poles{true, true, true}; ///< that open; phasors open all of them, and a closing closes all
};

enum class FaultType { three_phase_ground, three_phase, phase_ground, phase_phase, phase_phase_ground };

/// A fault on a line (position in percent from its `from` end) or at a bus (line empty).
struct ApplyFault {
    std::string line, bus;
    double position_percent{50};
    FaultType type{FaultType::three_phase_ground};
    double resistance_ohm{0};
    std::string name; ///< of the event; clears by it
};

struct ClearFault {
    std::string name;
};

/// A parameter of the network file, by its path ("loads.AC3.p_kw").
struct SetParameter {
    std::string path;
    double value{0};
};

/// Takes an element out of service.
struct Disconnect {
    std::string element;
};

/// Puts it back.
struct Connect {
    std::string element;
};

/// A converter stands by: connected, and without current. Or it starts again.
struct StandBy {
    std::string element;
    bool on{true};
};

/// How the regulator of an element works from now on, by a word of the table of actions ("isochronous").
struct SetMode {
    std::string element, mode;
};

/// The mechanism of a breaker that was stuck (`fail_to_open`) works again. The engines see nothing of it.
struct Repair {
    std::string breaker;
};

using Action =
    std::variant<SwitchBreaker, ApplyFault, ClearFault, SetParameter, Disconnect, Connect, StandBy, SetMode, Repair>;

} // namespace gridspace::sim
