// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/wire/test_pattern.hpp"

#include <cctype>
#include <cmath>
#include <map>
#include <numbers>
#include <optional>
#include <set>
#include <string>

namespace gridspace::wire {
namespace {

using iec61850::SvLayout;

/// A name with the letter of its phase taken out: "V*" and 'a' of "Va", "*.mag" and 'a' of "a.mag".
struct Named {
    std::string quantity;
    char phase{0};
};

/// The letters at the ends of a name's parts, each a way to read it.
std::vector<Named> readings_of(std::string const& name) {
    std::vector<Named> out;
    for (std::size_t i = 0; i < name.size(); ++i) {
        char const letter = static_cast<char>(std::tolower(static_cast<unsigned char>(name[i])));
        bool const ends_part = i + 1 == name.size() || name[i + 1] == '.';
        if (ends_part && (letter == 'a' || letter == 'b' || letter == 'c' || letter == 'n')) {
            Named& reading = out.emplace_back(name, letter);
            reading.quantity[i] = '*';
        }
    }
    return out;
}

} // namespace

TestPattern::TestPattern(SvLayout const& layout, double amplitude, double frequency_hz, double rate_hz)
    : layout_{layout}, amplitude_{amplitude}, turns_per_sample_{frequency_hz / rate_hz} {
    std::map<std::string, std::set<char>> phases; // of each quantity
    for (auto const& slot : layout.slots()) {
        for (Named const& reading : is_number(slot.leaf.type) ? readings_of(slot.leaf.name) : std::vector<Named>{}) {
            phases[reading.quantity].insert(reading.phase);
        }
    }
    std::size_t others = 0;
    for (std::size_t i = 0; i < layout.slots().size(); ++i) {
        auto const& leaf = layout.slots()[i].leaf;
        if (!is_number(leaf.type)) {
            continue;
        }
        std::optional<char> phase;
        for (Named const& reading : readings_of(leaf.name)) {
            std::set<char> const& all = phases[reading.quantity];
            if (all.contains('a') && all.contains('b') && all.contains('c')) {
                phase = reading.phase;
            }
        }
        std::size_t const place = phase ? static_cast<std::size_t>(*phase - 'a') : others++;
        channels_.push_back({i, static_cast<double>(place % 3) / 3, phase == 'n'});
    }
}

void TestPattern::write(std::int64_t index, std::span<std::uint8_t> sample) const {
    double const turns = turns_per_sample_ * static_cast<double>(index);
    for (Channel const& c : channels_) {
        // What is balanced adds up to nothing.
        double const value = c.is_sum ? 0 : amplitude_ * std::cos(2 * std::numbers::pi * (turns - c.lag));
        layout_.write(c.slot, iec61850::Value::from_number(layout_.slots()[c.slot].leaf.type, value), sample);
    }
}

} // namespace gridspace::wire
