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

void describe_topic(Fields& f, SecuritySettings::Topic& topic) {
    protection(f, "submessages", topic.submessages,
               "samples with their numbers and acknowledgements, with a key of writer and readers: none, sign or "
               "encrypt");
    protection(f, "data", topic.data, "samples alone, once more: none, sign or encrypt");
}

} // namespace

std::string_view to_string(Protection protection) {
    return protection == Protection::none ? "none" : protection == Protection::sign ? "sign" : "encrypt";
}

void describe(Fields& f, SecuritySettings& security) {
    f.file("keys", security.keys,
           {.doc = "folder of `gridspace keys init`; when left out, keys are made for this run alone"});
    protection(f, "messages", security.messages,
               "each message of the bus as a whole, with a key of its sender: none, sign or encrypt");
    describe_topic(f, security.all);
    f.map("topics", {.doc = "single topics, in the place of `submessages` and `data`"},
          [&](config::Ref const& topic, Fields& t) {
              SecuritySettings::Topic own = security.all;
              describe_topic(t, own);
              if (own.submessages == Protection::none && security.messages == Protection::none) {
                  t.error("submessages", fmt::format("nothing would protect the topic '{}'", topic.name),
                          "anybody could say it; protect its submessages, or `messages` as a whole");
              }
              security.topics[topic.name] = own;
              security.named.push_back(topic);
          });
    if (security.all.submessages == Protection::none && security.messages == Protection::none) {
        f.error("submessages", "nothing would be protected", "protect submessages, or `messages` as a whole");
    }
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
    for (attacker::AttackConfig const& attack : scenario.attacks) {
        if (!attack.topic.empty()) {
            diagnostics.warning(
                attack.name.where,
                fmt::format("attack '{}' is on the topic '{}': its process is given the right to it", attack.name.name,
                            attack.topic.name),
                "an insider's attack, which `security:` does not stop; a stranger's does not come so far",
                static_cast<int>(attack.name.name.size()));
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
