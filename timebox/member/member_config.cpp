// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "timebox/member/member_config.hpp"

#include <fmt/format.h>

namespace gridspace::timebox {
namespace {

void describe_frames(config::Fields& f, std::string_view key, std::vector<std::uint16_t>& ethertypes,
                     std::string_view doc) {
    std::vector<config::Ref> words;
    f.references(key, words, {.doc = doc});
    for (config::Ref const& word : words) {
        if (word.name == "smv" || word.name == "goose") {
            ethertypes.push_back(word.name == "smv" ? iec61850::kSvEthertype : iec61850::kGooseEthertype);
        } else {
            f.error(key, fmt::format("'{}' is no kind of frame", word.name), "smv or goose");
        }
    }
}

} // namespace

void describe(config::Fields& f, MemberConfig& c) {
    std::vector<config::Ref> words;
    f.references("command", words, {.doc = "the program and its arguments", .required = true, .may_be_empty = true});
    for (config::Ref& word : words) {
        c.command.push_back(std::move(word.name));
    }
    f.integer("seed", c.seed, {.doc = "of the random numbers that the program gets, with its name"});
    f.fraction("latency_us", c.latency_us, {.doc = "computing delay of what it sends", .min = 0});
    describe_frames(f, "sends", c.sends, "kinds of frames that it sends: smv, goose");
    describe_frames(f, "receives", c.receives, "kinds of frames that it receives");
    if (f.has("wire") || !c.sends.empty() || !c.receives.empty()) {
        gateways::describe_wire(f, c.wire);
    }
}

} // namespace gridspace::timebox
