// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scl/stream_fields.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace gridspace::launcher {
namespace {

using config::Node;
using iec61850::BasicType;
using scl::MemberOrigin;

constexpr double kSmallest = 1e-12, kLargest = 1e12;       // of a scale that somebody meant
constexpr double kCurrentStep = 1e-3, kVoltageStep = 1e-2; // of integers: 9-2LE and IEC 61869-9

MemberOrigin const* origin_of(scl::ControlBlock const& block, std::string_view leaf) {
    std::string_view const member = leaf.substr(0, leaf.find('.'));
    auto const found = std::find_if(block.members.begin(), block.members.end(),
                                    [&](MemberOrigin const& m) { return m.name == member; });
    return found == block.members.end() ? nullptr : &*found;
}

/// The instrument transformer that a member belongs to: all its attributes have the same.
std::string transformer_of(MemberOrigin const& m) {
    return fmt::format("{}/{}{}{}", m.ld_inst, m.prefix, m.ln_class, m.ln_inst);
}

/// "ia" … "vc" by instrument transformer, or "" for a neutral: in the order of the data set they are phases a, b, c
/// and, where they come in fours, the neutral.
std::map<std::string, std::string> phases_of(scl::ControlBlock const& block) {
    std::map<std::string, std::string> out;
    for (auto const& [cls, letter] : {std::pair{"TCTR", 'i'}, {"TVTR", 'v'}}) {
        std::vector<std::string> order;
        for (MemberOrigin const& m : block.members) {
            if (m.ln_class == cls && std::find(order.begin(), order.end(), transformer_of(m)) == order.end()) {
                order.push_back(transformer_of(m));
            }
        }
        std::size_t const group = order.size() % 4 == 0 ? 4 : 3;
        for (std::size_t i = 0; i < order.size(); ++i) {
            std::size_t const phase = i % group;
            out[order[i]] = phase == 3 ? "" : fmt::format("{}{}", letter, static_cast<char>('a' + phase));
        }
    }
    return out;
}

bool is_measured(MemberOrigin const& m, std::string_view leaf, BasicType type) {
    std::string_view const last = leaf.substr(leaf.find_last_of("._") + 1);
    return (m.ln_class == "TCTR" || m.ln_class == "TVTR") && iec61850::is_number(type) && (last == "i" || last == "f");
}

Node value(std::string text) {
    Node out = Node::map();
    out.set("value", Node::scalar(std::move(text)));
    return out;
}

/// The constant of a leaf; nothing for a type that cannot be written as one.
std::optional<std::string> constant_of(MemberOrigin const* origin, BasicType type) {
    switch (type) {
    case BasicType::boolean:
        return "false";
    case BasicType::position:
        return "closed";
    case BasicType::quality:
        return "good";
    case BasicType::enumerated: {
        bool const state =
            origin != nullptr && (origin->object == "Beh" || origin->object == "Mod" || origin->object == "Health");
        return state ? "1" : "0"; // on; Ok
    }
    default:
        return iec61850::is_number(type) ? std::optional<std::string>{"0"} : std::nullopt;
    }
}

} // namespace

Node sampled_fields(scl::ControlBlock const& block, streams::Stream const& stream, std::string const& source) {
    Node out = Node::map();
    auto const phases = phases_of(block);
    bool measured = false;
    for (iec61850::Leaf const& leaf : iec61850::leaves_of(stream.data_set)) {
        MemberOrigin const* const origin = origin_of(block, leaf.name);
        if (origin != nullptr && is_measured(*origin, leaf.name, leaf.type)) {
            std::string const& phase = phases.at(transformer_of(*origin));
            if (phase.empty()) { // nobody measures it
                out.set(leaf.name, value("0"));
                continue;
            }
            double const usual = !iec61850::is_integer(leaf.type) ? 1 : phase[0] == 'i' ? kCurrentStep : kVoltageStep;
            double const step = iec61850::is_integer(leaf.type) && origin->scale > kSmallest && origin->scale < kLargest
                                    ? origin->scale
                                    : usual;
            Node field = Node::map();
            field.set("from", Node::scalar(source + "." + phase));
            if (step != 1) {
                field.set("scale", Node::scalar(shortest(1 / step)));
            }
            if (std::isfinite(origin->offset) && origin->offset != 0 && iec61850::is_integer(leaf.type)) {
                field.set("offset", Node::scalar(shortest(-origin->offset / step)));
            }
            out.set(leaf.name, std::move(field));
            measured = true;
            continue;
        }
        bool const neutral = origin != nullptr && leaf.type == BasicType::quality &&
                             phases.contains(transformer_of(*origin)) && phases.at(transformer_of(*origin)).empty();
        if (auto const constant = constant_of(origin, leaf.type)) {
            out.set(leaf.name, value(neutral ? "derived" : *constant));
        }
    }
    return measured ? out : Node::map();
}

Node constant_fields(scl::ControlBlock const& block, streams::Stream const& stream) {
    Node out = Node::map();
    for (iec61850::Leaf const& leaf : iec61850::leaves_of(stream.data_set)) {
        if (auto const constant = constant_of(origin_of(block, leaf.name), leaf.type)) {
            out.set(leaf.name, value(*constant));
        }
    }
    return out;
}

} // namespace gridspace::launcher
