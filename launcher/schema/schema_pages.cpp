// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/schema/schema_pages.hpp"

#include "bus/node_config.hpp"
#include "common/config/key.hpp"
#include "common/text.hpp"
#include "gateways/streams/stream.hpp"
#include "launcher/certify/certify_case.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/schema/schema_definitions.hpp"
#include "launcher/sweep/study.hpp"
#include "router/router_config.hpp"
#include "sim/network/network_config.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

namespace gridspace::launcher {
namespace {

using Json = nlohmann::ordered_json;
using config::Key;
using config::keys_of;
using Kind = Key::Kind;
using Keys = std::vector<Key>;

Keys network_keys() {
    sim::Network network;
    return keys_of([&](config::Fields& f) { sim::describe(f, network); });
}
Keys scenario_keys() {
    return keys_of([](config::Fields& f) { describe_scenario_keys(f); });
}
Keys program_keys(std::string const& program) {
    return keys_of([&](config::Fields& f) { (void)find_program(program)->read(f); });
}
Keys router_keys() {
    router::RouterConfig router;
    return keys_of([&](config::Fields& f) { describe(f, router); });
}
Keys study_keys() {
    return keys_of([](config::Fields& f) { describe_study_keys(f); });
}
Keys certify_keys() {
    return keys_of([](config::Fields& f) { describe_certify_keys(f); });
}
Keys stream_keys() {
    streams::Stream smv, goose;
    goose.kind = streams::Kind::goose;
    return keys_of([&](config::Fields& f) { // the keys of both kinds
        describe(f, smv);
        describe(f, goose);
    });
}

// ---- JSON schema

Json properties_of(Keys const& keys);

Json or_null(Json schema) {
    return Json{{"anyOf", Json::array({std::move(schema), Json{{"type", "null"}}})}};
}

Json number_schema(Key const& key, char const* type) {
    Json json{{"type", type}};
    for (auto const& [name, bound] : {std::pair{"minimum", &key.min},
                                      {"maximum", &key.max},
                                      {"exclusiveMinimum", &key.above},
                                      {"exclusiveMaximum", &key.below}}) {
        if (*bound) {
            json[name] = **bound;
        }
    }
    return json;
}

/// What may stand under a key. A `~` removes what another file says, so everything may be null.
Json schema_of(Key const& key) {
    Json const text{{"type", "string"}};
    Json const fraction{{"type", "string"}, {"pattern", "^ *[0-9.]+ */ *[0-9.]+ *$"}};
    Json const scalar{{"type", Json::array({"string", "number", "boolean"})}};
    Json json;
    switch (key.kind) {
    case Kind::number:
    case Kind::fraction:
        json = Json{{"anyOf", Json::array({number_schema(key, "number"), fraction})}};
        if (!key.words.empty()) {
            json["anyOf"].push_back(Json{{"enum", key.words}});
        }
        break;
    case Kind::integer:
        json = number_schema(key, "integer");
        break;
    case Kind::flag:
        json = Json{{"type", "boolean"}};
        break;
    case Kind::word:
        json = Json{{"enum", key.words}};
        break;
    case Kind::numbers:
        json = Json{{"type", "array"}, {"items", Json{{"type", "number"}}}};
        break;
    case Kind::names:
        json = Json{{"type", "array"}, {"items", scalar}};
        break;
    case Kind::integers:
        json = Json{{"type", "object"}, {"additionalProperties", Json{{"type", "integer"}}}};
        break;
    case Kind::object:
        json = properties_of(key.children);
        break;
    case Kind::map:
        json = Json{{"type", "object"}, {"additionalProperties", or_null(properties_of(key.children))}};
        break;
    case Kind::list:
        json = Json{{"type", "array"}, {"items", properties_of(key.children)}};
        break;
    case Kind::text:
    case Kind::name:
    case Kind::file:
        json = scalar;
        break;
    case Kind::any:
        return Json{{"description", key.doc}};
    }
    return Json{{"description", key.doc}, {"anyOf", Json::array({json, Json{{"type", "null"}}})}};
}

Json properties_of(Keys const& keys) {
    Json properties = Json::object();
    for (Key const& key : keys) {
        properties[key.key] = schema_of(key);
    }
    // A key that is not known here may still be removed: an extended file's process may be another program.
    return Json{{"type", "object"}, {"properties", properties}, {"additionalProperties", Json{{"type", "null"}}}};
}

std::string finished(Json root, char const* title) {
    Json out{{"$schema", "http://json-schema.org/draft-07/schema#"}, {"title", title}};
    root["properties"]["extends"] = Json{{"type", "string"}, {"description", "the file that this one lies on"}};
    out.update(root);
    return with_definitions(out.dump());
}

// ---- reference page

std::string cell(std::string const& text) { // a bar would end the cell
    std::string out;
    for (char const c : text) {
        out += c == '|' ? "\\|" : std::string(1, c);
    }
    return out;
}

std::string kind_text(Key const& key) {
    switch (key.kind) {
    case Kind::number: {
        std::string_view const unit = config::unit_of_key(key.key);
        return unit.empty() ? "number" : std::string{unit};
    }
    case Kind::fraction: {
        std::string_view const unit = config::unit_of_key(key.key);
        std::string const number = unit.empty() ? "fraction" : fmt::format("{}, exact", unit);
        return key.words.empty() ? number : fmt::format("{}, or `{}`", number, key.words.front());
    }
    case Kind::integer:
        return "integer";
    case Kind::text:
        return "text";
    case Kind::name:
        return "name";
    case Kind::file:
        return "file";
    case Kind::flag:
        return "true, false";
    case Kind::word: {
        std::vector<std::string> quoted;
        for (std::string const& word : key.words) {
            quoted.push_back("`" + word + "`");
        }
        return join(quoted, " ");
    }
    case Kind::numbers:
        return "[numbers]";
    case Kind::names:
        return "[names]";
    case Kind::integers:
        return "{name: integer}";
    case Kind::any:
        return "";
    case Kind::object:
        return "{…}";
    case Kind::map:
        return "{NAME: {…}}";
    case Kind::list:
        return "[{…}]";
    }
    return "";
}

std::string range_text(Key const& key) {
    std::vector<std::string> parts;
    for (auto const& [sign, bound] :
         {std::pair{">=", &key.min}, {">", &key.above}, {"<=", &key.max}, {"<", &key.below}}) {
        if (*bound) {
            parts.push_back(fmt::format("{} {}", sign, shortest(**bound)));
        }
    }
    return join(parts, ", ");
}

std::string default_text(Key const& key) {
    return key.default_text.empty() ? "" : "`" + cell(key.default_text) + "`";
}

/// A table of keys, then one for each that has keys of its own.
std::string tables(std::string const& path, Keys const& keys, Keys const& left_out = {}) {
    std::string out = "| key | value | range | default | meaning |\n|---|---|---|---|---|\n", nested;
    for (Key const& key : keys) {
        bool const skip = std::any_of(left_out.begin(), left_out.end(), [&](Key const& k) { return k.key == key.key; });
        if (skip) {
            continue;
        }
        out += fmt::format("| `{}`{} | {} | {} | {} | {} |\n", key.key, key.required ? " **required**" : "",
                           cell(kind_text(key)), range_text(key), default_text(key), cell(key.doc));
        if (!key.children.empty()) {
            std::string const name = (path.empty() ? "" : path + ".") + key.key +
                                     (key.kind == Kind::map    ? ".NAME"
                                      : key.kind == Kind::list ? "[]"
                                                               : "");
            nested += fmt::format("\n#### `{}`\n{}\n\n{}", name, key.doc, tables(name, key.children));
        }
    }
    return out + nested;
}

/// " Reads the topic `x` (`Type`). Writes the stream `{to}`."
std::string exchanges(program::Declaration const& declaration) {
    std::string out;
    for (auto const& [verb, topics] : {std::pair{"Reads", &declaration.reads}, {"Writes", &declaration.writes}}) {
        std::vector<std::string> what;
        for (program::Topic const& topic : *topics) {
            what.push_back(topic.is_stream ? fmt::format("the stream `{}`", topic.topic)
                                           : fmt::format("the topic `{}` (`{}`)", topic.topic, topic.type));
        }
        out += what.empty() ? "" : fmt::format(" {} {}.", verb, join(what, ", "));
    }
    return out;
}

} // namespace

std::string network_schema() {
    return finished(properties_of(network_keys()), "Gridspace network");
}

std::string router_schema() {
    return finished(properties_of(router_keys()), "Gridspace router");
}

std::string study_schema() {
    return finished(properties_of(study_keys()), "Gridspace study");
}

std::string certify_schema() {
    return finished(properties_of(certify_keys()), "Gridspace certification of a relay");
}

std::string scenario_schema() {
    Json root = properties_of(scenario_keys());
    Keys const common = [] {
        for (Key const& key : scenario_keys()) {
            if (key.key == "processes") {
                return key.children;
            }
        }
        return Keys{};
    }();
    // A process is judged by its program; one that says none has it from the file that this one extends.
    Json kinds = Json::array();
    for (std::string const& name : program_names()) {
        Keys keys = common;
        std::ranges::copy(program_keys(name), std::back_inserter(keys));
        Json process = properties_of(keys);
        process["properties"]["program"] = Json{{"const", name}};
        root["properties"]["defaults"]["properties"][name] = process;
        kinds.push_back(std::move(process));
    }
    // Somebody else's program says itself what its keys are.
    Json own = properties_of(common);
    own["properties"]["program"] =
        Json{{"type", "object"},
             {"properties", Json{{"path", Json{{"type", "string"}}},
                                 {"arguments", Json{{"type", "array"}, {"items", Json{{"type", "string"}}}}}}},
             {"required", Json::array({"path"})},
             {"additionalProperties", false}};
    own["additionalProperties"] = true;
    kinds.push_back(std::move(own));
    root["properties"]["processes"] = Json{{"type", "object"}, {"additionalProperties", Json{{"anyOf", kinds}}}};
    kinds.push_back(Json{{"type", "null"}});
    root["properties"]["processes"]["additionalProperties"]["anyOf"] = kinds;
    root["properties"]["security"] = // YAML's `on` is a word or a truth, by its version
        Json{{"anyOf", Json::array({root["properties"]["security"], Json{{"enum", {"on", "off", true, false}}}})}};
    Keys streams = stream_keys();
    Key like;
    like.key = "like";
    like.kind = Kind::name;
    like.doc = "the stream that this one is like";
    streams.push_back(like);
    root["properties"]["streams"] = Json{{"type", "object"}, {"additionalProperties", or_null(properties_of(streams))}};
    return finished(std::move(root), "Gridspace scenario");
}

std::string config_page() {
    std::string out = R"(# Configuration files

*Made by `gridspace schema --write .` from the descriptions that read the files; a test keeps it current.*

What the files are for: [write a scenario](../how_to/write_a_scenario.md), [write a network](../how_to/write_a_network.md). JSON schemas
for editors are in [`configs/schema`](../../configs/schema); the first line `# yaml-language-server: $schema=../schema/scenario.schema.json` switches them on.

Units are suffixes of the keys, and values carry none. "exact" values may be fractions (`1/48000`). NAME stands for a name of
yours. A key whose value is left open here is described where the table says.

## Scenario
`extends: FILE` may stand in every file.

)";
    Keys const scenario = scenario_keys();
    out += tables("", scenario);
    out += "\n## Programs\nKeys of a process beside those above, by its `program`. `program: {path: FILE, arguments: "
           "[...]}` is "
           "a program of your own that [says itself](program_description.md) what its keys are.\n";
    for (std::string const& name : program_names()) {
        Keys const keys = program_keys(name);
        Program const& program = *find_program(name);
        out += fmt::format("\n### `{}`\n{}.{}\n", name, program.description,
                           program.declaration == nullptr ? "" : exchanges(*program.declaration));
        if (!keys.empty()) {
            out += "\n" + tables("", keys);
        }
    }
    out += "\n## Streams\n`streams.NAME` of a scenario; `like: OTHER` takes everything from another stream except for "
           "the keys beside it.\n\n" +
           tables("streams.NAME", stream_keys());
    out += "\n## Network\n\n" + tables("", network_keys());
    out += "\n## Router\nWhat `gridspace router CONFIG` reads ([how to](../how_to/connect_two_sites.md)).\n\n" +
           tables("", router_keys());
    out += "\n## Study\nWhat `gridspace sweep STUDY` reads ([what it does](sweep.md)).\n\n" + tables("", study_keys());
    out += "\n## Certification\nWhat `gridspace certify CASE` reads ([what it "
           "does](../tutorials/certify_a_relay.md)).\n\n" +
           tables("", certify_keys());
    bus::NodeConfig node;
    out += "\n## Place on the bus\n`bus:` of the configuration file of a process, which `gridspace run` writes.\n\n" +
           tables("bus", keys_of([&](config::Fields& f) { bus::describe(f, node); }));
    return out;
}

} // namespace gridspace::launcher
