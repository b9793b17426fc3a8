// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <charconv>
#include <map>
#include <optional>
#include <string>
#include <string_view>

namespace gridspace {

/// Besides a setting's name and default; docs/reference/program_description.md says what each is.
struct SettingOptions {
    std::string doc{};
    std::optional<double> min{}, max{}, above{}, below{};
    std::string kind{}; ///< "name", "file", … where the type of C++ does not say it
    std::optional<bool> required{};
    std::string element{}, does{};                 ///< the kind of element that it names, and what one process may do
    std::map<std::string, std::string> defaults{}; ///< settings that are taken from the element, by its quantity
    bool whole_steps{false}, latency{false};
};

struct TopicOptions {
    bool triggers{false}, optional{false};
    std::string idl{};  ///< file that defines the type when it is not one of Gridspace's
    bool stream{false}; ///< no topic but a stream of the scenario: docs/reference/c_abi.md says what its struct is
    std::map<std::string, std::string> only{}; ///< of what is read: texts in it, {{"bus", "{bus}"}}; others do not come
};

/// Gathers what a program says of itself, as JSON.
class Description {
  public:
    Description(std::string name, std::string text, std::string role)
        : head_{R"({"gridspace_program":1,"daemon":true,"name":)" + quoted(name) + R"(,"description":)" + quoted(text) +
                R"(,"role":)" + quoted(role)} {}

    void setting(std::string const& key, std::string const& kind, std::string const& otherwise,
                 SettingOptions const& o) {
        std::string one = R"({"key":)" + quoted(key) + R"(,"kind":)" + quoted(o.kind.empty() ? kind : o.kind) +
                          R"(,"doc":)" + quoted(o.doc);
        if (o.required.value_or(otherwise.empty())) {
            one += R"(,"required":true)";
        }
        if (!otherwise.empty()) {
            one += R"(,"default":)" + quoted(otherwise);
        }
        bound(one, "min", o.min);
        bound(one, "max", o.max);
        bound(one, "above", o.above);
        bound(one, "below", o.below);
        append(settings_, one + "}");
        if (!o.element.empty()) {
            std::string defaults;
            for (auto const& [to, quantity] : o.defaults) {
                append(defaults, R"({"key":)" + quoted(to) + R"(,"quantity":)" + quoted(quantity) + "}");
            }
            append(elements_, R"({"key":)" + quoted(key) + R"(,"kind":)" + quoted(o.element) + R"(,"does":)" +
                                  quoted(o.does) + R"(,"defaults":[)" + defaults + "]}");
        }
        if (o.whole_steps) {
            append(whole_steps_, quoted(key));
        }
        if (o.latency) {
            head_ += R"(,"latency":)" + quoted(key);
        }
    }
    void reads(std::string const& topic, std::string const& type, TopicOptions const& o) {
        append(reads_, topic_text(topic, type, o) + (o.triggers && !o.stream ? R"(,"triggers":true})" : "}"));
    }
    void writes(std::string const& topic, std::string const& type, TopicOptions const& o) {
        append(writes_, topic_text(topic, type, o) + "}");
    }
    void signal(std::string const& name, std::string const& unit) {
        append(signals_, R"({"name":)" + quoted(name) + R"(,"unit":)" + quoted(unit) + "}");
    }
    [[nodiscard]] std::string json() const {
        return head_ + R"(,"settings":[)" + settings_ + R"(],"elements":[)" + elements_ + R"(],"whole_steps":[)" +
               whole_steps_ + R"(],"reads":[)" + reads_ + R"(],"writes":[)" + writes_ + R"(],"signals":[)" + signals_ +
               "]}";
    }

  private:
    static std::string quoted(std::string_view text) {
        std::string out = "\"";
        for (char const c : text) {
            if (c == '"' || c == '\\') {
                out += '\\';
            }
            out += static_cast<unsigned char>(c) < 0x20 ? ' ' : c;
        }
        return out + '"';
    }
    static void append(std::string& list, std::string const& item) { list += (list.empty() ? "" : ",") + item; }
    static void bound(std::string& out, char const* name, std::optional<double> value) {
        if (value) {
            char text[32];
            out += std::string{",\""} + name + "\":" + std::string{text, std::to_chars(text, text + 32, *value).ptr};
        }
    }
    static std::string topic_text(std::string const& topic, std::string const& type, TopicOptions const& o) {
        if (o.stream) {
            return R"({"stream":)" + quoted(topic);
        }
        std::string only;
        for (auto const& [member, is] : o.only) {
            append(only, quoted(member) + ":" + quoted(is));
        }
        return R"({"topic":)" + quoted(topic) + R"(,"type":)" + quoted(type) +
               (o.optional ? R"(,"optional":true)" : "") + (o.idl.empty() ? "" : R"(,"idl":)" + quoted(o.idl)) +
               (only.empty() ? "" : R"(,"only":{)" + only + "}");
    }
    std::string head_, settings_, elements_, whole_steps_, reads_, writes_, signals_;
};

} // namespace gridspace
