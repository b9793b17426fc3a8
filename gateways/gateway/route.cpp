// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/gateway/route.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/quality.hpp"
#include "gateways/mapping/constant.hpp"
#include "gateways/port/wire_config.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace gridspace::gateways {
namespace {

using config::Diagnostics;
using iec61850::BasicType;
using mapping::Field;

/// In the order of StreamField.
std::vector<Field> stream_fields(streams::Kind kind) {
    std::vector<Field> out{{"$alive", BasicType::boolean, 0, {}},   {"$simulated", BasicType::boolean, 0, {}},
                           {"$smp_cnt", BasicType::uint16, 0, {}},  {"$index", BasicType::int64, 0, {}},
                           {"$smp_synch", BasicType::uint8, 0, {}}, {"$st_num", BasicType::uint32, 0, {}},
                           {"$sq_num", BasicType::uint32, 0, {}},   {"$t", BasicType::timestamp, 0, {}}};
    if (kind == streams::Kind::smv) { // what the other kind has cannot be asked for
        out[5].name = out[6].name = out[7].name = "";
    } else {
        out[2].name = out[3].name = out[4].name = "";
    }
    return out;
}

std::string near(std::vector<Field> const& fields, std::string_view name) {
    std::vector<std::string> names;
    for (Field const& field : fields) {
        if (!field.name.empty()) {
            names.push_back(field.name);
        }
    }
    return spelling_hint(name, names);
}

class RouteMaker {
  public:
    RouteMaker(MappingConfig const& config, std::vector<streams::Stream> const& streams, FindIdl const& find_idl,
               Diagnostics& diagnostics)
        : config_{config}, streams_{streams}, find_idl_{find_idl}, diagnostics_{diagnostics} {
        route_.config = config;
    }

    Route run() {
        if (!config_.has_source() && config_.to.is_topic()) {
            error(config_.name, fmt::format("mapping '{}' has no `from`, and goes to a topic", config_.name.name),
                  "constants alone go to a stream");
            return std::move(route_);
        }
        if (config_.has_source() && config_.from.is_topic() == config_.to.is_topic()) {
            error(config_.name,
                  fmt::format("mapping '{}' goes from a {} to a {}", config_.name.name,
                              config_.from.is_topic() ? "topic" : "stream", config_.to.is_topic() ? "topic" : "stream"),
                  "one side is a topic, the other a stream");
            return std::move(route_);
        }
        bool const from =
            !config_.has_source() || side(config_.from, route_.from_stream, route_.from_type, route_.from, true);
        bool const to = side(config_.to, route_.to_stream, route_.to_type, route_.to, false);
        if (!from || !to) {
            return std::move(route_);
        }
        route_.fields = read_rules(config_.fields, diagnostics_);
        find_own_fields();
        check_options();
        compile();
        for (MappingConfig::Change const& change : route_.config.changes) {
            add_change(change);
        }
        for (auto const& [field, text] : route_.config.from.where) {
            add_filter(field, text);
        }
        for (Ref const& watched : config_.watch) {
            if (auto const at = index_of(route_.to, watched)) {
                if (!iec61850::is_number(route_.to[*at].type) && route_.to[*at].type != BasicType::boolean &&
                    route_.to[*at].type != BasicType::position) {
                    error(watched, fmt::format("'{}' is {}: a signal is a number", watched.name,
                                               type_name(route_.to[*at].type)));
                }
                route_.watched.push_back(*at);
            }
        }
        return std::move(route_);
    }

  private:
    void error(Ref const& at, std::string message, std::string hint = {}) {
        diagnostics_.error(at.where, std::move(message), std::move(hint), static_cast<int>(at.name.size()));
    }

    std::optional<std::size_t> index_of(std::vector<Field> const& fields, Ref const& ref) {
        auto const found = std::find_if(fields.begin(), fields.end(),
                                        [&](Field const& f) { return !f.name.empty() && f.name == ref.name; });
        if (found != fields.end()) {
            return static_cast<std::size_t>(found - fields.begin());
        }
        error(ref, fmt::format("there is no field '{}'", ref.name), near(fields, ref.name));
        return std::nullopt;
    }

