// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "agents/fmu/fmu_table.hpp"

#include "agents/fmu/fmu_values.hpp"
#include "common/text.hpp"
#include "gateways/mapping/constant.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>

namespace gridspace::agents {
namespace {

using config::Diagnostics;
using config::Ref;
using fmi::Causality;
using fmi::Variability;
using gateways::FieldRule;
using mapping::Field;

std::optional<std::size_t> place_of(std::vector<Field> const& fields, std::string_view name) {
    auto const found =
        std::find_if(fields.begin(), fields.end(), [&](Field const& f) { return !f.name.empty() && f.name == name; });
    return found == fields.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - fields.begin())};
}

class TableMaker {
  public:
    TableMaker(FmuConfig const& config, fmi::ModelDescription const& description, std::string const& process,
               gateways::FindIdl const& find_idl, Diagnostics& diagnostics)
        : config_{config}, description_{description}, process_{process}, find_idl_{find_idl},
          diagnostics_{diagnostics} {}

    FmuTable run() {
        for (fmi::Variable const& variable : description_.variables) {
            out_.variables.push_back(field_of(variable).value_or(Field{}));
        }
        for (config::Node::Entry const& entry : config_.start.entries) {
            add_start(entry);
        }
        for (FmuInput const& input : config_.inputs) {
            add_input(input);
        }
        for (FmuOutput const& output : config_.outputs) {
            add_output(output);
        }
        for (Ref const& watched : config_.watch) {
            add_watched(watched);
        }
        check_capabilities();
        for (FmuTable::Output const& output : out_.outputs) {
            out_.read.insert(out_.read.end(), output.read.begin(), output.read.end());
        }
        out_.read.insert(out_.read.end(), out_.watched.begin(), out_.watched.end());
        std::sort(out_.read.begin(), out_.read.end());
        out_.read.erase(std::unique(out_.read.begin(), out_.read.end()), out_.read.end());
        return std::move(out_);
    }

  private:
    void error(Ref const& at, std::string message, std::string hint = {}) {
        diagnostics_.error(at.where, std::move(message), std::move(hint), static_cast<int>(at.name.size()));
    }

    /// A variable that can be mapped; what is wrong with the name is said.
    std::optional<std::size_t> variable(Ref const& name) {
        std::string const path = gateways::field_path(name.name);
        if (auto const found = place_of(out_.variables, path)) {
            return found;
        }
        auto const there = std::find_if(description_.variables.begin(), description_.variables.end(),
                                        [&](auto const& v) { return gateways::field_path(v.name) == path; });
        if (there != description_.variables.end()) {
            error(name,
                  fmt::format("the variable '{}' of the FMU is {}", name.name,
                              there->is_array ? "an array" : fmi::name_of(there->type)),
                  "numbers, Booleans and texts can be exchanged");
            return std::nullopt;
        }
        error(name, fmt::format("the FMU has no variable '{}'", name.name),
              spelling_hint(name.name, names_of(out_.variables)));
        return std::nullopt;
    }
    static std::vector<std::string> names_of(std::vector<Field> const& fields) {
        std::vector<std::string> out;
        for (Field const& field : fields) {
            if (!field.name.empty()) {
                out.push_back(field.name);
            }
        }
        return out;
    }

    void add_start(config::Node::Entry const& entry) {
        Ref const name{entry.key, entry.where};
        auto const at = variable(name);
        if (!at) {
            return;
        }
        fmi::Variable const& variable = description_.variables[*at];
        if (!variable.takes_start()) {
            return error(name, fmt::format("'{}' takes no start value: it is a {} {}", entry.key,
                                           fmi::name_of(variable.variability), fmi::name_of(variable.causality)));
        }
        std::string const& text = entry.value.text;
        auto const value = entry.value.is_scalar() ? mapping::parse_constant(text, out_.variables[*at]) : std::nullopt;
        if (!value) {
            return error({text, entry.value.where},
                         fmt::format("'{}' is no value of '{}', which is {}",
                                     entry.value.is_scalar() ? text : config::describe(entry.value), entry.key,
                                     fmi::name_of(variable.type)),
                         mapping::expected_constant(out_.variables[*at]));
        }
        out_.start.push_back({*at, to_fmi(*value)});
    }

