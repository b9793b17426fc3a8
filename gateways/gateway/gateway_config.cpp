// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/gateway_config.hpp"

#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

using config::Fields;
using config::Node;

void describe_end(Fields& f, MappingEnd& end, bool source) {
    f.reference("topic", end.topic, {.doc = "DDS topic"});
    f.reference("type", end.type, {.doc = "type of the topic, from an IDL file of the build"});
    f.reference("stream", end.stream, {.doc = "stream of `streams:`"});
    if (source) {
        describe_where(f, end);
    }
    if (end.topic.empty() == end.stream.empty()) {
        f.error("", end.topic.empty() ? "a mapping needs a topic or a stream here" : "a topic and a stream at once",
                "{topic: NAME, type: TYPE} or {stream: NAME}");
    } else if (end.is_topic() && end.type.empty()) {
        f.error("", fmt::format("the type of topic '{}' is missing", end.topic.name), "{topic: NAME, type: TYPE}");
    } else if (!end.is_topic() && (!end.type.empty() || !end.where.empty())) {
        f.error("", fmt::format("stream '{}' has neither a type nor a filter", end.stream.name),
                "its data set is in `streams:`");
    }
}

/// One entry of `fields:`: the name of a source field, or a map.
void describe_rule(Fields& r, FieldRule& rule) {
    Node value, on_loss;
    r.reference("from", rule.from, {.doc = "field of the source"});
    r.raw("value", value, {.doc = "a constant instead"});
    r.raw("on_loss", on_loss, {.doc = "what it becomes when the source is lost; held when not given"});
    r.number("scale", rule.scale, {.doc = "factor, after the units have been converted"});
    r.number("offset", rule.offset, {.doc = "added then"});
    r.text("from_unit", rule.from_unit, {.doc = "unit of the source field, where its name does not say it"});
    r.text("to_unit", rule.to_unit, {.doc = "unit of the target field, where its name does not say it"});
    r.flag("invert", rule.invert, {.doc = "of a Boolean"});
    r.choice<bool>("true_means", rule.true_is_open, {{"open", true}, {"closed", false}},
                   {.doc = "Boolean to or from a position"});
    auto const scalar = [&](std::string_view key, Node const& node, std::optional<std::string>& out,
                            config::SourceMark& at) {
        if (node.is_scalar()) {
            out = node.text;
            at = node.where;
        } else if (!node.is_null()) {
            r.error(key, fmt::format("`{}` is {}", key, config::describe(node)), "expected one value");
        }
    };
    scalar("value", value, rule.value, rule.value_at);
    scalar("on_loss", on_loss, rule.on_loss, rule.on_loss_at);
    if (rule.from.empty() == !rule.value.has_value()) {
        r.error("", rule.value ? "`from` and `value` at once" : "neither `from` nor `value`",
                "a field of the source, or a constant");
    }
}

void describe_mapping(Fields& f, MappingConfig& m) {
    using WriteOn = MappingConfig::WriteOn;
    using Start = MappingConfig::Start;
    using Sending = MappingConfig::Sending;
    f.object("from", {.doc = "where values come from; without it all fields are constants"},
             [&](Fields& e) { describe_end(e, m.from, true); });
    f.object("to", {.doc = "where they go", .required = true}, [&](Fields& e) { describe_end(e, m.to, false); });
    f.raw("fields", m.fields,
          {.doc = "target field: source field, or {from, value, scale, offset, from_unit, to_unit, invert, true_means, "
                  "on_loss}",
           .required = true});
    if (!m.fields.is_null() && (!m.fields.is_map() || m.fields.entries.empty())) {
        f.error("fields", fmt::format("the fields are {}", config::describe(m.fields)),
                "expected `target: source` for each field");
    }
    f.list("changes", {.doc = "without `from`: what constants become, in the order of time"}, [&](Fields& c) {
        MappingConfig::Change change;
        c.fraction("at_s", change.at_s, {.doc = "simulated time", .required = true, .min = 0});
        c.raw("set", change.set, {.doc = "fields of the target and their new values", .required = true});
        if (!m.changes.empty() && change.at_s < m.changes.back().at_s) {
            c.error("at_s", "it is earlier than the change before", "changes stand in the order of time");
        }
        m.changes.push_back(std::move(change));
    });
    if (m.has_source() && !m.changes.empty()) {
        f.error("changes", "this mapping has a source, whose values it sends", "leave `from` or `changes` out");
    } else if (!m.has_source()) {
        m.start = MappingConfig::Start::at_once;
    }
    f.reference("each", m.each, {.doc = "sequence of the topic's type whose elements are consecutive samples"});
    f.reference(
        "index", m.index,
        {.doc = "field of the topic's type with the index of its (first) sample; without it a sampled-value stream "
                "sends the newest value at its own rate"});
    f.choice<WriteOn>("write_on", m.write_on, {{"change", WriteOn::change}, {"message", WriteOn::message}},
                      {.doc = "GOOSE to a topic: a sample when a value changes, or for every message"});
    f.integer("every", m.every, {.doc = "sampled values to a topic: one sample in so many", .min = 1, .max = 65536});
    f.integer("per_message", m.per_message,
              {.doc = "with `each`, to a topic: so many samples in a message", .min = 1, .max = 4096});
    f.flag("accept_test", m.accept_test, {.doc = "take frames that are marked as simulated, instead of real ones"});
    describe(f, m.first_line);
    if (m.from.is_topic() && f.has("first_line")) {
        f.error("first_line", "the rules are for frames, and this mapping's source is a topic",
                "leave `first_line` out");
    }
    f.number("lost_after_ms", m.lost_after_ms,
             {.doc = "the topic is lost when it was silent for so long; 0: never", .min = 0});
    f.choice<Start>("start", m.start, {{"first_sample", Start::first_sample}, {"at_once", Start::at_once}},
                    {.doc = "a stream is sent from the first sample on (the default with `from`), or at once with "
                            "constants and zeros (the default without)"});
    f.choice<Sending>(
        "sending", m.sending, {{"scheduled", Sending::scheduled}, {"on_arrival", Sending::on_arrival}},
        {.doc = "real time, with `index`: at the exact sample rate behind a small buffer, or as soon as samples come"});
    f.number("buffer_ms", m.buffer_ms,
             {.doc = "real time, scheduled: how much later than the samples it sends", .min = 0, .max = 100});
    f.references("watch", m.watch,
                 {.doc = "fields of the target that are published as signals, mapping.PROCESS.NAME.FIELD"});
}

} // namespace

