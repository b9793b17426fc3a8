// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/declared_program.hpp"

#include "common/text.hpp"
#include "launcher/scenario/element_names.hpp"
#include "launcher/scenario/file_settings.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_programs.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;
using program::ElementUse;

/// What a setting says, as names: the scalar, the items of a list, the keys of a map. Defaults count.
std::vector<Ref> names_in(program::Declaration const& declaration, Process const& process, std::string_view key) {
    std::vector<Ref> out;
    Node const* node = process.node.find(key);
    if (node == nullptr || node->is_null()) {
        auto const declared = std::find_if(declaration.settings.begin(), declaration.settings.end(),
                                           [&](config::Key const& k) { return k.key == key; });
        if (declared != declaration.settings.end() && !declared->default_text.empty()) {
            out.push_back({declared->default_text, process.name.where});
        }
    } else if (node->is_scalar()) {
        out.push_back({node->text, node->where});
    } else if (node->is_sequence()) {
        for (Node const& item : node->items) {
            out.push_back({item.text, item.where});
        }
    } else {
        for (Node::Entry const& entry : node->entries) {
            out.push_back({entry.key, entry.where});
        }
    }
    return out;
}

program::Values values_of(program::Declaration const& declaration, Process const& process) {
    return [&declaration, &process](std::string_view key) {
        std::vector<std::string> out;
        if (key == "process") {
            return std::vector{process.name.name};
        }
        for (Ref& name : names_in(declaration, process, key)) {
            out.push_back(std::move(name.name));
        }
        return out;
    };
}

std::vector<TopicUse> uses(std::vector<program::Topic> const& topics, program::Declaration const& declaration,
                           Process const& process, std::vector<std::string> const& command) {
    std::filesystem::path const folder =
        command.empty() ? std::filesystem::path{} : std::filesystem::path{command.front()}.parent_path();
    std::vector<TopicUse> out;
    for (program::Topic& topic : program::expand(topics, values_of(declaration, process))) {
        if (topic.is_stream) {
            continue;
        }
        std::filesystem::path const idl = topic.idl.empty() ? std::filesystem::path{} : folder / topic.idl;
        out.push_back(
            {std::move(topic.topic), std::move(topic.type), topic.endpoints, topic.triggers, topic.optional, idl});
    }
    return out;
}

/// The streams among them, where the scenario has them.
std::vector<streams::Stream const*> streams_in(Scenario const& s, std::vector<program::Topic> const& topics,
                                               program::Declaration const& declaration, Process const& process) {
    std::vector<streams::Stream const*> out;
    for (program::Topic const& topic : program::expand(topics, values_of(declaration, process))) {
        streams::Stream const* const stream = topic.is_stream ? streams::find_stream(s.streams, topic.topic) : nullptr;
        if (stream != nullptr) {
            out.push_back(stream);
        }
    }
    return out;
}

std::vector<WireUse> wire_uses(Scenario const& s, std::vector<program::Topic> const& topics,
                               program::Declaration const& declaration, Process const& process) {
    std::vector<WireUse> out;
    for (streams::Stream const* stream : streams_in(s, topics, declaration, process)) {
        out.push_back({raw_link(s, process), stream->ethertype(), stream->name.name});
    }
    return out;
}

bool names_streams(program::Declaration const& declaration) {
    auto const any = [](std::vector<program::Topic> const& topics) {
        return std::any_of(topics.begin(), topics.end(), [](program::Topic const& t) { return t.is_stream; });
    };
    return any(declaration.reads) || any(declaration.writes);
}

/// The setting that names a stream, for its place in the file; the process where none does.
Ref place_of(std::string const& stream, program::Declaration const& declaration, Process const& process) {
    for (config::Key const& key : declaration.settings) {
        for (Ref& name : names_in(declaration, process, key.key)) {
            if (name.name == stream) {
                return std::move(name);
            }
        }
    }
    return process.name;
}

