// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/text.hpp"
#include "launcher/cli/checks.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"
#include "launcher/run/monitor_client.hpp"
#include "monitor/app/foreign_idl.hpp"
#include "monitor/app/sample_json.hpp"
#include "monitor/graph/graph_text.hpp"

#include <fmt/format.h>
#include <fstream>
#include <map>
#include <memory>
#include <nlohmann/json.hpp>
#include <optional>
#include <sstream>

namespace gridspace::cli {
namespace {

struct GraphArguments {
    std::filesystem::path run{"latest"};
    std::string format{"text"}; ///< text, dot, json or svg
    bool framework{false};
};

struct ControlArguments {
    std::filesystem::path run{"latest"};
    std::string action; ///< pause, continue, step or stop
    std::int64_t ticks{1};
};

struct TopicArguments {
    std::filesystem::path run{"latest"};
    std::string topic;
    std::filesystem::path idl; ///< of types that nobody publishes
    bool json{false}, framework{false};
};

using Json = nlohmann::ordered_json;

Result<std::string> ask(std::filesystem::path const& run, std::string const& path) {
    auto const folder = closed_run(run);
    if (!folder) {
        return std::unexpected{folder.error()};
    }
    auto address = launcher::monitor_address(std::filesystem::is_directory(*folder) ? *folder : run);
    return address ? launcher::ask_monitor(*address, path) : std::unexpected{address.error()};
}

Result<Json> ask_json(std::filesystem::path const& run, std::string const& path) {
    auto body = ask(run, path);
    if (!body) {
        return std::unexpected{body.error()};
    }
    Json json = Json::parse(*body, nullptr, false);
    return json.is_discarded() ? fail(ExitCode::environment, "the monitor's answer is not JSON")
                               : Result<Json>{std::move(json)};
}

/// Everything but letters, digits and the few signs that mean nothing in a URL.
std::string url_part(std::string const& text) {
    std::string out;
    for (char const c : text) {
        bool const plain = std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '-' || c == '.';
        out += plain ? std::string{c} : fmt::format("%{:02X}", static_cast<unsigned char>(c));
    }
    return out;
}

std::string text_of(Json const& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

/// A name that somebody else has given, for a terminal.
std::string name_in(Json const& object, char const* key) {
    return printable(object.value(key, ""));
}

/// Why there may be fewer samples than are written.
void print_not_heard(Json const& topic, std::FILE* where) {
    for (Json const& reason : topic.value("not_heard", Json::array())) {
        fmt::print(where, "  the monitor hears nothing from {}\n", text_of(reason));
    }
}

void print_graph(Json const& graph, bool framework) {
    std::map<std::string, bool> own;
    for (Json const& topic : graph.at("topics")) {
        own[topic.value("name", "")] = topic.value("framework", false);
    }
    for (Json const& process : graph.at("processes")) {
        fmt::print("{:<16} {:<22} {:<14} {}\n", name_in(process, "name"), name_in(process, "program"),
                   name_in(process, "host"), name_in(process, "state"));
        for (Json const& edge : graph.at("edges")) {
            if (edge.value("process", "") != process.value("name", "") ||
                (own[edge.value("topic", "")] && !framework)) {
                continue;
            }
            fmt::print("  {} {}\n", edge.value("writes", false) ? "->" : "<-", name_in(edge, "topic"));
            for (Json const& problem : edge.at("problems")) {
                fmt::print("     mismatch: {}\n", printable(text_of(problem)));
            }
        }
        for (Json const& wire : graph.at("wires")) {
            if (wire.value("process", "") == process.value("name", "")) {
                fmt::print("  {} {} ({} on {})\n",
                           wire.value("publishes", false) ? "=>" : "<=", name_in(wire, "stream"), name_in(wire, "kind"),
                           name_in(wire, "link"));
            }
        }
    }
}

/// The graph of a finished run, if its monitor has kept it.
std::optional<gridspace::graph::Snapshot> kept_graph(std::filesystem::path const& run) {
    auto const folder = closed_run(run);
    if (!folder) {
        return std::nullopt;
    }
    std::ifstream stream{*folder / "graph.json"};
    std::stringstream text;
    text << stream.rdbuf();
    return stream ? gridspace::graph::from_json(text.str()) : std::nullopt;
}

/// Replaces what the monitor made of the samples by what the user's own IDL says of them.
Result<void> decode_samples(Json& answer, std::filesystem::path const& file) {
    auto const idl = monitor::read_foreign_idl(file);
    if (!idl) {
        return std::unexpected{idl.error()};
    }
    std::string const type = answer.value("type", "");
    auto const text = idl->find(type);
    if (text == idl->end()) {
        return fail(ExitCode::usage, fmt::format("'{}' does not define {}", file.string(), type),
                    fmt::format("it defines {}", idl->begin()->first));
    }
    for (Json& sample : answer.at("last")) {
        std::string const digits = sample.value("cdr", "");
        std::vector<std::byte> cdr;
        for (std::size_t i = 0; i + 1 < digits.size(); i += 2) {
            cdr.push_back(static_cast<std::byte>(std::stoul(digits.substr(i, 2), nullptr, 16)));
        }
        for (char const* key : {"cdr", "key", "fields", "error", "cut"}) {
            sample.erase(key);
        }
        sample.update(monitor::sample_to_json(text->second, type, cdr));
    }
    return {};
}

int control(ControlArguments const& arguments) {
    std::string const action = arguments.action == "step" ? fmt::format("step {}", arguments.ticks) : arguments.action;
    auto const folder = closed_run(arguments.run);
    if (!folder) {
        return print_error(folder.error());
    }
    auto const done = launcher::control_run(*folder, action);
    return done ? 0 : print_error(done.error());
}

int graph(GraphArguments const& arguments) {
    auto body = ask(arguments.run, "/api/v1/graph");
    auto const kept = body ? std::nullopt : kept_graph(arguments.run);
    if (!body && !kept) {
        return print_error(body.error());
    }
    if (kept) {
        fmt::print(stderr, "note: the run is over; this is its graph as its monitor saw it\n");
    }
    auto const snapshot = kept ? kept : gridspace::graph::from_json(*body);
    if (!snapshot) {
        return print_error({ExitCode::environment, "the monitor's answer is no graph", ""});
    }
    std::string const json = gridspace::graph::to_json(*snapshot);
    if (arguments.format == "text") {
        print_graph(Json::parse(json), arguments.framework);
        return 0;
    }
    fmt::print("{}\n", arguments.format == "json"  ? (kept ? json : *body)
                       : arguments.format == "dot" ? gridspace::graph::to_dot(*snapshot, arguments.framework)
                                                   : gridspace::graph::to_svg(*snapshot, arguments.framework));
    return 0;
}

int topic_list(TopicArguments const& arguments) {
    auto const json = ask_json(arguments.run, "/api/v1/topics");
    if (!json) {
        return print_error(json.error());
    }
    if (arguments.json) {
        fmt::print("{}\n", json->dump(2));
        return 0;
    }
    fmt::print("{:<24} {:<20} {:<12} {:>7} {:>7} {:>10} {:>10}\n", "topic", "type", "network", "writers", "readers",
               "samples", "per s");
    for (Json const& topic : json->at("topics")) {
        if (arguments.framework || !topic.value("framework", false)) {
            fmt::print("{:<24} {:<20} {:<12} {:>7} {:>7} {:>10} {:>10.1f}\n", topic.value("name", ""),
                       topic.value("type", ""), topic.value("network", ""), topic.value("writers", 0),
                       topic.value("readers", 0), topic.value("samples", std::uint64_t{0}),
                       topic.value("samples_per_second", 0.0));
            print_not_heard(topic, stdout);
        }
    }
    return 0;
}

int topic_info(TopicArguments const& arguments) {
    auto const json = ask_json(arguments.run, "/api/v1/topics/" + url_part(arguments.topic));
    auto const graph = json ? ask_json(arguments.run, "/api/v1/graph") : json;
    if (!graph) {
        return print_error(graph.error());
    }
    Json endpoints = Json::array();
    for (Json const& endpoint : graph->at("endpoints")) {
        if (endpoint.value("topic", "") == arguments.topic) {
            endpoints.push_back(endpoint);
        }
    }
    if (arguments.json) {
        Json out = *json;
        out["endpoints"] = endpoints;
        fmt::print("{}\n", out.dump(2));
        return 0;
    }
    fmt::print("{}: {} on {}, {} samples\n", json->value("name", ""), json->value("type", ""),
               json->value("network", ""), json->value("samples", std::uint64_t{0}));
    print_not_heard(*json, stdout);
    for (Json const& endpoint : endpoints) {
        Json const& qos = endpoint.at("qos");
        fmt::print("  {} {:<16} {}, {}\n", endpoint.value("writer", false) ? "->" : "<-", endpoint.value("process", ""),
                   text_of(qos.at("reliability")), text_of(qos.at("durability")));
    }
    fmt::print("\n{}\n", json->value("idl", ""));
    return 0;
}

int topic_echo(TopicArguments const& arguments) {
    std::string const query = arguments.idl.empty() ? "" : "?cdr=1";
    auto json = ask_json(arguments.run, "/api/v1/topics/" + url_part(arguments.topic) + "/last" + query);
    if (!json) {
        return print_error(json.error());
    }
    if (!arguments.idl.empty()) {
        if (auto ok = decode_samples(*json, arguments.idl); !ok) {
            return print_error(ok.error());
        }
    }
    if (arguments.json) {
        fmt::print("{}\n", json->dump(2));
        return 0;
    }
    if (json->at("last").empty()) {
        fmt::print(stderr, "no sample of '{}' has come yet\n", arguments.topic);
    }
    print_not_heard(*json, stderr);
    for (Json const& sample : json->at("last")) {
        std::string const process = sample.value("process", "");
        fmt::print("# {} from {}\n", arguments.topic, process.empty() ? "an unnamed process" : process);
        if (sample.contains("error")) {
            fmt::print("  {}\n", sample.value("error", ""));
        } else {
            for (auto const& [name, value] : sample.at("fields").items()) {
                fmt::print("  {}: {}\n", name, text_of(value));
            }
        }
    }
    return 0;
}

int topic_hz(TopicArguments const& arguments) {
    auto const json = ask_json(arguments.run, "/api/v1/topics/" + url_part(arguments.topic));
    if (!json) {
        return print_error(json.error());
    }
    fmt::print("{:.2f} samples/s of wall clock, {} so far\n", json->value("samples_per_second", 0.0),
               json->value("samples", std::uint64_t{0}));
    return 0;
}

} // namespace

void add_graph(Command app, Action& action) {
    auto const a = std::make_shared<GraphArguments>();
    Command verb = app.add_subcommand("graph", "who talks to whom in a running scenario");
    verb.add_option("RUN", a->run, "run folder, or address of a monitor (default: latest)");
    auto const format = [&](char const* name, char const* description) {
        return verb.add_flag("--" + std::string{name}, [a, name] { a->format = name; }, description);
    };
    Option as_dot = format("dot", "for Graphviz");
    Option as_json = format("json", "everything, as JSON").excludes(as_dot);
    format("svg", "as a picture").excludes(as_dot).excludes(as_json);
    verb.add_flag("--framework", a->framework, "with the topics of the framework itself");
    verb.callback([a, &action] { action = [a] { return graph(*a); }; });
}

void add_topic(Command app, Action& action) {
    auto const a = std::make_shared<TopicArguments>();
    Command verb = app.add_subcommand("topic", "look at the topics of a running scenario");
    verb.require_subcommand();
    auto const add = [&](char const* name, char const* description, bool one, int (*act)(TopicArguments const&)) {
        Command command = verb.add_subcommand(name, description);
        if (one) {
            command.add_option("TOPIC", a->topic, "its name").required();
        } else {
            command.add_flag("--framework", a->framework, "with the topics of the framework itself");
        }
        command.add_option("--run", a->run, "run folder, or address of a monitor (default: latest)");
        command.add_flag("--json", a->json, "as JSON");
        if (act == topic_echo) {
            command.add_option("--idl", a->idl, "IDL of its type, when nobody publishes it").check(existing_file());
        }
        command.callback([a, act, &action] { action = [a, act] { return act(*a); }; });
    };
    add("list", "all topics, with rates", false, topic_list);
    add("info", "its type, readers and writers, IDL", true, topic_info);
    add("echo", "its newest samples, decoded", true, topic_echo);
    add("hz", "how often it is written", true, topic_hz);
}

void add_control(Command app, Action& action) {
    auto const a = std::make_shared<ControlArguments>();
    auto const add = [&](char const* name, char const* description) {
        Command verb = app.add_subcommand(name, description);
        verb.add_option("RUN", a->run, "run folder (default: latest), started with --allow-control");
        verb.callback([a, name, &action] {
            a->action = name;
            action = [a] { return control(*a); };
        });
        return verb;
    };
    add("pause", "let a lockstep run wait after its present tick");
    add("continue", "let a paused run go on");
    add("step", "let a paused run go on for some ticks").add_option("--ticks", a->ticks, "how many").check(positive());
    add("stop", "end a run");
}

} // namespace gridspace::cli
