// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/judge/alarm_score.hpp"

#include "launcher/judge/number_at.hpp"

#include <algorithm>
#include <iterator>
#include <string_view>

namespace gridspace::launcher {
namespace {

using config::Node;

/// Labels of messages come in blocks of this length.
constexpr double kBlockS = 0.01;
constexpr std::string_view kSuffix = ".alarm";

struct Interval {
    double from_s{0}, to_s{0};
};

/// Those that overlap as one, in order.
std::vector<Interval> united(std::vector<Interval> all) {
    std::sort(all.begin(), all.end(), [](Interval const& a, Interval const& b) { return a.from_s < b.from_s; });
    std::vector<Interval> out;
    for (Interval const& i : all) {
        if (!out.empty() && i.from_s <= out.back().to_s) {
            out.back().to_s = std::max(out.back().to_s, i.to_s);
        } else if (i.to_s > i.from_s) {
            out.push_back(i);
        }
    }
    return out;
}

double length_s(std::vector<Interval> const& of) {
    double out = 0;
    for (Interval const& i : of) {
        out += i.to_s - i.from_s;
    }
    return out;
}

/// How much of both at once; each is united.
double common_s(std::vector<Interval> const& a, std::vector<Interval> const& b) {
    double out = 0;
    for (std::size_t i = 0, k = 0; i < a.size() && k < b.size(); a[i].to_s < b[k].to_s ? ++i : ++k) {
        out += std::max(0.0, std::min(a[i].to_s, b[k].to_s) - std::max(a[i].from_s, b[k].from_s));
    }
    return out;
}

/// The attacks that an alarm is about: those that act when it begins; if none does, those that ended shortly before.
std::vector<std::size_t> about(RaisedAlarm const& alarm, std::vector<AlarmScore::Attack> const& attacks) {
    std::vector<std::size_t> acting, ended;
    for (std::size_t i = 0; i < attacks.size(); ++i) {
        AttackSpan const& span = attacks[i].span;
        if (alarm.from_s >= span.from_s && alarm.from_s <= span.to_s + kAlarmWithinS) {
            (alarm.from_s <= span.to_s ? acting : ended).push_back(i);
        }
    }
    return acting.empty() ? ended : acting;
}

} // namespace

AttackSpans::AttackSpans(Node const& scenario) {
    if (Node const* streams = scenario.find("streams"); streams != nullptr && streams->is_map()) {
        for (Node::Entry const& s : streams->entries) {
            if (Node const* kind = s.value.find("kind"); kind != nullptr && kind->text == "smv") {
                rates_hz_[s.key] = number_at(&s.value, "rate_hz").value_or(4800);
            }
        }
    }
    if (Node const* attacks = scenario.find("attacks"); attacks != nullptr && attacks->is_map()) {
        for (Node::Entry const& a : attacks->entries) {
            window_from_s_[a.key] = number_at(a.value.find("window"), "from_s").value_or(0);
        }
    }
}

void AttackSpans::add(IntrusionRecording::Label const& label) {
    auto const rate = rates_hz_.find(label.target);
    double at_s = 0;
    if (rate != rates_hz_.end()) {
        at_s = static_cast<double>(label.index) / rate->second;
    } else {
        auto const window = window_from_s_.find(label.attack);
        at_s = std::max(window == window_from_s_.end() ? 0 : window->second,
                        1e-9 * static_cast<double>(label.sent_ns) - kBlockS);
    }
    AttackSpan& span =
        spans_.try_emplace(label.attack, AttackSpan{label.attack, label.kind, label.target, at_s, at_s}).first->second;
    span.from_s = std::min(span.from_s, at_s);
    span.to_s = std::max(span.to_s, at_s);
}

std::vector<AttackSpan> AttackSpans::all() const {
    std::vector<AttackSpan> out;
    for (auto const& [name, span] : spans_) {
        out.push_back(span);
    }
    return out;
}

bool is_alarm_signal(std::string const& name) {
    return (name.starts_with("ids.") || name.starts_with("first_line.")) && name.ends_with(kSuffix);
}

std::vector<RaisedAlarm> raised_alarms(std::map<double, bool> const& stands_from_s, std::string const& by,
                                       double end_s) {
    std::vector<RaisedAlarm> out;
    bool before = false;
    for (auto const& [at_s, stands] : stands_from_s) {
        if (stands && !before) {
            out.push_back({at_s, std::max(at_s, end_s), by});
        } else if (!stands && before) {
            out.back().to_s = at_s;
        }
        before = stands;
    }
    return out;
}

std::vector<RaisedAlarm> raised_alarms(SignalStore const& signals, double end_s) {
    std::vector<RaisedAlarm> out;
    for (auto const& [name, series] : signals) {
        if (!is_alarm_signal(name)) {
            continue;
        }
        std::map<double, bool> stands_from_s;
        for (std::size_t i = 0; i < series.values.size(); ++i) {
            stands_from_s.insert_or_assign(1e-9 * static_cast<double>(series.times_ns[i]), series.values[i] != 0);
        }
        std::string const by = name.substr(0, name.size() - kSuffix.size());
        std::ranges::move(raised_alarms(stands_from_s, by, end_s), std::back_inserter(out));
    }
    return out;
}

AlarmScore score_alarms(std::vector<AttackSpan> attacks, std::vector<RaisedAlarm> const& alarms, double end_s) {
    AlarmScore out;
    out.alarms = alarms.size();
    std::vector<Interval> attacked, raised;
    for (AttackSpan& span : attacks) {
        attacked.push_back({span.from_s, std::min(span.to_s + kAlarmWithinS, end_s)});
        out.attacks.push_back({std::move(span), {}, {}});
    }
    for (RaisedAlarm const& alarm : alarms) {
        raised.push_back({alarm.from_s, std::min(alarm.to_s, end_s)});
        std::vector<std::size_t> const of = about(alarm, out.attacks);
        out.false_alarms += of.empty() ? 1U : 0U;
        for (std::size_t const i : of) {
            AlarmScore::Attack& attack = out.attacks[i];
            double const delay_ms = 1e3 * (alarm.from_s - attack.span.from_s);
            if (!attack.delay_ms || delay_ms < *attack.delay_ms) {
                attack.delay_ms = delay_ms;
                attack.by = alarm.by;
            }
        }
    }
    attacked = united(std::move(attacked));
    raised = united(std::move(raised));
    out.genuine_s = std::max(0.0, end_s - length_s(attacked));
    out.false_s = length_s(raised) - common_s(raised, attacked);
    return out;
}

} // namespace gridspace::launcher