void check_streams(Scenario const& s, Process const& process, program::Declaration const& declaration,
                   Diagnostics& diagnostics) {
    check_raw_link(s, process, diagnostics);
    for (auto const& [topics, written] : {std::pair{&declaration.reads, false}, {&declaration.writes, true}}) {
        for (program::Topic const& topic : program::expand(*topics, values_of(declaration, process))) {
            if (!topic.is_stream) {
                continue;
            }
            Ref const at = place_of(topic.topic, declaration, process);
            streams::Stream const* const stream = streams::find_stream(s.streams, topic.topic);
            if (stream == nullptr) {
                std::vector<std::string> names;
                for (streams::Stream const& one : s.streams) {
                    names.push_back(one.name.name);
                }
                diagnostics.error(at.where,
                                  fmt::format("process '{}' {} the stream '{}', which does not exist",
                                              process.name.name, written ? "writes" : "reads", topic.topic),
                                  spelling_hint(topic.topic, names, "`streams:` declares none"),
                                  static_cast<int>(at.name.size()));
            } else if (written) {
                check_samples_on_steps(s, *stream, at, diagnostics);
            }
        }
    }
}

/// Two that act for one element would undo each other's work.
void refuse_second(Scenario const& s, Process const& process, ElementUse const& use, Ref const& element,
                   program::Declaration const& declaration, Diagnostics& diagnostics) {
    for (Process const& other : s.processes) {
        if (other.name.name == process.name.name) {
            return; // whoever comes first may
        }
        auto const* declared = dynamic_cast<DeclaredSettings const*>(other.settings.get());
        if (declared == nullptr || declared->declaration().name != declaration.name) {
            continue;
        }
        for (ElementUse const& theirs : declared->declaration().elements) {
            std::vector<Ref> const named = names_in(declared->declaration(), other, theirs.key);
            if (theirs.kind == use.kind && std::find(named.begin(), named.end(), element) != named.end()) {
                diagnostics.error(element.where,
                                  fmt::format("process '{}' {} the {} '{}', and '{}' does so already",
                                              process.name.name, use.does, title_of_kind(use.kind), element.name,
                                              other.name.name),
                                  "one of them is enough", static_cast<int>(element.name.size()));
                return;
            }
        }
    }
}

void check_elements(Scenario const& s, Process const& process, program::Declaration const& declaration,
                    Diagnostics& diagnostics) {
    for (ElementUse const& use : declaration.elements) {
        auto const names = element_names(*s.network, use.kind);
        if (!names) {
            diagnostics.error(process.name.where,
                              fmt::format("{} says that '{}' names a '{}', which is no kind of element",
                                          declaration.name, use.key, use.kind),
                              did_you_mean(use.kind, element_kinds()));
            continue;
        }
        for (Ref const& element : names_in(declaration, process, use.key)) {
            if (!use.does.empty()) {
                refuse_second(s, process, use, element, declaration, diagnostics);
            }
            if (std::find(names->begin(), names->end(), element.name) == names->end()) {
                diagnostics.error(element.where,
                                  fmt::format("process '{}' {} the {} '{}', which does not exist", process.name.name,
                                              use.does.empty() ? "names" : use.does, title_of_kind(use.kind),
                                              element.name),
                                  spelling_hint(element.name, *names), static_cast<int>(element.name.size()));
            }
        }
    }
}

/// What a process leaves to the element that it names is written next to the name.
void complete(Node& target, Node const& around, ElementUse const& use, std::string const& element,
              sim::Network const& network) {
    for (ElementUse::Default const& d : use.defaults) {
        if (target.find(d.key) != nullptr || around.find(d.key) != nullptr) {
            continue;
        }
        if (auto const value = element_quantity(network, use.kind, element, d.quantity)) {
            target.set(d.key, Node::scalar(*value));
        }
    }
}

} // namespace