    void add_input(FmuInput const& config) {
        auto type = gateways::topic_fields(config.from.type, {}, find_idl_, diagnostics_);
        if (!type) {
            return;
        }
        FmuTable::Input input{config.from, std::move(*type), {}, {}, {}};
        std::vector<FieldRule> const fields = gateways::read_rules(config.fields, diagnostics_);
        std::vector<mapping::Rule> rules;
        std::vector<FieldRule const*> origins;
        for (FieldRule const& field : fields) {
            auto const at = variable(field.to);
            if (!at || !may_be_set(*at, field.to)) {
                continue;
            }
            if (field.value) {
                error(field.to, fmt::format("'{}' is a constant", field.to.name), "constants belong into `start:`");
                continue;
            }
            rules.push_back(rule_of(field));
            origins.push_back(&field);
            input.written.push_back(*at);
        }
        input.rules = compile(rules, origins, input.type.fields, out_.variables);
        for (auto const& [field, text] : input.from.where) {
            add_filter(input, field, text);
        }
        out_.inputs.push_back(std::move(input));
    }

    bool may_be_set(std::size_t at, Ref const& name) {
        fmi::Variable const& v = description_.variables[at];
        if (v.causality == Causality::input ||
            (v.causality == Causality::parameter && v.variability == Variability::tunable)) {
            for (FmuTable::Input const& other : out_.inputs) {
                if (std::find(other.written.begin(), other.written.end(), at) != other.written.end()) {
                    error(name, fmt::format("'{}' has its value from '{}' already", name.name, other.from.topic.name));
                    return false;
                }
            }
            return true;
        }
        error(name,
              fmt::format("'{}' cannot be set while it runs: it is a {} {}", name.name, fmi::name_of(v.variability),
                          fmi::name_of(v.causality)),
              "expected an input or a tunable parameter");
        return false;
    }

    void add_filter(FmuTable::Input& input, Ref const& field, std::string const& text) {
        auto const at = place_of(input.type.fields, field.name);
        if (!at) {
            return error(field, fmt::format("there is no field '{}'", field.name),
                         spelling_hint(field.name, names_of(input.type.fields)));
        }
        auto const& names = input.type.type->enumerators(*at);
        auto const value = mapping::parse_constant(text, input.type.fields[*at], names);
        if (!value) {
            return error(field, fmt::format("'{}' is no value of '{}' to choose samples by", text, field.name),
                         mapping::expected_constant(input.type.fields[*at], names));
        }
        input.filters.push_back({*at, *value});
    }

    void add_output(FmuOutput const& config) {
        FmuTable::Output output;
        Ref type = config.to.type;
        if (config.set_point.empty()) {
            output.topic = config.to.topic.name;
            output.fields = gateways::read_rules(config.fields, diagnostics_);
        } else {
            output.topic = "set_points";
            type = {"SetPoint", config.set_point.where};
            output.fields = set_point_rules(config);
        }
        output.type_name = type.name;
        auto fields = gateways::topic_fields(type, {}, find_idl_, diagnostics_);
        if (!fields) {
            return;
        }
        output.type = std::move(*fields);
        output.time_field = output.type.type->index_of("time_ns");
        compile_output(output);
        if (output.time_field) {
            output.written.push_back(*output.time_field);
        }
        out_.outputs.push_back(std::move(output));
    }

    /// The fields of a set-point, as somebody would write them for the topic.
    std::vector<FieldRule> set_point_rules(FmuOutput const& config) {
        std::string const& path = config.set_point.name;
        std::size_t const dot = path.rfind('.');
        if (std::count(path.begin(), path.end(), '.') < 2) {
            error(config.set_point, fmt::format("'{}' is no quantity of an element", path),
                  "kind.element.quantity, like battery.BAT1.p_kw");
            return {};
        }
        auto const constant = [&](char const* field, std::string text) {
            FieldRule rule;
            rule.to = {field, config.set_point.where};
            rule.value = std::move(text);
            rule.value_at = config.set_point.where;
            return rule;
        };
        FieldRule value = config.value;
        value.to = {"value", config.set_point.where};
        auto const at = place_of(out_.variables, gateways::field_path(value.from.name));
        value.from.name = gateways::field_path(value.from.name);
        if (at && !out_.variables[*at].unit.empty()) {
            value.to_unit = gateways::unit_of_name(path.substr(dot + 1));
        }
        return {constant("element", path.substr(0, dot)), constant("quantity", path.substr(dot + 1)), value,
                constant("valid_for_s", shortest(config.valid_for_s)), constant("source", process_.substr(0, 32))};
    }

