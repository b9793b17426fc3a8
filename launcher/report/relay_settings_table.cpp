// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/report/relay_settings_table.hpp"

#include "agents/relay/functions/function_set.hpp"
#include "common/text.hpp"
#include "launcher/judge/protection_chain.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <iterator>
#include <map>
#include <string_view>

namespace gridspace::launcher {
namespace {

using config::Node;

/// Terms of IEC 60255 and of relay manuals; a key that is not here says what it is.
std::map<std::string_view, std::string_view> const& terms() {
    static std::map<std::string_view, std::string_view> const kTerms{
        {"kind", "measuring element"},
        {"window_cycles", "filter window"},
        {"pickup_a", "pickup current"},
        {"slope_percent", "slope 1"},
        {"slope2_percent", "slope 2"},
        {"slope2_from_a", "slope 2 from"},
        {"confirm_samples", "confirmation"},
        {"seal_in", "trip seal-in"},
        {"latency_us", "processing time"},
        {"measures", "measured quantity"},
        {"dropout_ratio", "drop-out ratio"},
        {"directional", "direction given by"},
        {"direction", "direction"},
        {"curve", "time characteristic"},
        {"time_multiplier", "time multiplier (TMS)"},
        {"delay_ms", "operate delay"},
        {"minimum_ms", "minimum operate time"},
        {"reset", "reset characteristic"},
        {"reset_ms", "reset time"},
        {"characteristic", "zone characteristic"},
        {"reach_ohm", "reach, positive sequence"},
        {"angle_deg", "line angle"},
        {"r_ohm", "resistive reach, phase to phase"},
        {"r_earth_ohm", "resistive reach, phase to earth"},
        {"k0", "residual compensation k0"},
        {"k0_deg", "angle of k0"},
        {"minimum_a", "minimum current"},
        {"minimum_residual_a", "earth-fault detection 3I0"},
        {"minimum_v", "minimum voltage"},
        {"confirm_ms", "confirmation"},
        {"polarisation", "polarisation"},
        {"characteristic_angle_deg", "characteristic angle (RCA)"},
        {"sector_deg", "operating sector, each side"},
        {"pickup_v", "pickup voltage"},
        {"all_phases", "all phases needed"},
        {"block_below_v", "blocked below"},
        {"pickup_hz", "pickup frequency"},
        {"pickup_hz_per_s", "pickup df/dt"},
        {"live_v", "live above"},
        {"dead_v", "dead below"},
        {"difference_v", "voltage difference"},
        {"difference_deg", "angle difference"},
        {"difference_hz", "slip frequency"},
        {"dead_line", "closing onto a dead line"},
        {"dead_bus", "closing onto a dead bus"},
        {"hold_ms", "conditions hold for"},
        {"initiated_by", "initiated by"},
        {"dead_times_ms", "dead times"},
        {"synchrocheck", "released by"},
        {"wait_release_ms", "wait for release"},
        {"open_below_a", "breaker open below"},
        {"wait_open_ms", "wait for opening"},
        {"pulse_ms", "close pulse"},
        {"reclaim_ms", "reclaim time"},
        {"trip", "trips the relay"},
    };
    return kTerms;
}

std::string_view class_words(relay::NodeClass of) {
    using relay::NodeClass;
    switch (of) {
    case NodeClass::rdir:
        return "direction";
    case NodeClass::ptoc:
        return "time overcurrent";
    case NodeClass::pioc:
        return "instantaneous overcurrent";
    case NodeClass::pdis:
        return "distance zone";
    case NodeClass::ptuv:
        return "undervoltage";
    case NodeClass::ptov:
        return "overvoltage";
    case NodeClass::ptuf:
        return "underfrequency";
    case NodeClass::ptof:
        return "overfrequency";
    case NodeClass::pfrc:
        return "rate of change of frequency";
    case NodeClass::rsyn:
        return "synchrocheck";
    case NodeClass::rbrf:
        return "breaker failure";
    case NodeClass::rrec:
        return "reclosing";
    }
    return "";
}

/// By the end of the key, as everywhere in a configuration.
std::string_view unit_of(std::string_view key) {
    using Ending = std::pair<std::string_view, std::string_view>;
    for (auto const& [ending, unit] : {Ending{"_hz_per_s", "Hz/s"},
                                       {"_a", "A"},
                                       {"_v", "V"},
                                       {"_hz", "Hz"},
                                       {"_ms", "ms"},
                                       {"_us", "us"},
                                       {"_ohm", "ohm"},
                                       {"_deg", "deg"},
                                       {"_percent", "%"},
                                       {"_cycles", "cycles"},
                                       {"_samples", "samples"}}) {
        if (key.ends_with(ending)) {
            return unit;
        }
    }
    return "";
}

std::string value_text(Node const& node) {
    std::vector<std::string> items;
    std::ranges::transform(node.items, std::back_inserter(items), value_text);
    return node.is_sequence()     ? join(items, ", ")
           : node.text == "true"  ? "yes"
           : node.text == "false" ? "no"
                                  : node.text;
}

/// Each setting on a line of its own, as markup.
std::string settings_of(Node const& process) {
    std::string out;
    auto const lines = [&](Node const& group) {
        for (Node::Entry const& entry : group.entries) {
            if (entry.key != "publish_values") {
                out += escape_markup(setting_text(entry.key, entry.value)) + "<br>";
            }
        }
    };
    if (Node const* element = process.find("element"); element != nullptr) {
        out += "<b>line differential, 87L</b><br>";
        lines(*element);
    }
    if (Node const* functions = process.find("functions"); functions != nullptr) {
        for (Node::Entry const& function : functions->entries) {
            relay::NodeClass of{};
            bool const known = relay::class_in(function.key, of);
            out += fmt::format("<b>{}{}</b><br>", escape_markup(function.key),
                               known ? fmt::format(": {}, {}", class_words(of), relay::device_number(of)) : "");
            lines(function.value);
        }
    }
    for (char const* key : {"seal_in", "latency_us"}) {
        if (Node const* value = process.find(key); value != nullptr && !value->text.empty()) {
            out += escape_markup(setting_text(key, *value)) + "<br>";
        }
    }
    return out;
}

} // namespace

std::string setting_text(std::string const& key, Node const& value) {
    auto const term = terms().find(key);
    std::string_view const unit = unit_of(key);
    std::string const said = fmt::format("{}{}{}", value_text(value), unit.empty() ? "" : " ", unit);
    return term == terms().end() ? fmt::format("{}: {}", key, said)
                                 : fmt::format("{}: {} ({})", term->second, said, key);
}

ReportTable relay_settings_table(Node const& scenario) {
    ReportTable t{"Relays", {"relay", "measures", "settings (key of the configuration)", "trips"}, {}};
    Node const* const processes = scenario.find("processes");
    for (ProtectionChain const& chain : protection_chains(scenario)) {
        std::vector<std::string> measures;
        for (ProtectionChain::End const& end : chain.ends) {
            if (!end.stream.empty()) {
                measures.push_back(
                    end.transformer.empty() ? end.stream : fmt::format("{} (stream {})", end.transformer, end.stream));
            }
        }
        t.rows.push_back({escape_markup(chain.relay), escape_markup(join(measures, ", ")),
                          "<span class=\"lines\">" + settings_of(*processes->find(chain.relay)) + "</span>",
                          escape_markup(fmt::format("{} by {}", join(chain.breakers(), ", "), chain.trip_stream))});
    }
    t.note = t.rows.empty()
                 ? ""
                 : "Currents, voltages and impedances are primary quantities. What is not said has its default.";
    return t;
}

} // namespace gridspace::launcher
