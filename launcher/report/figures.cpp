// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/figures.hpp"

#include "common/config/fields.hpp"
#include "common/text.hpp"
#include "launcher/report/intrusion_figures.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <optional>

namespace gridspace::launcher {
namespace {

using config::Node;

/// "ev.EV1.soc_percent" -> "EV1"
std::string element_of(std::string const& signal) {
    std::vector<std::string> const parts = split(signal, '.');
    return parts.size() > 2 ? parts[1] : signal;
}

void add_signals(Figure& figure, SignalStore const& signals, std::string const& pattern, bool steps, bool dashed,
                 std::string const& suffix = "") {
    int place = 0;
    for (auto const& [name, series] : signals) {
        if (matches_glob(pattern, name)) {
            figure.series.push_back(
                {element_of(name) + suffix, series.times_ns, series.values, steps, dashed, place++});
        }
    }
}

struct EvWish {
    std::string ev, process;
    double requested_h{0}, target_percent{80};
};

/// What the EV agents of the scenario were asked for.
std::vector<EvWish> ev_wishes(Node const& scenario) {
    std::vector<EvWish> out;
    Node const* processes = scenario.find("processes");
    if (processes == nullptr) {
        return out;
    }
    for (Node::Entry const& entry : processes->entries) {
        Node const* program = entry.value.find("program");
        if (program == nullptr || program->text != "gridspace-ev") {
            continue;
        }
        auto const number = [](Node const& node, Node const& fallback, std::string_view key, double otherwise) {
            Node const* own = node.find(key);
            Node const* shared = fallback.find(key);
            return own != nullptr      ? config::number_of(*own).value_or(otherwise)
                   : shared != nullptr ? config::number_of(*shared).value_or(otherwise)
                                       : otherwise;
        };
        auto const wish = [&](std::string const& ev, Node const& node) {
            out.push_back({ev, entry.key, number(node, entry.value, "requested_h", 4),
                           number(node, entry.value, "soc_target_percent", 80)});
        };
        if (Node const* ev = entry.value.find("ev")) {
            wish(ev->text, entry.value);
        }
        if (Node const* several = entry.value.find("evs"); several != nullptr && several->is_map()) {
            for (Node::Entry const& one : several->entries) {
                wish(one.key, one.value);
            }
        }
    }
    return out;
}

/// Horizontal lines from expectations on these signals, and from settings of processes whose key ends in the unit.
std::vector<Figure::Line> limits(Node const& scenario, std::string const& pattern, std::string_view key_suffix) {
    std::map<double, std::string> lines;
    if (Node const* expect = scenario.find("expect")) {
        for (Node::Entry const& entry : expect->entries) {
            for (Node::Entry const& verb : entry.value.entries) {
                if ((verb.key == "min_of" || verb.key == "max_of") && verb.value.text == pattern) {
                    for (std::string_view const bound : {"above", "below", "at_least", "at_most"}) {
                        if (Node const* v = entry.value.find(bound)) {
                            lines[config::number_of(*v).value_or(0)] = v->text;
                        }
                    }
                }
            }
        }
    }
    if (Node const* processes = scenario.find("processes")) {
        for (Node::Entry const& process : processes->entries) {
            Node const* rules = process.value.find("rules");
            for (Node::Entry const& rule : rules == nullptr ? std::vector<Node::Entry>{} : rules->entries) {
                if (rule.key.ends_with(key_suffix)) {
                    if (auto const v = config::number_of(rule.value)) {
                        lines[*v] = rule.value.text;
                    }
                }
            }
        }
    }
    std::vector<Figure::Line> out;
    for (auto const& [value, label] : lines) {
        out.push_back({label, value});
    }
    return out;
}

/// Spans in which a signal is not zero.
std::vector<Figure::Shade> spans(SignalSeries const& series, double end_s) {
    std::vector<Figure::Shade> out;
    bool open = false;
    for (std::size_t i = 0; i < series.values.size(); ++i) {
        double const t = static_cast<double>(series.times_ns[i]) / 1e9;
        if (series.values[i] != 0 && !open) {
            out.push_back({t, end_s});
        } else if (series.values[i] == 0 && open) {
            out.back().to_s = t;
        }
        open = series.values[i] != 0;
    }
    return out;
}

/// The first time at which a signal reaches a value, in hours.
std::optional<double> reached_h(SignalStore const& signals, std::string const& name, double value) {
    auto const it = signals.find(name);
    if (it == signals.end()) {
        return std::nullopt;
    }
    for (std::size_t i = 0; i < it->second.values.size(); ++i) {
        if (it->second.values[i] >= value) {
            return static_cast<double>(it->second.times_ns[i]) / 3.6e12;
        }
    }
    return std::nullopt;
}

bool has(SignalStore const& signals, std::string const& pattern) {
    return std::any_of(signals.begin(), signals.end(), [&](auto const& s) { return matches_glob(pattern, s.first); });
}

} // namespace

std::vector<Figure> make_figures(Results const& r, Node const& scenario) {
    std::vector<Figure> out;
    auto const start = [&](std::string id, std::string title, std::string y_label) -> Figure& {
        Figure figure;
        figure.id = std::move(id);
        figure.title = std::move(title);
        figure.y_label = std::move(y_label);
        figure.to_s = r.outcome.simulated_s > 0 ? r.outcome.simulated_s : 1;
        out.push_back(std::move(figure));
        return out.back();
    };
    if (has(r.signals, "ev.*.soc_percent")) {
        Figure& f = start("state_of_charge", "State of charge", "SoC, %");
        add_signals(f, r.signals, "ev.*.soc_percent", false, false);
        std::vector<EvWish> const wishes = ev_wishes(scenario);
        for (EvWish const& wish : wishes) {
            auto const series =
                std::find_if(f.series.begin(), f.series.end(), [&](auto const& s) { return s.name == wish.ev; });
            int const colour = series == f.series.end() ? -1 : static_cast<int>(series - f.series.begin());
            f.marks.push_back({wish.ev + " due", wish.requested_h * 3600, colour});
        }
        if (!wishes.empty()) {
            f.lines.push_back({"target", wishes.front().target_percent});
        }
    }
    if (has(r.signals, "bus.*.v_pu")) {
        Figure& f = start("bus_voltages", "Bus voltages", "voltage, p.u.");
        add_signals(f, r.signals, "bus.*.v_pu", false, false);
        f.lines = limits(scenario, "bus.*.v_pu", "_pu");
        for (auto const& [name, series] : r.signals) {
            if (matches_glob("agent.*.curtailed", name)) {
                f.shades = spans(series, f.to_s);
                f.shade_label = "curtailed";
            }
        }
    }
    if (has(r.signals, "ev.*.current_a")) {
        Figure& f = start("battery_currents", "Battery currents: reference (dashed) and actual", "current, A");
        add_signals(f, r.signals, "ev.*.current_a", false, false);
        add_signals(f, r.signals, "ev.*.reference_a", true, true, " ref");
    }
    std::vector<Figure> fakes = intrusion_figures(r.intrusion);
    std::move(fakes.begin(), fakes.end(), std::back_inserter(out));
    return out;
}

std::vector<ReportTable> make_tables(Results const& r, Node const& scenario) {
    std::vector<ReportTable> out;
    std::vector<EvWish> const wishes = ev_wishes(scenario);
    if (!wishes.empty()) {
        ReportTable table{"Charging: requested and reached",
                          {"EV", "requested, h", "reached, h", "late by, min", "published, h"},
                          {}};
        Node const* expect = scenario.find("expect");
        for (EvWish const& wish : wishes) {
            // The target counts as reached 0.05 % below: curtailment leaves a geometric tail.
            auto const reached = reached_h(r.signals, "ev." + wish.ev + ".soc_percent", wish.target_percent - 0.05);
            std::string published = "-";
            for (Node::Entry const& entry : expect == nullptr ? std::vector<Node::Entry>{} : expect->entries) {
                Node const* verb = entry.value.find("time_of");
                Node const* is = entry.value.find("is");
                if (verb != nullptr && is != nullptr &&
                    verb->text.find("ev." + wish.ev + ".soc_percent") != std::string::npos) {
                    published = is->text;
                }
            }
            table.rows.push_back({escape_markup(wish.ev), shortest(wish.requested_h),
                                  reached ? fmt::format("{:.3f}", *reached) : "not reached",
                                  reached ? fmt::format("{:+.1f}", (*reached - wish.requested_h) * 60) : "-",
                                  escape_markup(published)});
        }
        out.push_back(std::move(table));
    }
    std::vector<ReportTable> detectors = intrusion_tables(r.intrusion);
    std::move(detectors.begin(), detectors.end(), std::back_inserter(out));
    return out;
}

} // namespace gridspace::launcher