    void compile_output(FmuTable::Output& output) {
        std::vector<mapping::Rule> rules;
        std::vector<FieldRule const*> origins;
        for (FieldRule const& field : output.fields) {
            auto const target = place_of(output.type.fields, field.to.name);
            if (!target) {
                error(field.to, fmt::format("there is no field '{}'", field.to.name),
                      spelling_hint(field.to.name, names_of(output.type.fields)));
                continue;
            }
            if (target == output.time_field) {
                error(field.to, fmt::format("'{}' is written by itself: when the sample takes effect", field.to.name));
                continue;
            }
            mapping::Rule rule = rule_of(field);
            if (field.value) {
                auto const& names = output.type.type->enumerators(*target);
                rule.constant = mapping::parse_constant(*field.value, output.type.fields[*target], names);
                if (!rule.constant) {
                    diagnostics_.error(field.value_at,
                                       fmt::format("'{}' is no value of '{}', which is {}", *field.value, field.to.name,
                                                   type_name(output.type.fields[*target].type)),
                                       mapping::expected_constant(output.type.fields[*target], names),
                                       static_cast<int>(field.value->size()));
                    continue;
                }
            } else if (auto const from = variable(field.from)) {
                output.read.push_back(*from);
            } else {
                continue;
            }
            rules.push_back(std::move(rule));
            origins.push_back(&field);
            output.written.push_back(*target);
        }
        std::vector<Field> from = out_.variables;
        for (Field& field : from) {
            field.length = 0; // how long its texts are nobody knows: those that are too long are cut, and it is said
        }
        output.rules = compile(rules, origins, from, output.type.fields);
    }

    mapping::Mapping compile(std::vector<mapping::Rule> const& rules, std::vector<FieldRule const*> const& origins,
                             std::vector<Field> const& from, std::vector<Field> const& to) {
        std::vector<mapping::Mistake> mistakes;
        auto out = mapping::Mapping::compile(rules, from, to, mistakes);
        for (mapping::Mistake& mistake : mistakes) {
            FieldRule const& field = *origins[mistake.rule];
            bool const unknown = mistake.message.starts_with("there is no field");
            Ref const& at = mistake.about_to || field.from.empty() ? field.to : field.from;
            error(at, std::move(mistake.message),
                  unknown ? spelling_hint(at.name, names_of(mistake.about_to ? to : from)) : std::move(mistake.hint));
        }
        return out;
    }

    void add_watched(Ref const& name) {
        auto const at = variable(name);
        if (!at) {
            return;
        }
        fmi::Variable const& variable = description_.variables[*at];
        if (!fmi::is_number(variable.type) && variable.type != fmi::Type::boolean) {
            return error(name, fmt::format("'{}' is {}: a signal is a number", name.name, fmi::name_of(variable.type)));
        }
        std::string const signal = signal_name(process_, variable.name);
        for (std::size_t const other : out_.watched) {
            if (signal_name(process_, description_.variables[other].name) == signal) {
                return error(name, fmt::format("there are two signals '{}'", signal));
            }
        }
        out_.watched.push_back(*at);
    }

    void check_capabilities() {
        auto const& can = description_.co_simulation;
        if (config_.on_restart == FmuConfig::OnRestart::resume && can &&
            !(can->can_serialize_state && can->can_get_and_set_state)) {
            diagnostics_.error(
                config_.on_restart_at, "the FMU cannot keep its state in a file",
                "canGetAndSetFMUState and canSerializeFMUState of its description; `on_restart: start` begins anew");
        }
    }

    FmuConfig const& config_;
    fmi::ModelDescription const& description_;
    std::string const& process_;
    gateways::FindIdl const& find_idl_;
    Diagnostics& diagnostics_;
    FmuTable out_;
};

} // namespace

FmuTable make_table(FmuConfig const& config, fmi::ModelDescription const& description, std::string const& process,
                    gateways::FindIdl const& find_idl, Diagnostics& diagnostics) {
    return TableMaker{config, description, process, find_idl, diagnostics}.run();
}

std::string signal_name(std::string const& process, std::string const& variable) {
    std::string out = "agent." + process + ".";
    for (char const c : gateways::field_path(variable)) {
        out += std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_' || c == '.' ? c : '_';
    }
    return out;
}

} // namespace gridspace::agents