Rational DeclaredSettings::latency_s(Process const& process) const {
    auto const written =
        declaration_.latency.empty() ? std::vector<Ref>{} : names_in(declaration_, process, declaration_.latency);
    auto const us = written.empty() ? std::nullopt : Rational::parse(written.front().name);
    return us.value_or(Rational{0}) / Rational{1'000'000};
}

void DeclaredSettings::check_whole_steps(Scenario const& s, Process const& process, Diagnostics& diagnostics) const {
    for (std::string const& key : declaration_.whole_steps) {
        Node const* written = process.node.find(key);
        auto const value = values_of(declaration_, process)(key);
        auto const span_s = value.empty() ? std::nullopt : Rational::parse(value.front());
        if (span_s && s.simulation.step_s > Rational{0} && !(*span_s / s.simulation.step_s).is_whole()) {
            diagnostics.error(written == nullptr ? process.name.where : written->where,
                              fmt::format("'{}' of {} s is not a whole number of steps of {} s", key,
                                          span_s->to_string(), s.simulation.step_s.to_string()));
        }
    }
}

void DeclaredSettings::check(Scenario const& s, Process const& process, Diagnostics& diagnostics) {
    check_whole_steps(s, process, diagnostics);
    check_files(process.node, declaration_.settings, diagnostics);
    if (s.network) {
        check_elements(s, process, declaration_, diagnostics);
    }
    if (names_streams(declaration_)) {
        check_streams(s, process, declaration_, diagnostics);
    }
}

std::vector<TopicUse> DeclaredSettings::writes(Scenario const&, Process const& process) const {
    std::vector<TopicUse> out = uses(declaration_.writes, declaration_, process, command_);
    if (!declaration_.signals.empty()) {
        add_signals(out);
    }
    if (!command_.empty() && names_streams(declaration_)) { // the library's; ours say it
        out.push_back({"stream_statistics", "StreamStatistics", 1, false, true});
    }
    return out;
}

std::vector<WireUse> DeclaredSettings::sends(Scenario const& s, Process const& process) const {
    return wire_uses(s, declaration_.writes, declaration_, process);
}

std::vector<WireUse> DeclaredSettings::receives(Scenario const& s, Process const& process) const {
    return wire_uses(s, declaration_.reads, declaration_, process);
}

std::vector<TopicUse> DeclaredSettings::reads(Scenario const&, Process const& process) const {
    return uses(declaration_.reads, declaration_, process, command_);
}

std::vector<SignalUse> DeclaredSettings::signals(Scenario const&, Process const& process) const {
    std::vector<SignalUse> out;
    for (program::Signal& signal : program::expand(declaration_.signals, values_of(declaration_, process))) {
        out.push_back({std::move(signal.name), std::move(signal.unit), signal.rate_hz});
    }
    return out;
}

Node DeclaredSettings::settings(Scenario const& s, Process const& process) const {
    Node node = own_settings(process);
    if (names_streams(declaration_)) {
        std::vector<std::string> used;
        for (auto const* topics : {&declaration_.reads, &declaration_.writes}) {
            for (streams::Stream const* stream : streams_in(s, *topics, declaration_, process)) {
                used.push_back(stream->name.name);
            }
        }
        node = wire_process_settings(s, process, used);
    }
    resolve_files(node, declaration_.settings);
    for (ElementUse const& use : declaration_.elements) {
        Node* named = node.find(use.key);
        if (!s.network || named == nullptr) {
            continue;
        }
        if (named->is_scalar()) {
            std::string const element = named->text;
            complete(node, node, use, element, *s.network);
        } else if (named->is_map()) {
            Node const around = node;
            for (Node::Entry& entry : node.find(use.key)->entries) {
                if (!entry.value.is_map()) {
                    entry.value = Node::map(entry.value.where);
                }
                complete(entry.value, around, use, entry.key, *s.network);
            }
        }
    }
    return node;
}

} // namespace gridspace::launcher
