// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/ids/export/frame_labels.hpp"

#include "gateways/iec61850/frame.hpp"
#include "recorder/pcapng/pcapng_reader.hpp"

#include <algorithm>
#include <cmath>
#include <functional>

namespace gridspace::dataset {
namespace {

/// A forged message may be stamped so long before the attack's start (real time: a tick) and behind its end.
constexpr double kEarlyS = 0.01, kLateS = 0.1;
/// A frame that is this much longer in a cable than it has to be was held back.
constexpr double kHeldBackS = 20e-6;

std::size_t hash_of(iec61850::Octets frame) {
    return std::hash<std::string_view>{}({reinterpret_cast<char const*>(frame.data()), frame.size()});
}

/// "process_bus/ied2:attacker" of "process_bus/ied2"?
bool is_inside(std::string_view interface, std::string_view port) {
    return interface.size() > port.size() && interface.starts_with(port) && interface[port.size()] == ':';
}

} // namespace

FrameLabels::FrameLabels(RunSource const& run) : run_{run} {
    for (attacker::AttackConfig const& attack : run.attacks) {
        if ((!attack.goose && !attack.frames) || attack.stream.empty()) {
            continue; // samples are recognised by their labels, and topics have no frames
        }
        Place place{attack.name.name,
                    attack.stream.name,
                    attack.frames.has_value(),
                    "",
                    attack.from_s.to_double() - kEarlyS,
                    attack.end_s() + kLateS};
        if (attack.place == attacker::AttackConfig::Place::second_publisher) {
            auto const host = run.host_of.find(attack.by.name);
            place.port = host == run.host_of.end() ? attack.by.name : host->second;
            beside_.push_back(std::move(place));
        } else if (attack.between.size() == 2) {
            place.port = attack.between[1].name + "/" + attack.between[0].name;
            altered_on_the_way_.push_back(std::move(place));
        }
    }
}

FrameLabels::Label FrameLabels::of_sample(std::string const& stream, std::int64_t index,
                                          std::array<double, 3> const& currents_a) const {
    Label out;
    for (LabelTable::Label const& label : run_.labels.of_sample(stream, index)) {
        double const value = label.channel < 3 ? currents_a[label.channel] : NAN;
        if (std::fabs(value - label.sent_value) < std::fabs(value - label.true_value)) {
            out.attack = run_.labels.attacks()[label.attack].name;
            out.phases = static_cast<std::uint8_t>(out.phases | 1U << label.channel);
        }
    }
    return out;
}

void FrameLabels::learn(std::string const& interface, double time_s, iec61850::Octets frame) {
    std::uint16_t const ethertype = iec61850::ethertype_of(frame);
    for (Place const& place : altered_on_the_way_) {
        if (is_inside(interface, place.port) &&
            ethertype == (place.frames ? iec61850::kSvEthertype : iec61850::kGooseEthertype)) {
            came_in_[hash_of(frame)].push_back({time_s});
            return;
        }
    }
}

FrameLabels::Place const* FrameLabels::from_beside(std::string const& stream, std::string const& interface,
                                                   double time_s, bool frames) const {
    auto const slash = interface.find('/');
    auto const at = std::find_if(beside_.begin(), beside_.end(), [&](Place const& place) {
        return place.frames == frames && place.stream == stream && time_s >= place.from_s && time_s < place.until_s &&
               slash != std::string::npos && !pcapng::is_inside_a_cable(interface) &&
               interface.compare(slash + 1, std::string::npos, place.port) == 0;
    });
    return at == beside_.end() ? nullptr : &*at;
}

FrameLabels::Label FrameLabels::of_message(std::string const& stream, std::string const& interface, double time_s,
                                           iec61850::Octets frame) const {
    if (Place const* const place = from_beside(stream, interface, time_s, false)) {
        return {place->attack, 0};
    }
    for (Place const& place : altered_on_the_way_) {
        if (!place.frames && place.stream == stream && time_s >= place.from_s && time_s < place.until_s &&
            interface == place.port && !came_in_.contains(hash_of(frame))) {
            return {place.attack, 0};
        }
    }
    return {};
}

FrameLabels::Label FrameLabels::of_frame(std::string const& stream, std::string const& interface, double time_s,
                                         iec61850::Octets frame) {
    if (Place const* const place = from_beside(stream, interface, time_s, true)) {
        return {place->attack, 0};
    }
    for (Place const& place : altered_on_the_way_) {
        if (!place.frames || place.stream != stream || interface != place.port) {
            continue;
        }
        bool const now = time_s >= place.from_s && time_s < place.until_s;
        auto const same = came_in_.find(hash_of(frame));
        if (same == came_in_.end()) {
            return now ? Label{place.attack, 0} : Label{};
        }
        // In a steady state a frame of a second later may be the same: the newest of those before it.
        CameIn* newest = nullptr;
        for (CameIn& candidate : same->second) {
            newest = candidate.time_s <= time_s + 1e-9 ? &candidate : newest;
        }
        if (newest == nullptr) {
            return {};
        }
        bool const twice = newest->went_on, late = time_s - newest->time_s > kHeldBackS;
        newest->went_on = true;
        return now && (twice || late) ? Label{place.attack, 0} : Label{};
    }
    return {};
}

} // namespace gridspace::dataset