    bool side(MappingEnd const& end, streams::Stream const*& stream, std::shared_ptr<mapping::RecordType const>& type,
              std::vector<Field>& fields, bool source) {
        if (!end.is_topic()) {
            stream = streams::find_stream(streams_, end.stream.name);
            if (stream == nullptr) {
                std::vector<std::string> names;
                for (streams::Stream const& s : streams_) {
                    names.push_back(s.name.name);
                }
                error(end.stream, fmt::format("there is no stream '{}'", end.stream.name),
                      spelling_hint(end.stream.name, names, "`streams:` declares none"));
                return false;
            }
            if (stream->broken) {
                stream = nullptr;
                return false;
            }
            fields = mapping::fields_of(stream->data_set);
            for (Field& field : fields) {
                if (field.type == BasicType::quality && stream->kind == streams::Kind::goose) {
                    field.length = iec61850::quality::kBits;
                }
            }
            if (source) {
                route_.stream_fields = fields.size();
                auto const own = stream_fields(stream->kind);
                fields.insert(fields.end(), own.begin(), own.end());
            }
            return true;
        }
        auto found = topic_fields(end.type, config_.each, find_idl_, diagnostics_);
        if (!found) {
            return false;
        }
        type = std::move(found->type);
        fields = std::move(found->fields);
        return true;
    }

    /// The field of the topic that holds the index of a sample, and the stamp that is the gateway's to write.
    void find_own_fields() {
        if (!config_.has_source()) {
            if (!config_.index.empty() || !config_.each.empty()) {
                error(config_.name, fmt::format("mapping '{}' has no source with samples", config_.name.name),
                      "leave `each` and `index` out");
            }
            return;
        }
        bool const to_topic = route_.to_type != nullptr;
        std::vector<Field> const& fields = to_topic ? route_.to : route_.from;
        mapping::RecordType const& type = to_topic ? *route_.to_type : *route_.from_type;
        if (!config_.index.empty()) {
            route_.index_field = index_of(fields, config_.index);
            if (route_.index_field &&
                (!iec61850::is_integer(fields[*route_.index_field].type) || type.is_each_field(*route_.index_field))) {
                error(config_.index, fmt::format("'{}' cannot hold an index", config_.index.name),
                      "a whole number outside of the sequence");
            }
        }
        if (auto const stamp = type.index_of("time_ns"); to_topic && stamp && fields[*stamp].type == BasicType::int64) {
            route_.time_field = stamp;
        }
    }

    void check_options() {
        bool const to_topic = config_.to.is_topic();
        streams::Stream const& stream = to_topic ? *route_.from_stream : *route_.to_stream;
        bool const samples = stream.kind == streams::Kind::smv;
        auto const needs = [&](bool given, bool possible, std::string_view key, std::string_view where) {
            if (given && !possible) {
                error(config_.name,
                      fmt::format("mapping '{}' has `{}`, which is for {}", config_.name.name, key, where));
            }
        };
        needs(!config_.each.empty(), samples, "each", "sampled values");
        needs(!config_.index.empty(), samples, "index", "sampled values");
        needs(config_.every != 1, samples && to_topic, "every", "sampled values to a topic");
        needs(config_.per_message != 1, !config_.each.empty() && to_topic, "per_message", "a topic with `each`");
        needs(config_.write_on != MappingConfig::WriteOn::change, !samples && to_topic, "write_on", "GOOSE to a topic");
        needs(config_.accept_test, to_topic, "accept_test", "a stream as the source");
        needs(config_.lost_after_ms != 0, !to_topic && !route_.index_field, "lost_after_ms",
              "a topic whose values are held");
        needs(config_.start != MappingConfig::Start::first_sample, !to_topic && !route_.index_field, "start",
              "a stream whose values are held");
        if (!config_.each.empty() && !to_topic && config_.index.empty()) {
            error(config_.each, "samples of a sequence need their place in time",
                  "index: the field with the index of the first sample");
        }
        if (to_topic && !config_.each.empty() && route_.to_type->each_bound() != 0 &&
            config_.per_message > route_.to_type->each_bound()) {
            error(config_.each, fmt::format("per_message is {}, and '{}' holds at most {}", config_.per_message,
                                            config_.each.name, route_.to_type->each_bound()));
        }
        if (config_.every != 1 && !config_.each.empty()) {
            error(config_.each, "`every` leaves samples out, and those of a sequence are consecutive");
        }
    }

