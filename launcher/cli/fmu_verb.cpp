// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
//
// `gridspace fmu info`: what an FMU says of itself. Nothing of it is run. `fmu export`: fmu_export_verb.cpp
#include "common/text.hpp"
#include "fmi/archive.hpp"
#include "fmi/model_description.hpp"
#include "launcher/cli/load.hpp"
#include "launcher/cli/verbs.hpp"

#include <fmt/format.h>
#include <memory>
#include <nlohmann/json.hpp>

namespace gridspace::cli {
namespace {

using Json = nlohmann::ordered_json;

/// What is not given is left out.
void put(Json& out, char const* key, std::string const& text) {
    if (!text.empty()) {
        out[key] = text;
    }
}
void put(Json& out, char const* key, std::optional<double> number) {
    if (number) {
        out[key] = *number;
    }
}

Json to_json(fmi::ModelDescription const& d, std::vector<std::string> const& platforms, std::string const& usable) {
    Json out{{"file", d.file}, {"fmi_version", d.version_text}, {"name", d.name}};
    put(out, "description", d.description);
    put(out, "version", d.model_version);
    put(out, "author", d.author);
    put(out, "license", d.license);
    put(out, "tool", d.tool);
    put(out, "generated", d.generated);
    out["kinds"] = {{"co_simulation", d.co_simulation.has_value()},
                    {"model_exchange", d.model_exchange},
                    {"scheduled_execution", d.scheduled_execution}};
    out["platforms"] = platforms;
    out["runs_here"] = usable.empty();
    put(out, "why_not", usable);
    if (d.co_simulation) {
        fmi::CoSimulation const& c = *d.co_simulation;
        Json can{{"variable_step", c.variable_step},
                 {"get_and_set_state", c.can_get_and_set_state},
                 {"serialize_state", c.can_serialize_state},
                 {"event_mode", c.has_event_mode},
                 {"needs_execution_tool", c.needs_execution_tool}};
        put(can, "fixed_internal_step_s", c.fixed_internal_step_s);
        out["capabilities"] = std::move(can);
    }
    Json experiment = Json::object();
    put(experiment, "start_s", d.start_s);
    put(experiment, "stop_s", d.stop_s);
    put(experiment, "step_s", d.step_s);
    put(experiment, "tolerance", d.tolerance);
    out["default_experiment"] = std::move(experiment);
    Json variables = Json::array();
    for (fmi::Variable const& v : d.variables) {
        Json one{{"name", v.name},
                 {"type", fmi::name_of(v.type)},
                 {"causality", fmi::name_of(v.causality)},
                 {"variability", fmi::name_of(v.variability)}};
        put(one, "unit", v.unit);
        if (v.start) {
            one["start"] = *v.start;
        }
        if (v.is_array) {
            one["array"] = true;
        }
        put(one, "description", v.description);
        variables.push_back(std::move(one));
    }
    out["variables"] = std::move(variables);
    return out;
}

void print(fmi::ModelDescription const& d, std::vector<std::string> const& platforms, std::string const& usable) {
    auto const line = [](std::string_view key, std::string const& value) {
        if (!value.empty()) {
            fmt::print("{:<14} {}\n", key, printable(value));
        }
    };
    std::vector<std::string> kinds, can;
    for (auto const& [has, kind] : {std::pair{d.co_simulation.has_value(), "co-simulation"},
                                    {d.model_exchange, "model exchange"},
                                    {d.scheduled_execution, "scheduled execution"}}) {
        if (has) {
            kinds.emplace_back(kind);
        }
    }
    line("name", d.name);
    line("description", d.description);
    line("FMI", fmt::format("{}, {}", d.version_text, kinds.empty() ? "no interface" : join(kinds, ", ")));
    line("version", d.model_version);
    line("author", d.author);
    line("license", d.license);
    line("made by", join({d.tool, d.generated}, d.tool.empty() || d.generated.empty() ? "" : ", "));
    line("binaries", platforms.empty() ? "none" : join(platforms, ", "));
    line("runs here", usable.empty() ? "yes" : "no: " + usable);
    if (d.co_simulation) {
        fmi::CoSimulation const& c = *d.co_simulation;
        for (auto const& [has, what] : {std::pair{c.variable_step, "steps of any size"},
                                        {c.can_get_and_set_state, "state set back"},
                                        {c.can_serialize_state, "state kept in a file"},
                                        {c.has_event_mode, "event mode"},
                                        {c.needs_execution_tool, "needs the tool that made it"}}) {
            if (has) {
                can.emplace_back(what);
            }
        }
        line("capabilities", can.empty() ? "none of those that are optional" : join(can, ", "));
    }
    auto const seconds = [](std::optional<double> s) { return s ? shortest(*s) + " s" : "-"; };
    if (d.start_s || d.stop_s || d.step_s) {
        line("experiment",
             fmt::format("from {} to {}, step {}", seconds(d.start_s), seconds(d.stop_s), seconds(d.step_s)));
    }
    std::size_t width = 32;
    for (auto const& v : d.variables) {
        width = std::max(width, printable(v.name).size() + (v.is_array ? 2 : 0));
    }
    fmt::print("\n{:<{}} {:<12} {:<20} {:<12} {:<8} {}\n", "variable", width, "type", "causality", "variability",
               "unit", "start");
    for (fmi::Variable const& v : d.variables) {
        fmt::print("{:<{}} {:<12} {:<20} {:<12} {:<8} {}\n", printable(v.name) + (v.is_array ? "[]" : ""), width,
                   fmi::name_of(v.type), fmi::name_of(v.causality), fmi::name_of(v.variability),
                   v.unit.empty() ? "-" : printable(v.unit), printable(v.start.value_or("-")));
    }
}

int info(std::filesystem::path const& file, bool json) {
    auto const archive = fmi::Archive::open(file);
    if (!archive) {
        return print_error(archive.error());
    }
    auto const description = fmi::read_model_description(*archive, file.string());
    if (!description) {
        return print_error(description.error());
    }
    auto const binary = fmi::binary_of(*archive, *description);
    std::string const why_not = binary ? "" : binary.error().message.substr(file.string().size() + 2);
    if (json) {
        fmt::print("{}\n", to_json(*description, fmi::platforms(*archive), why_not)
                               .dump(2, ' ', false, Json::error_handler_t::replace));
    } else {
        print(*description, fmi::platforms(*archive), why_not);
    }
    return 0;
}

} // namespace

void add_fmu(Command app, Action& action) {
    struct Arguments {
        std::filesystem::path file;
        bool json{false};
    };
    Command verb =
        app.add_subcommand("fmu", "models of other tools, and networks for them (Functional Mock-up Interface)");
    verb.require_subcommand();
    auto const a = std::make_shared<Arguments>();
    Command shown =
        verb.add_subcommand("info", "show what an FMU is: version, variables with their units, capabilities");
    shown.add_option("FILE", a->file, "the FMU").required();
    shown.add_flag("--json", a->json, "as JSON");
    shown.callback([a, &action] { action = [a] { return info(a->file, a->json); }; });
    add_fmu_export(verb, action);
}

} // namespace gridspace::cli
