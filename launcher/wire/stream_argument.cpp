// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/config/merge.hpp"
#include "common/text.hpp"
#include "launcher/wire/tools.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>

namespace gridspace::wire {
namespace {

using config::Node;

Node defaults_of(streams::Kind kind) {
    Node out = Node::map();
    bool const smv = kind == streams::Kind::smv;
    out.set("kind", Node::scalar(smv ? "smv" : "goose"));
    out.set("mac", Node::quoted_text(smv ? "01:0C:CD:04:00:01" : "01:0C:CD:01:00:01"));
    if (smv) {
        out.set("sv_id", Node::scalar("GRIDSPACE_MU01"));
        Node set = Node::map();
        for (char const* channel : {"Ia", "Ib", "Ic"}) {
            set.set(channel, Node::scalar("float32"));
        }
        out.set("data_set", std::move(set));
    } else {
        out.set("control_block", Node::scalar("GRIDSPACE_LD0/LLN0$GO$gcb1"));
        Node set = Node::map();
        set.set("status", Node::scalar("boolean"));
        out.set("data_set", std::move(set));
    }
    return out;
}

/// The entry of the file, or the defaults.
std::optional<Node> base_of(StreamArgument const& argument, streams::Kind kind, config::Diagnostics& diagnostics) {
    if (argument.file.empty()) {
        return defaults_of(kind);
    }
    auto root = config::load_extended(argument.file, diagnostics);
    if (!root) {
        return std::nullopt; // it has been said why
    }
    Node* const all = root->find("streams");
    if (all == nullptr || !all->is_map()) {
        diagnostics.error({}, fmt::format("'{}' has no `streams:`", argument.file.string()));
        return std::nullopt;
    }
    config::resolve_likes(*all, diagnostics);
    if (Node const* const found = all->find(argument.name)) {
        return *found;
    }
    std::vector<std::string> names;
    for (Node::Entry const& entry : all->entries) {
        names.push_back(entry.key);
    }
    diagnostics.error(all->where, fmt::format("there is no stream '{}'", argument.name),
                      fmt::format("there are: {}", join(names, ", ")));
    return std::nullopt;
}

std::optional<std::string> octets_of_hexadecimal(std::string const& text) {
    std::string out;
    for (std::size_t i = 0; i < text.size(); i += 2) {
        unsigned octet = 0;
        char const* const from = text.data() + i;
        if (i + 1 == text.size() || std::from_chars(from, from + 2, octet, 16).ptr != from + 2) {
            return std::nullopt;
        }
        out.push_back(static_cast<char>(octet));
    }
    return out;
}

/// Seconds with a fraction of up to nine digits, as a time is printed.
std::optional<iec61850::UtcTime> time_of(std::string const& text) {
    std::size_t const point = text.find('.');
    std::string fraction = text.substr(point + 1);
    std::uint32_t seconds = 0;
    std::int64_t nanoseconds = 0;
    fraction.resize(std::max<std::size_t>(fraction.size(), 9), '0');
    auto const whole = [](std::string_view digits, auto& number) {
        auto const [end, ec] = std::from_chars(digits.data(), digits.data() + digits.size(), number);
        return ec == std::errc{} && end == digits.data() + digits.size();
    };
    bool const good = whole(std::string_view{text}.substr(0, point), seconds) && fraction.size() == 9 &&
                      fraction.front() != '-' && whole(fraction, nanoseconds);
    constexpr std::uint8_t kAccuracyBits = 0x0A;
    return good ? std::optional{iec61850::UtcTime::from_nanoseconds(seconds * std::int64_t{1'000'000'000} + nanoseconds,
                                                                    kAccuracyBits)}
                : std::nullopt;
}

} // namespace

std::optional<streams::Stream> read_stream(StreamArgument const& argument, streams::Kind kind) {
    config::Diagnostics diagnostics;
    std::optional<streams::Stream> out;
    if (auto node = base_of(argument, kind, diagnostics)) {
        for (std::size_t i = 0; i < argument.keys.size(); ++i) {
            if (argument.keys[i].starts_with("data_set=")) {
                node->erase("data_set"); // a new one, not more members
            }
            config::apply_set(*node, argument.keys[i], static_cast<int>(i) + 1, diagnostics);
        }
        Node all = Node::map();
        all.set(argument.name.empty() ? "stream" : argument.name, std::move(*node));
        auto streams = streams::read_streams(all, diagnostics);
        if (!streams.empty() && streams[0].kind != kind) {
            diagnostics.error({}, fmt::format("stream '{}' is {}", streams[0].name.name,
                                              kind == streams::Kind::smv ? "GOOSE" : "sampled values"));
        }
        if (diagnostics.ok() && !streams.empty()) {
            out = std::move(streams[0]);
        }
    }
    if (diagnostics.errors() + diagnostics.warnings() > 0) {
        fmt::print(stderr, "{}\n", diagnostics.render());
    }
    return out;
}

bool is_named(StreamArgument const& argument, std::string_view key) {
    return !argument.file.empty() ||
           std::any_of(argument.keys.begin(), argument.keys.end(),
                       [&](std::string const& text) { return trim(text.substr(0, text.find('='))) == key; });
}

Result<iec61850::Value> parse_value(iec61850::Leaf const& leaf, std::string const& text, std::string& storage) {
    using namespace iec61850;
    auto const refuse = [&](std::string const& expected) -> Result<Value> {
        return fail(ExitCode::usage, fmt::format("'{}' is no value of '{}'", text, leaf.name),
                    fmt::format("it is {}: {}", type_name(leaf.type), expected));
    };
    Value out;
    out.type = leaf.type;
    if (leaf.type == BasicType::boolean) {
        if (text != "true" && text != "false" && text != "1" && text != "0") {
            return refuse("true or false");
        }
        return Value::of(text == "true" || text == "1");
    }
    if (leaf.type == BasicType::position) {
        std::vector<std::string> const words{"intermediate", "open", "closed", "bad"};
        for (std::size_t i = 0; i < words.size(); ++i) {
            if (text == words[i]) {
                out.bits = i;
                return out;
            }
        }
        return refuse(join(words, ", "));
    }
    if (leaf.type == BasicType::octet_string) {
        auto const octets = octets_of_hexadecimal(text);
        if (!octets || octets->size() > leaf.length) {
            return refuse(fmt::format("two hexadecimal digits for each of at most {} octets", leaf.length));
        }
        storage = *octets;
        out.text = octets_of(storage);
        return out;
    }
    if (leaf.type == BasicType::timestamp && text.find('.') != std::string::npos) {
        auto const time = time_of(text);
        return time ? Result<Value>{Value::of(*time)}
                    : refuse("seconds since 1970, as 1575158400.25, or 0x and its bits");
    }
    bool const binary = text.size() == leaf.length && text.find_first_not_of("01") == std::string::npos;
    if (leaf.type == BasicType::bit_string && binary) { // bit 0 first, as it is printed
        for (std::size_t i = 0; i < text.size(); ++i) {
            out.bits |= text[i] == '1' ? std::uint64_t{1} << i : 0;
        }
        out.bit_count = static_cast<std::uint8_t>(leaf.length);
        return out;
    }
    if (is_string(leaf.type)) {
        if (text.size() > leaf.length) {
            return refuse(fmt::format("at most {} characters", leaf.length));
        }
        storage = text;
        out.text = octets_of(storage);
        return out;
    }
    if (is_float(leaf.type)) {
        double v = 0;
        auto const [end, ec] = std::from_chars(text.data(), text.data() + text.size(), v);
        return ec == std::errc{} && end == text.data() + text.size() ? Result<Value>{Value::from_number(leaf.type, v)}
                                                                     : refuse("a number");
    }
    bool const hex = text.starts_with("0x");
    bool const negative = text.starts_with('-');
    std::uint64_t v = 0;
    char const* const from = text.data() + (hex ? 2 : negative ? 1 : 0);
    auto const [end, ec] = std::from_chars(from, text.data() + text.size(), v, hex ? 16 : 10);
    bool const fits = !negative || v <= std::uint64_t{1} << 63U;
    if (ec != std::errc{} || end != text.data() + text.size() || !fits) {
        return refuse("a whole number, or 0x and hexadecimal digits");
    }
    out.bits = negative ? ~v + 1 : v;
    out.bit_count = static_cast<std::uint8_t>(leaf.type == BasicType::bit_string ? leaf.length : 0);
    return out;
}

} // namespace gridspace::wire
