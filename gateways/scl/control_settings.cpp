// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/control_settings.hpp"

#include "common/config/fields.hpp"
#include "common/text.hpp"
#include "gateways/scl/control_address.hpp"
#include "gateways/streams/stream.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace gridspace::scl {
namespace {

using config::Node;

constexpr unsigned kLargestVlan = 0xFFE;
constexpr double kNoRatePerPeriod = 1000; // nobody samples a period so often: smpMod was forgotten

bool is_vlan_priority(std::string const& text) {
    return text.size() == 1 && text[0] >= '0' && text[0] <= '7';
}

/// 0 to 63.
bool is_class_of_traffic(std::string const& text) {
    bool const digits = std::ranges::all_of(text, [](char c) { return c >= '0' && c <= '9'; });
    return digits && !text.empty() && (text.size() == 1 || (text.size() == 2 && text <= "63"));
}

/// The IED that an element belongs to.
std::string ied_of(Element const& element) {
    for (tinyxml2::XMLNode const* node = &element; node != nullptr; node = node->Parent()) {
        Element const* const e = node->ToElement();
        if (e != nullptr && local_name(*e) == "IED") {
            return attribute(*e, "name");
        }
        if (e != nullptr && local_name(*e) == "ConnectedAP") {
            return attribute(*e, "iedName");
        }
    }
    return "";
}

} // namespace

bool is_true(std::string const& text) {
    return text == "true" || text == "1";
}

std::string subject_of(Element const& control) {
    std::string const block = attribute(control, "name", attribute(control, "cbName"));
    return ied_of(control) + (block.empty() ? "" : " " + block);
}

void ControlSettings::assumed(Element const& where, Element const& control, std::string text, std::string remedy) {
    findings_.assumed(where, {subject_of(control), std::move(text), std::move(remedy)});
}

void ControlSettings::left_out(Element const& where, Element const& control, std::string text, std::string remedy) {
    findings_.left_out(where, {subject_of(control), std::move(text), std::move(remedy)});
}

std::string ControlSettings::attribute_or(Element const& control, char const* name, char const* fallback) {
    std::string value = attribute(control, name);
    if (value.empty()) {
        assumed(control, control,
                fmt::format("control block '{}' has no {}: {} is assumed", attribute(control, "name"), name, fallback));
        value = fallback;
    }
    return value;
}

void ControlSettings::note_of_protection(Element const& control) {
    std::string const wanted = attribute(control, "securityEnable", "None");
    if (wanted != "None") {
        assumed(control, control,
                fmt::format("control block '{}' has securityEnable {}: streams are neither signed nor encrypted",
                            attribute(control, "name"), wanted));
    }
}

void ControlSettings::set_destination(Element const& address, Element const& control, Parameters& p,
                                      iec61850::Mac const& mac, Node& stream) {
    auto const group = streams::parse_ipv4(p["IP"]);
    if (group && streams::is_routed_group(*group)) {
        Node udp = Node::map();
        udp.set("group", Node::quoted_text(p["IP"]));
        if (std::string const& dscp = p["IP-ClassOfTraffic"]; is_class_of_traffic(dscp)) {
            udp.set("dscp", Node::scalar(dscp));
        }
        stream.set("udp", std::move(udp));
    } else {
        stream.set("mac", Node::quoted_text(mac.to_string()));
        if (!p["IP"].empty()) {
            assumed(
                address, control,
                fmt::format("control block '{}' has the IP address '{}', which is no group that routers forward: its "
                            "MAC address is used",
                            attribute(control, "name"), p["IP"]));
        }
    }
}

void ControlSettings::set_vlan(Element const& address, Element const& control, Parameters& p, Node& stream) {
    if (auto const vlan = hexadecimal(p["VLAN-ID"]); vlan && *vlan <= kLargestVlan) {
        stream.set("vlan_id", Node::scalar(std::to_string(*vlan)));
    } else if (!p["VLAN-ID"].empty()) {
        assumed(address, control,
                fmt::format("control block '{}' has the VLAN-ID '{}', which is none; it was left away",
                            attribute(control, "name"), p["VLAN-ID"]));
    }
    if (std::string const& priority = p["VLAN-PRIORITY"]; is_vlan_priority(priority)) {
        stream.set("vlan_priority", Node::scalar(priority));
    } else if (!priority.empty()) {
        assumed(address, control,
                fmt::format("control block '{}' has the VLAN-PRIORITY '{}', which is none (0 to 7); the "
                            "default is used",
                            attribute(control, "name"), priority));
    }
}

bool ControlSettings::read_address(Element const& control, Element const* where, Node& stream) {
    Element const* const address = where == nullptr ? nullptr : child(*where, "Address");
    if (address == nullptr) {
        left_out(control, control,
                 fmt::format("control block '{}' has no address under Communication; it was left out",
                             attribute(control, "name")),
                 "a GSE or SMV with its ldInst and cbName under the ConnectedAP of its IED");
        return false;
    }
    Parameters p;
    for (Element const* e : children(*address, "P")) {
        p[attribute(*e, "type")] = text_of(*e);
    }
    auto const mac = mac_of(p["MAC-Address"]);
    bool const goose = local_name(control) == "GSEControl";
    auto const app_id = p["APPID"].empty() ? std::optional{goose ? 0U : 0x4000U} : hexadecimal(p["APPID"]);
    if (!mac || !app_id) {
        left_out(control, control,
                 fmt::format("control block '{}' has the MAC address '{}' and APPID '{}'; it was left out",
                             attribute(control, "name"), p["MAC-Address"], p["APPID"]),
                 "like 01-0C-CD-01-00-01, and four hexadecimal digits");
        return false;
    }
    set_destination(*address, control, p, *mac, stream);
    stream.set("app_id", Node::scalar(fmt::format("0x{:04X}", *app_id)));
    if (p["APPID"].empty()) {
        assumed(*address, control,
                fmt::format("control block '{}' has no APPID: the standard's default 0x{:04X}",
                            attribute(control, "name"), *app_id));
    }
    set_vlan(*address, control, p, stream);
    return true;
}