    void compile() {
        std::vector<mapping::Rule> rules, lost;
        std::vector<std::size_t> origins; // of a rule: its place in the configuration
        for (std::size_t i = 0; i < route_.fields.size(); ++i) {
            if (add_rule(route_.fields[i], rules, lost)) {
                origins.push_back(i);
            }
        }
        compile_rules(rules, origins);
        std::vector<mapping::Mistake> none; // constants of the right type for fields that exist
        std::vector<mapping::Rule> constants;
        std::copy_if(rules.begin(), rules.end(), std::back_inserter(constants),
                     [](mapping::Rule const& r) { return r.constant.has_value(); });
        route_.constants = mapping::Mapping::compile(constants, {}, route_.to, none);
        route_.on_loss = mapping::Mapping::compile(lost, {}, route_.to, none);
        route_.acts_on_loss = !lost.empty() || std::any_of(rules.begin(), rules.end(),
                                                           [](mapping::Rule const& r) { return r.from == "$alive"; });
        find_invalid();
        for (auto const& own : {route_.time_field, config_.to.is_topic() ? route_.index_field : std::nullopt}) {
            if (own) {
                route_.written.push_back(*own);
            }
        }
    }

    /// False when there is no rule, of which everything was said.
    bool add_rule(FieldRule const& field, std::vector<mapping::Rule>& rules, std::vector<mapping::Rule>& lost) {
        mapping::Rule rule = rule_of(field);
        auto const target = index_of(route_.to, field.to);
        if (!target) {
            return false;
        }
        if (target == route_.time_field || (config_.to.is_topic() && target == route_.index_field)) {
            error(field.to, fmt::format("'{}' is written by the gateway itself", field.to.name));
            return false;
        }
        if (field.value) {
            rule.constant = constant(*field.value, *target, field.value_at);
            if (!rule.constant) {
                return false;
            }
        }
        if (field.on_loss) {
            mapping::Rule loss;
            loss.to = rule.to;
            loss.constant = constant(*field.on_loss, *target, field.on_loss_at);
            if (!loss.constant) {
                return false;
            }
            lost.push_back(std::move(loss));
        }
        if (!field.value && config_.to.is_topic() && !config_.each.empty() &&
            route_.to[*target].type == BasicType::visible_string) {
            error(field.to, fmt::format("'{}' is a text beside samples that are gathered", field.to.name),
                  "only a constant can be written there");
        }
        rules.push_back(std::move(rule));
        route_.written.push_back(*target);
        return true;
    }

    void compile_rules(std::vector<mapping::Rule> const& rules, std::vector<std::size_t> const& origins) {
        std::vector<mapping::Mistake> mistakes;
        route_.rules = mapping::Mapping::compile(rules, route_.from, route_.to, mistakes);
        for (mapping::Mistake& mistake : mistakes) {
            FieldRule const& field = route_.fields[origins[mistake.rule]];
            Ref const& at = mistake.about_to || field.from.empty() ? field.to : field.from;
            bool const unknown = mistake.message.starts_with("there is no field");
            error(at, std::move(mistake.message),
                  unknown ? near(mistake.about_to ? route_.to : route_.from, at.name) : std::move(mistake.hint));
        }
    }

    /// A channel that nobody writes is not a good zero: 9-2LE has eight of them, and three may be measured.
    void find_invalid() {
        auto const is_written = [&](std::size_t field) {
            return std::find(route_.written.begin(), route_.written.end(), field) != route_.written.end();
        };
        for (std::size_t i = 1; route_.to_samples() && i < route_.to.size(); ++i) {
            if (route_.to[i].type == mapping::BasicType::quality &&
                route_.to[i - 1].type != mapping::BasicType::quality && !is_written(i) && !is_written(i - 1)) {
                route_.invalid.push_back(i);
            }
        }
    }

