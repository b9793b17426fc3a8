// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// A program's declaration as text. It is read as every configuration is, by a description of its keys.
#include "common/program/declaration.hpp"

#include "common/config/yaml.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <set>

namespace gridspace::program {
namespace {

using config::Fields;
using config::Key;
using Json = nlohmann::ordered_json;

constexpr std::int64_t kVersion = 1; ///< of the format

// ---- to JSON

Json json_of(Key const& key) {
    Json out{{"key", key.key}, {"kind", config::kind_name(key.kind)}, {"doc", key.doc}};
    if (key.required) {
        out["required"] = true;
    }
    if (!key.default_text.empty()) {
        out["default"] = key.default_text;
    }
    for (auto const& [name, bound] :
         {std::pair{"min", &key.min}, {"max", &key.max}, {"above", &key.above}, {"below", &key.below}}) {
        if (*bound) {
            out[name] = **bound;
        }
    }
    if (!key.words.empty()) {
        out["words"] = key.words;
    }
    for (Key const& child : key.children) {
        out["keys"].push_back(json_of(child));
    }
    return out;
}

Json json_of(Topic const& topic) {
    if (topic.is_stream) {
        return Json{{"stream", topic.topic}};
    }
    Json out{{"topic", topic.topic}, {"type", topic.type}};
    for (auto const& [name, set] : {std::pair{"triggers", topic.triggers}, {"optional", topic.optional}}) {
        if (set) {
            out[name] = true;
        }
    }
    if (!topic.idl.empty()) {
        out["idl"] = topic.idl;
    }
    for (Topic::Only const& only : topic.only) {
        out["only"][only.member] = only.is;
    }
    return out;
}

Json json_of(Signal const& signal) {
    Json out{{"name", signal.name}, {"unit", signal.unit}};
    if (signal.rate_hz != 0) {
        out["rate_hz"] = signal.rate_hz;
    }
    return out;
}

Json json_of(ElementUse const& use) {
    Json out{{"key", use.key}, {"kind", use.kind}};
    if (!use.does.empty()) {
        out["does"] = use.does;
    }
    for (ElementUse::Default const& d : use.defaults) {
        out["defaults"].push_back(Json{{"key", d.key}, {"quantity", d.quantity}});
    }
    return out;
}

template <class T>
Json list_of(std::vector<T> const& values) {
    Json out = Json::array();
    for (T const& value : values) {
        out.push_back(json_of(value));
    }
    return out;
}

// ---- from JSON

void texts(Fields& f, std::string_view key, std::vector<std::string>& out, std::string_view doc) {
    std::vector<config::Ref> words;
    f.references(key, words, {.doc = doc, .may_be_empty = true});
    for (config::Ref& word : words) {
        out.push_back(std::move(word.name));
    }
}

void bound(Fields& f, std::string_view key, std::optional<double>& value) {
    f.number(key, value, {.doc = "bound of the value"});
}

void describe_key(Fields& f, Key& key, int depth);

void describe_keys(Fields& f, std::string_view name, std::vector<Key>& keys, std::string_view doc, int depth) {
    if (depth > 8) {
        config::Node ignored;
        f.raw(name, ignored);
        return f.error(name, "keys within keys, more than eight deep");
    }
    f.list(name, {.doc = doc}, [&](Fields& k) { describe_key(k, keys.emplace_back(), depth + 1); });
}

/// A default must be a value that may be given.
void check_default(Fields& f, Key key) {
    using Kind = Key::Kind;
    bool const has_range = key.kind == Kind::number || key.kind == Kind::integer || key.kind == Kind::fraction ||
                           key.kind == Kind::flag || (key.kind == Kind::word && !key.words.empty());
    if (key.default_text.empty() || !has_range) {
        return;
    }
    config::Diagnostics mistakes;
    config::Node given = config::Node::map();
    given.set(key.key, config::Node::scalar(key.default_text));
    config::read_fields(given, "", mistakes, [&](Fields& g) { config::read_keys(g, {key}); });
    if (!mistakes.ok()) {
        f.error("default", fmt::format("the setting '{}' cannot have its own default, {}", key.key, key.default_text),
                "a value of its kind, within its bounds");
    }
}

/// Nothing is said twice.
template <class T, class Name>
void check_names(Fields& f, std::string_view list, std::vector<T> const& all, Name const& name) {
    std::set<std::string_view> seen;
    for (T const& one : all) {
        if (!seen.insert(name(one)).second) {
            f.error(list, fmt::format("`{}` has '{}' twice", list, name(one)));
        }
    }
}

void describe_key(Fields& f, Key& key, int depth) {
    f.text("key", key.key, {.doc = "its name; a unit is its suffix", .required = true});
    std::string kind;
    f.text("kind", kind, {.doc = "number, integer, fraction, text, name, file, flag, word, …", .required = true});
    if (auto const known = config::kind_of_name(kind)) {
        key.kind = *known;
    } else if (!kind.empty()) {
        f.error(
            "kind", fmt::format("'{}' is no kind of setting", kind),
            "number, integer, fraction, text, name, file, flag, word, numbers, names, integers, any, object, map or "
            "list");
    }
    f.text("doc", key.doc, {.doc = "what it means"});
    f.flag("required", key.required, {.doc = "it must be given"});
    f.text("default", key.default_text, {.doc = "what holds when it is not given"});
    bound(f, "min", key.min);
    bound(f, "max", key.max);
    bound(f, "above", key.above);
    bound(f, "below", key.below);
    texts(f, "words", key.words, "of a word: those that there are");
    if (key.kind == Key::Kind::word && key.words.empty()) {
        f.error("", fmt::format("the setting '{}' is a word, and no words are named", key.key), "words: [...]");
    }
    check_default(f, key);
    if (f.has("keys")) {
        describe_keys(f, "keys", key.children, "of an object, the entries of a map, the items of a list", depth);
    }
}

void describe_only(Fields& f, std::vector<Topic::Only>& only) {
    config::Node given;
    f.raw("only", given);
    bool fits = given.is_map();
    for (config::Node::Entry const& entry : given.entries) {
        fits &= entry.value.is_scalar();
        only.push_back({entry.key, entry.value.text});
    }
    if (!fits) {
        f.error("only", fmt::format("`only` is {}", describe(given)), R"(texts by their member: {"bus": "{bus}"})");
    }
}

void describe(Fields& f, Topic& topic) {
    topic.is_stream = f.has("stream");
    if (topic.is_stream) {
        f.text("stream", topic.topic, {.doc = "instead of the rest: a stream's name, or a pattern", .required = true});
        return;
    }
    f.text("topic", topic.topic, {.doc = "its name, or a pattern: {KEY} is the value of a setting", .required = true});
    f.text("type", topic.type, {.doc = "name of the type on the wire", .required = true});
    f.flag("triggers", topic.triggers, {.doc = "a sample makes the program work in the same tick"});
    f.flag("optional", topic.optional, {.doc = "it may stay without a writer, or a reader"});
    f.text("idl", topic.idl, {.doc = "IDL file of a type of its own, from the folder of the program"});
    if (f.has("only")) {
        describe_only(f, topic.only);
    }
}

void describe(Fields& f, Signal& signal) {
    f.text("name", signal.name, {.doc = "kind.element.quantity, or a pattern", .required = true});
    f.text("unit", signal.unit, {.doc = "its unit"});
    f.number("rate_hz", signal.rate_hz, {.doc = "0: when something changes", .min = 0});
}

void describe(Fields& f, ElementUse& use) {
    f.text("key", use.key, {.doc = "the setting that names elements", .required = true});
    f.text("kind", use.kind, {.doc = "what it names: ev, bus, …", .required = true});
    f.text("does", use.does, {.doc = "what only one process may do for an element: \"acts for\""});
    f.list("defaults", {.doc = "settings that are taken from the element"}, [&](Fields& d) {
        ElementUse::Default& out = use.defaults.emplace_back();
        d.text("key", out.key, {.doc = "the setting", .required = true});
        d.text("quantity", out.quantity, {.doc = "of the element", .required = true});
    });
}

template <class T>
void describe_list(Fields& f, std::string_view key, std::vector<T>& values, std::string_view doc) {
    f.list(key, {.doc = doc}, [&](Fields& one) { describe(one, values.emplace_back()); });
}

void describe(Fields& f, Declaration& d) {
    std::int64_t version = kVersion;
    f.integer("gridspace_program", version, {.doc = "version of this format", .required = true, .min = 1, .max = 1});
    f.text("name", d.name, {.doc = "name of the program", .required = true});
    std::string program_version;
    f.text("version", program_version, {.doc = "its version"});
    f.text("description", d.description, {.doc = "one line"});
    f.text("role", d.role, {.doc = "QoS role when a process names none"});
    f.flag("member", d.member, {.doc = "it takes part in the barrier in lockstep"});
    f.flag("daemon", d.daemon, {.doc = "it is started with --config FILE --log-level LEVEL --status-fd N"});
    describe_keys(f, "settings", d.settings, "the keys of a process", 0);
    texts(f, "whole_steps", d.whole_steps, "settings that are whole multiples of the step of the simulation");
    f.text("latency", d.latency, {.doc = "the setting, in microseconds, of the time from input to output"});
    describe_list(f, "elements", d.elements, "settings that name elements of the grid");
    describe_list(f, "reads", d.reads, "topics that it reads");
    describe_list(f, "writes", d.writes, "topics that it writes");
    describe_list(f, "signals", d.signals, "signals that it publishes");
    check_names(f, "settings", d.settings, [](Key const& key) -> std::string_view { return key.key; });
    for (auto const& [list, topics] : {std::pair{"reads", &d.reads}, {"writes", &d.writes}}) {
        check_names(f, list, *topics, [](Topic const& topic) -> std::string_view { return topic.topic; });
    }
    if (std::ranges::any_of(d.writes, [](Topic const& topic) { return !topic.only.empty(); })) {
        f.error("writes", "`only` belongs to what a program reads");
    }
    check_names(f, "signals", d.signals, [](Signal const& signal) -> std::string_view { return signal.name; });
}

} // namespace

std::string to_json(Declaration const& d, std::string_view version) {
    Json out{{"gridspace_program", kVersion}, {"name", d.name}, {"version", version}, {"description", d.description}};
    out["role"] = d.role;
    out["member"] = d.member;
    out["daemon"] = d.daemon;
    out["settings"] = list_of(d.settings);
    if (!d.whole_steps.empty()) {
        out["whole_steps"] = d.whole_steps;
    }
    if (!d.latency.empty()) {
        out["latency"] = d.latency;
    }
    out["elements"] = list_of(d.elements);
    out["reads"] = list_of(d.reads);
    out["writes"] = list_of(d.writes);
    out["signals"] = list_of(d.signals);
    return out.dump(1) + "\n";
}

std::optional<Declaration> from_json(std::string const& text, std::string const& source,
                                     config::Diagnostics& diagnostics) {
    auto const errors = diagnostics.errors();
    auto const root = config::parse_yaml(text, config::make_source(source, text), diagnostics);
    if (!root) {
        return std::nullopt;
    }
    Declaration out;
    config::read_fields(*root, "", diagnostics, [&](Fields& f) { describe(f, out); });
    return diagnostics.errors() == errors ? std::optional{std::move(out)} : std::nullopt;
}

} // namespace gridspace::program
