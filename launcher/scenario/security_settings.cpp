// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/scenario/security_settings.hpp"

#include "bus/topics.hpp"
#include "common/text.hpp"
#include "launcher/scenario/dataflow.hpp"
#include "launcher/scenario/run_on.hpp"
#include "launcher/scenario/scenario.hpp"

#include <fmt/format.h>

namespace gridspace::launcher {
namespace {

using config::Diagnostics;
using config::Fields;
using config::Node;

void protection(Fields& f, std::string_view key, Protection& value, std::string_view doc) {
    f.choice<Protection>(key, value,
                         {{"none", Protection::none}, {"sign", Protection::sign}, {"encrypt", Protection::encrypt}},
                         {.doc = doc});
}

} // namespace

std::string_view to_string(Protection protection) {
    return protection == Protection::none ? "none" : protection == Protection::sign ? "sign" : "encrypt";
}

void describe(Fields& f, SecuritySettings& security) {
    f.file("keys", security.keys,
           {.doc = "folder of `gridspace keys init`; when left out, keys are made for this run alone"});
    protection(f, "messages", security.messages, "every message of the bus, its headers too: none, sign or encrypt");
    protection(f, "data", security.data, "samples of topics that `topics` does not name: none, sign or encrypt");
    f.map("topics", {.doc = "samples of single topics"}, [&](config::Ref const& topic, Fields& t) {
        Protection data = security.data;
        protection(t, "data", data, "none, sign or encrypt");
        security.topics[topic.name] = data;
        security.named.push_back(topic);
    });
}

void expand_security_word(Node& root, Diagnostics& diagnostics) {
    Node* const security = root.find("security");
    if (security == nullptr || !security->is_scalar()) {
        return;
    }
    if (security->text == "on" || security->text == "true") {
        *security = Node::map(security->where);
    } else if (security->text == "off" || security->text == "false") {
        std::erase_if(root.entries, [](Node::Entry const& entry) { return entry.key == "security"; });
    } else {
        diagnostics.error(security->where, fmt::format("security is '{}'", security->text),
                          "on, off, or a map: {keys: FOLDER}", static_cast<int>(security->text.size()));
        *security = Node::map(security->where);
    }
}

void check_security(Scenario const& scenario, Diagnostics& diagnostics) {
    if (!scenario.security) {
        return;
    }
    for (Process const& process : scenario.processes) {
        if (parse_run_on(process.run_on).value_or(RunOn{}).kind != RunOn::Kind::native) {
            diagnostics.error(process.name.where,
                              fmt::format("process '{}' runs on '{}', and its keys would have to go there",
                                          process.name.name, process.run_on),
                              "with `security:` all processes run on this machine (`run_on: native`)",
                              static_cast<int>(process.name.name.size()));
        }
    }
    Dataflow const flow = dataflow(scenario);
    std::vector<std::string> known;
    for (auto const& [topic, writers] : flow.writers) {
        known.push_back(topic);
    }
    for (config::Ref const& topic : scenario.security->named) {
        if (!flow.writers.contains(topic.name) && !bus::is_management_topic(topic.name)) {
            diagnostics.error(topic.where, fmt::format("security: nobody writes the topic '{}'", topic.name),
                              spelling_hint(topic.name, known), static_cast<int>(topic.name.size()));
        }
    }
}

} // namespace gridspace::launcher