/// A time below a millisecond: frames cannot say one in timeAllowedToLive.
void ControlSettings::note_of_times(Element const& time, double ms) {
    constexpr double kShortest = 1, kPerSecond = 1000;
    if (ms < kShortest) {
        assumed(time, *time.Parent()->ToElement(),
                fmt::format("{} {} of '{}' is taken as {} ms, because SCL counts milliseconds; were seconds meant, "
                            "it is {} ms",
                            local_name(time), text_of(time), attribute(*time.Parent()->ToElement(), "cbName"),
                            shortest(ms), shortest(ms * kPerSecond)));
    }
}

void ControlSettings::read_times(Element const& where, Node& stream) {
    std::map<std::string, double> times;
    for (char const* name : {"MinTime", "MaxTime"}) {
        if (Element const* const e = child(where, name)) {
            auto const ms = config::number_of(Node::scalar(text_of(*e)));
            if (!ms || *ms <= 0 || (times.contains("MinTime") && *ms < times["MinTime"])) {
                assumed(*e, where,
                        fmt::format("'{}' is no {} of '{}'; the default is used", text_of(*e), name,
                                    attribute(where, "cbName")));
                continue;
            }
            note_of_times(*e, *ms);
            times[name] = *ms;
        }
    }
    if (times.contains("MinTime") && !times.contains("MaxTime")) { // the default could be shorter
        times["MaxTime"] = std::max(times["MinTime"], streams::GooseTiming{}.max_time_ms);
    }
    if (times.contains("MaxTime") && !times.contains("MinTime")) {
        times["MinTime"] = std::min(times["MaxTime"], streams::GooseTiming{}.min_time_ms);
    }
    for (auto const& [name, key] : {std::pair{"MinTime", "min_time_ms"}, {"MaxTime", "max_time_ms"}}) {
        if (times.contains(name)) {
            stream.set(key, Node::scalar(shortest(times[name])));
        }
    }
}

bool ControlSettings::read_sampling(Element const& control, std::string const& data_set, Node& stream) {
    stream.set("sv_id", Node::quoted_text(attribute(control, "smvID")));
    double const count = control.DoubleAttribute("smpRate", 0);
    std::string mode = attribute(control, "smpMod", "SmpPerPeriod");
    if (count >= kNoRatePerPeriod && mode == "SmpPerPeriod") {
        assumed(control, control,
                fmt::format("control block '{}' has smpRate {}, which is taken as samples per second",
                            attribute(control, "name"), count));
        mode = "SmpPerSec";
    }
    double const rate = mode == "SmpPerPeriod" ? count * nominal_hz_ : count;
    if (mode == "SecPerSmp" || rate < 1) {
        left_out(control, control,
                 fmt::format("control block '{}' has {} {}; it was left out", attribute(control, "name"), mode,
                             attribute(control, "smpRate")));
        return false;
    }
    if (mode == "SmpPerPeriod") {
        assumed(control, control,
                fmt::format("control block '{}' has {} samples per period: {} Hz, because the nominal frequency is {} "
                            "Hz (--nominal-hz)",
                            attribute(control, "name"), count, shortest(rate), shortest(nominal_hz_)));
    }
    stream.set("rate_hz", Node::scalar(shortest(rate)));
    stream.set("samples_per_frame", Node::scalar(attribute_or(control, "nofASDU", "1")));
    if (Element const* const options = child(control, "SmvOpts")) {
        read_options(control, *options, data_set, stream);
        if (mode == "SmpPerPeriod" && is_true(attribute(*options, "sampleRate"))) {
            assumed(*options, control,
                    fmt::format("control block '{}' sends smpRate {} and smpMod 0 (samples per period); a stream "
                                "with send_smp_rate sends {} and 1 (samples per second)",
                                attribute(control, "name"), count, shortest(rate)));
        }
    }
    return true;
}

/// The optional fields of a frame.
void ControlSettings::read_options(Element const& control, Element const& options, std::string const& data_set,
                                   Node& stream) {
    auto const has = [&](char const* name) { return is_true(attribute(options, name)); };
    if (has("dataSet")) {
        stream.set("data_set_name", Node::scalar(data_set));
    }
    if (has("refreshTime")) {
        stream.set("send_refr_tm", Node::scalar("true"));
    }
    if (has("sampleRate")) {
        stream.set("send_smp_rate", Node::scalar("true"));
    }
    if (has("synchSourceId")) {
        assumed(options, control,
                fmt::format("control block '{}' sends the identity of its clock (synchSourceId), which SCL does "
                            "not hold: a publisher needs gm_identity",
                            attribute(control, "name")));
    }
    for (char const* name : {"security", "timestamp"}) {
        if (has(name)) {
            assumed(options, control,
                    fmt::format("control block '{}' has the option {}, which streams do not send",
                                attribute(control, "name"), name));
        }
    }
}

} // namespace gridspace::scl
