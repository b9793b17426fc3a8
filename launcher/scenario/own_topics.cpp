// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/own_topics.hpp"

#include "bus/topics.hpp"
#include "common/idl/idl_model.hpp"
#include "common/text.hpp"
#include "idl/idl_texts.hpp"
#include "launcher/scenario/declared_program.hpp"
#include "launcher/scenario/program.hpp"
#include "launcher/scenario/scenario.hpp"
#include "launcher/scenario/wire_use.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Node;

/// Written by every process or by the simulator, without anybody saying so.
constexpr std::array<std::string_view, 4> kFramework{"simulation_clock", "clock_ack", "member_status", "type_catalog"};

bool is_own_program(Process const& process) {
    return process.is_foreign();
}

void add_structs(idl::Model const& model, std::vector<std::string>& names) {
    for (idl::Type const& type : model.types) {
        if (type.kind == idl::Kind::structure) {
            names.push_back(type.name);
        }
    }
}

std::vector<std::string> known_types() {
    std::vector<std::string> names;
    for (IdlText const& entry : idl_texts()) {
        if (auto const model = idl::parse(entry.text)) {
            add_structs(*model, names);
        }
    }
    return names;
}

/// Where a key of a topic stands: `writes: {mytopic: {type: MyType}}`.
config::SourceMark place(Process const& process, char const* list, std::string const& topic, char const* key) {
    config::SourceMark where = process.name.where;
    Node const* node = &process.node;
    for (std::string_view const step : {std::string_view{list}, std::string_view{topic}, std::string_view{key}}) {
        node = node == nullptr ? nullptr : node->find(step);
        where = node == nullptr ? where : node->where;
    }
    return where;
}

struct Named {
    std::string process, text;
    std::filesystem::path file;
};

/// The types of all processes' topics, one use after the other.
class TypeCheck {
  public:
    TypeCheck(Scenario const& scenario, Diagnostics& diagnostics)
        : own_{own_types(scenario)}, diagnostics_{diagnostics} {}

    void operator()(Process const& process, char const* list, TopicUse const& use) {
        if (use.type.empty()) {
            return; // said elsewhere
        }
        if (!use.idl.empty()) {
            check_file(process, list, use);
        } else if (bus::idl_of_type(use.type).empty() && !own_.contains(use.type)) {
            diagnostics_.error(place(process, list, use.topic, "type"),
                               fmt::format("process '{}' {} '{}' as '{}', and no IDL defines that type",
                                           process.name.name, list, use.topic, use.type),
                               did_you_mean(use.type, known_types(), "`idl: FILE` beside it names the file that does"),
                               static_cast<int>(use.type.size()));
        }
    }

  private:
    void check_file(Process const& process, char const* list, TopicUse const& use) {
        auto const refuse = [&](std::string const& message, std::string const& remedy) {
            diagnostics_.error(place(process, list, use.topic, "idl"), message, remedy);
        };
        std::error_code ignored;
        std::ifstream stream;
        if (std::filesystem::is_regular_file(use.idl, ignored)) {
            stream.open(use.idl);
        }
        if (!stream.is_open()) {
            return refuse(fmt::format("cannot read '{}'", use.idl.string()),
                          "`idl` is the IDL file that defines the type, relative to the file that names it");
        }
        std::string const text{std::istreambuf_iterator<char>{stream}, {}};
        auto const model = idl::parse(text);
        if (!model) {
            return refuse(fmt::format("'{}': {}", use.idl.string(), model.error().message), model.error().remedy);
        }
        std::vector<std::string> names;
        add_structs(*model, names);
        if (std::find(names.begin(), names.end(), use.type) == names.end()) {
            return refuse(fmt::format("'{}' does not define '{}'", use.idl.string(), use.type),
                          spelling_hint(use.type, names, "it defines no struct"));
        }
        if (auto const known = bus::idl_of_type(use.type); !known.empty() && known != text) {
            return refuse(
                fmt::format("'{}' is a type of Gridspace, and '{}' is another text", use.type, use.idl.string()),
                "leave `idl` out, or give your type a name of its own");
        }
        auto const [it, first] = named_.try_emplace(use.type, Named{process.name.name, text, use.idl});
        if (!first && it->second.text != text) {
            refuse(fmt::format("'{}' of '{}' and '{}' of '{}' both define '{}', and are not the same", use.idl.string(),
                               process.name.name, it->second.file.string(), it->second.process, use.type),
                   "all who use a type must mean the same by it: one file for both");
        }
    }

    std::map<std::string, std::filesystem::path> own_;
    std::map<std::string, Named> named_; ///< the first of each type
    Diagnostics& diagnostics_;
};

} // namespace

std::map<std::string, std::filesystem::path> own_types(Scenario const& scenario) {
    std::map<std::string, std::filesystem::path> out;
    for (Process const& process : scenario.processes) {
        if (process.settings == nullptr || !is_own_program(process)) {
            continue;
        }
        for (auto const& uses :
             {process.settings->writes(scenario, process), process.settings->reads(scenario, process)}) {
            for (TopicUse const& use : uses) {
                if (!use.idl.empty()) {
                    out.try_emplace(use.type, std::filesystem::absolute(use.idl).lexically_normal());
                }
            }
        }
    }
    return out;
}

void check_own_topics(Scenario const& scenario, Diagnostics& diagnostics) {
    TypeCheck check_type{scenario, diagnostics};
    for (Process const& process : scenario.processes) {
        if (process.settings == nullptr) {
            continue;
        }
        std::vector<TopicUse> const writes = process.settings->writes(scenario, process);
        // The library counts the streams of a program that describes itself.
        bool const counts_streams =
            dynamic_cast<DeclaredSettings const*>(process.settings.get()) != nullptr &&
            (!frames_sent(scenario, process).empty() || !frames_received(scenario, process).empty());
        for (TopicUse const& use : writes) {
            if (std::find(kFramework.begin(), kFramework.end(), use.topic) != kFramework.end() ||
                (use.topic == "stream_statistics" && is_own_program(process) && !counts_streams)) {
                diagnostics.error(
                    place(process, "writes", use.topic, "type"),
                    fmt::format("process '{}' writes '{}', a topic of the framework", process.name.name, use.topic),
                    "another name; what a member says to the clock is not listed here");
            }
        }
        if (is_own_program(process)) {
            for (TopicUse const& use : writes) {
                check_type(process, "writes", use);
            }
            for (TopicUse const& use : process.settings->reads(scenario, process)) {
                check_type(process, "reads", use);
            }
        }
    }
}

} // namespace gridspace::launcher