mapping::Rule rule_of(FieldRule const& field) {
    mapping::Rule rule;
    rule.from = field.from.name;
    rule.to = field.to.name;
    rule.scale = field.scale;
    rule.offset = field.offset;
    rule.from_unit = field.from_unit;
    rule.to_unit = field.to_unit;
    rule.invert = field.invert;
    rule.true_is_open = field.true_is_open;
    return rule;
}

void describe(config::Fields& f, GatewayConfig& config) {
    f.map("mappings", {.doc = "what is translated into what"}, [&](Ref const& name, Fields& m) {
        MappingConfig mapping;
        mapping.name = name;
        describe_mapping(m, mapping);
        config.mappings.push_back(std::move(mapping));
    });
    describe(f, config.subscriptions);
    ptp::describe_ptp(f, config.ptp);
    f.fraction("latency_us", config.latency_us, {.doc = "lockstep: from input to output", .min = 0});
}

/// Texts by field name: `where: {bus: B3}`.
void describe_where(Fields& f, MappingEnd& end) {
    Node node;
    f.raw("where", node, {.doc = "only samples whose field has this value: {bus: B3}"});
    if (node.is_null()) {
        return;
    }
    if (!node.is_map()) {
        f.error("where", fmt::format("`where` is {}", config::describe(node)),
                "expected fields and their values, like {bus: B3}");
        return;
    }
    for (Node::Entry const& entry : node.entries) {
        if (!entry.value.is_scalar()) {
            f.error("where", fmt::format("the value of '{}' is {}", entry.key, config::describe(entry.value)),
                    "expected one value");
            continue;
        }
        end.where.emplace_back(Ref{entry.key, entry.where}, entry.value.text);
    }
}

std::string field_path(std::string_view written) {
    std::string out;
    for (char const c : written) {
        if (c != ']') {
            out += c == '[' ? '.' : c;
        }
    }
    return out;
}

std::vector<FieldRule> read_rules(config::Node const& fields, config::Diagnostics& diagnostics) {
    std::vector<FieldRule> out;
    for (Node::Entry const& entry : fields.entries) {
        FieldRule rule;
        rule.to = {entry.key, entry.where};
        if (entry.value.is_scalar()) {
            rule.from = {entry.value.text, entry.value.where};
        } else if (entry.value.is_map()) {
            int const errors = diagnostics.errors();
            config::read_fields(entry.value, entry.key, diagnostics, [&](Fields& r) { describe_rule(r, rule); });
            if (diagnostics.errors() > errors) {
                continue;
            }
        } else {
            diagnostics.error(entry.where, fmt::format("field '{}' is {}", entry.key, config::describe(entry.value)),
                              "a field of the source, or a map like {from: ..., scale: ...}",
                              static_cast<int>(entry.key.size()));
            continue;
        }
        rule.to.name = field_path(rule.to.name);
        rule.from.name = field_path(rule.from.name);
        out.push_back(std::move(rule));
    }
    return out;
}

} // namespace gridspace::gateways
