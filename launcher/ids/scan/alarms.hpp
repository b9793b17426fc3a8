// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <cstdint>
#include <string>
#include <vector>

namespace gridspace::scan {

/// Where a frame stands in a capture.
struct Place {
    std::int64_t time_ns{0};
    std::uint64_t frame{0}; ///< counted from 1 over all interfaces, as Wireshark's frame.number
};

/// A rule that has found something, with its first and its last frame.
struct Alarm {
    std::string rule;
    std::uint64_t count{0};
    Place first, last;
    std::string what; ///< of the first: "from 02:00:00:00:00:66"
};

/// The alarms of one stream, in the order in which each came first.
class Alarms {
  public:
    void raise(std::string const& rule, Place at, std::string const& what = {}) {
        for (Alarm& alarm : alarms_) {
            if (alarm.rule == rule) {
                ++alarm.count;
                alarm.last = at;
                return;
            }
        }
        alarms_.push_back({rule, 1, at, at, what});
    }
    [[nodiscard]] std::vector<Alarm> const& all() const { return alarms_; }

  private:
    std::vector<Alarm> alarms_; ///< of a dozen rules
};

} // namespace gridspace::scan