    std::optional<mapping::Value> constant(std::string const& text, std::size_t target, config::SourceMark const& at) {
        bool const of_topic = route_.to_type != nullptr;
        mapping::Enumerators const names =
            of_topic ? mapping::Enumerators{route_.to_type->enumerators(target)} : mapping::Enumerators{};
        auto value = mapping::parse_constant(text, route_.to[target], names);
        if (!value) {
            diagnostics_.error(at,
                               fmt::format("'{}' is no value of '{}', which is {}", text, route_.to[target].name,
                                           type_name(route_.to[target].type)),
                               mapping::expected_constant(route_.to[target], names), static_cast<int>(text.size()));
        }
        return value;
    }

    void add_change(MappingConfig::Change const& change) {
        Route::Change out{change.at_s, {}};
        for (config::Node::Entry const& entry : change.set.entries) {
            Ref const field{field_path(entry.key), entry.where};
            auto const at = index_of(route_.to, field);
            if (!at || !entry.value.is_scalar()) {
                if (at) {
                    error(field, fmt::format("the value of '{}' is {}", field.name, config::describe(entry.value)),
                          "expected one value");
                }
                continue;
            }
            if (std::find(route_.written.begin(), route_.written.end(), *at) == route_.written.end()) {
                error(field, fmt::format("'{}' changes, and is not among `fields`", field.name),
                      "its value before the change: {value: ...}");
            } else if (auto const value = constant(entry.value.text, *at, entry.value.where)) {
                out.values.emplace_back(*at, *value);
            }
        }
        if (change.set.entries.empty()) {
            error(config_.name, fmt::format("a change of mapping '{}' sets nothing", config_.name.name),
                  "set: {field: value}");
        }
        route_.changes.push_back(std::move(out));
    }

    void add_filter(Ref const& field, std::string const& text) {
        auto const at = index_of(route_.from, field);
        if (!at) {
            return;
        }
        auto const value = mapping::parse_constant(text, route_.from[*at], route_.from_type->enumerators(*at));
        if (!value || route_.from_type->is_each_field(*at)) {
            error(field, fmt::format("'{}' is no value of '{}' to choose samples by", text, field.name),
                  mapping::expected_constant(route_.from[*at], route_.from_type->enumerators(*at)));
            return;
        }
        route_.filters.push_back({*at, *value});
    }

    MappingConfig const& config_;
    std::vector<streams::Stream> const& streams_;
    FindIdl const& find_idl_;
    Diagnostics& diagnostics_;
    Route route_;
};

} // namespace

Route make_route(MappingConfig const& config, std::vector<streams::Stream> const& streams, FindIdl const& find_idl,
                 Diagnostics& diagnostics) {
    return RouteMaker{config, streams, find_idl, diagnostics}.run();
}

std::vector<Route> make_routes(GatewayConfig const& config, std::vector<streams::Stream> const& streams,
                               FindIdl const& find_idl, Diagnostics& diagnostics) {
    std::vector<Route> out;
    for (MappingConfig const& mapping : config.mappings) {
        out.push_back(make_route(mapping, streams, find_idl, diagnostics));
        for (MappingConfig const* other = config.mappings.data(); other != &mapping; ++other) {
            if (!mapping.to.stream.empty() && mapping.to.stream == other->to.stream) {
                diagnostics.error(mapping.to.stream.where,
                                  fmt::format("stream '{}' is sent by mapping '{}' already", mapping.to.stream.name,
                                              other->name.name),
                                  "one mapping for one stream", static_cast<int>(mapping.to.stream.name.size()));
            }
            if (mapping.to.is_topic() && mapping.to.topic == other->to.topic && !(mapping.to.type == other->to.type)) {
                diagnostics.error(mapping.to.type.where, fmt::format("topic '{}' has another type in mapping '{}'",
                                                                     mapping.to.topic.name, other->name.name));
            }
        }
    }
    check_subscriptions(config.subscriptions, streams, diagnostics);
    if (config.mappings.empty() && config.subscriptions.empty()) {
        diagnostics.error({}, "a gateway without mappings", "mappings: {NAME: {from: ..., to: ..., fields: ...}}");
    }
    return out;
}

} // namespace gridspace::gateways
