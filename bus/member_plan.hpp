// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <vector>

namespace gridspace::bus {

/// A lockstep member as the simulator sees it.
struct MemberPlan {
    std::string name;
    std::vector<std::string> upstream;     ///< members whose output it reads: it cannot be quicker than they are
    std::vector<std::string> triggered_by; ///< those of them whose output makes it work in the same tick
    bool feeds_simulator{false};           ///< the simulator reads something that it writes
    std::vector<std::string> late{}; ///< those of `upstream` whose output takes longer than the tick it is made in
    bool collects_frames{false};     ///< it reads frames and need not work in the tick in which they are sent
};

} // namespace gridspace::bus
