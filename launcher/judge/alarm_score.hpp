// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/config/node.hpp"
#include "launcher/judge/intrusion_recording.hpp"
#include "recorder/signals/signal_store.hpp"

#include <map>
#include <optional>
#include <string>
#include <vector>

namespace gridspace::launcher {

/// An alarm is still about an attack this long after the last thing that was altered, unless another one acts by then:
/// that a pickup is not confirmed is said after 20 ms.
inline constexpr double kAlarmWithinS = 0.04;

/// When an attack altered something for the first and for the last time, simulated seconds.
struct AttackSpan {
    std::string attack, kind, target;
    double from_s{0}, to_s{0};
};

/// Of all attacks that have labels. A label of a sample says its instant; those of messages come in blocks of 10 ms, so
/// their first begins at most that much before it was sent, and not before the attack's window.
class AttackSpans {
  public:
    explicit AttackSpans(config::Node const& scenario);
    void add(IntrusionRecording::Label const& label);
    [[nodiscard]] std::vector<AttackSpan> all() const; ///< by name of the attack

  private:
    std::map<std::string, double> rates_hz_;      ///< of streams of sampled values
    std::map<std::string, double> window_from_s_; ///< of attacks
    std::map<std::string, AttackSpan> spans_;
};

/// While somebody said that something is wrong, simulated seconds.
struct RaisedAlarm {
    double from_s{0}, to_s{0};
    std::string by;
};

/// Of an alarm that stands (true) or not from an instant on.
[[nodiscard]] std::vector<RaisedAlarm> raised_alarms(std::map<double, bool> const& stands_from_s, std::string const& by,
                                                     double end_s);

/// What was said in a run: the signals ids.*.alarm and first_line.*.alarm, by the process that they are of.
[[nodiscard]] std::vector<RaisedAlarm> raised_alarms(SignalStore const& signals, double end_s);
[[nodiscard]] bool is_alarm_signal(std::string const& name);

struct AlarmScore {
    struct Attack {
        AttackSpan span;
        std::optional<double> delay_ms; ///< from its first alteration to the first alarm that began during it
        std::string by;
    };
    std::vector<Attack> attacks;
    std::uint64_t alarms{0}, false_alarms{0}; ///< false: begun while nobody attacked
    double genuine_s{0};                      ///< of the run, without its attacks
    double false_s{0};                        ///< of those, how long an alarm stood
};

/// An alarm that stands already when an attack begins says nothing about it.
[[nodiscard]] AlarmScore score_alarms(std::vector<AttackSpan> attacks, std::vector<RaisedAlarm> const& alarms,
                                      double end_s);

} // namespace gridspace::launcher
