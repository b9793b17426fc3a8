// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "bus/member.hpp"

#include <algorithm>

namespace gridspace::bus {

Result<void> run_member(Node& node, Member& member) {
    if (auto ok = member.prepare(); !ok) {
        return ok;
    }
    if (auto ok = node.start(); !ok) {
        return ok;
    }
    Tick last;
    for (bool begun = false;; begun = true) {
        auto const tick = node.next(member.deadline());
        if (!tick) {
            return std::unexpected{tick.error()};
        }
        if (!*tick) {
            member.end(last);
            return {};
        }
        last = **tick;
        if (!begun) {
            member.begin(last);
        }
        if (auto ok = member.work(last); !ok) {
            return ok;
        }
        if (auto ok = node.done(last, std::max(member.next_tick(last), last.number + 1)); !ok) {
            return ok;
        }
    }
}

} // namespace gridspace::bus
