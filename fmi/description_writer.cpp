// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/description_writer.hpp"

#include "common/text.hpp"
#include "fmi/units.hpp"

#include <set>
#include <tinyxml2.h>

namespace gridspace::fmi {
namespace {

using tinyxml2::XMLPrinter;

class DescriptionWriter {
  public:
    explicit DescriptionWriter(ModelDescription const& description) : d_{description} {}

    std::string run() {
        out_.PushHeader(false, true);
        out_.OpenElement("fmiModelDescription");
        text("fmiVersion", d_.version_text);
        text("modelName", d_.name);
        text("instantiationToken", d_.token);
        text("description", d_.description);
        text("generationTool", d_.tool);
        text("variableNamingConvention", "structured");
        interface();
        units();
        enumerations();
        log_categories();
        experiment();
        out_.OpenElement("ModelVariables");
        for (Variable const& v : d_.variables) {
            variable(v);
        }
        out_.CloseElement();
        structure();
        out_.CloseElement();
        return {out_.CStr(), static_cast<std::size_t>(out_.CStrSize()) - 1};
    }

  private:
    void text(char const* name, std::string const& value) {
        if (!value.empty()) {
            out_.PushAttribute(name, value.c_str());
        }
    }
    void number(char const* name, std::optional<double> value) {
        if (value) {
            out_.PushAttribute(name, shortest(*value).c_str());
        }
    }

    void interface() {
        CoSimulation const& can = *d_.co_simulation;
        out_.OpenElement("CoSimulation");
        text("modelIdentifier", can.identifier);
        out_.PushAttribute("canHandleVariableCommunicationStepSize", can.variable_step);
        out_.PushAttribute("canGetAndSetFMUState", can.can_get_and_set_state);
        out_.PushAttribute("canSerializeFMUState", can.can_serialize_state);
        number("fixedInternalStepSize", can.fixed_internal_step_s);
        out_.CloseElement();
    }

    void units() {
        std::set<std::string> used;
        for (Variable const& v : d_.variables) {
            used.insert(v.unit);
        }
        used.erase("");
        if (used.empty()) {
            return; // the standard knows no empty list
        }
        out_.OpenElement("UnitDefinitions");
        for (std::string const& name : used) {
            out_.OpenElement("Unit");
            text("name", name);
            if (Unit const* known = unit_named(name)) {
                base_unit(*known);
            }
            out_.CloseElement();
        }
        out_.CloseElement();
    }

    static std::string type_of(Variable const& v) { return "type." + v.name; }

    void enumerations() {
        bool any = false;
        for (Variable const& v : d_.variables) {
            if (v.type != Type::enumeration) {
                continue;
            }
            if (!any) {
                out_.OpenElement("TypeDefinitions");
                any = true;
            }
            out_.OpenElement("EnumerationType");
            text("name", type_of(v));
            int value = 0;
            for (std::string const& item : v.items) {
                out_.OpenElement("Item");
                text("name", item);
                out_.PushAttribute("value", ++value);
                out_.CloseElement();
            }
            out_.CloseElement();
        }
        if (any) {
            out_.CloseElement();
        }
    }

    void base_unit(Unit const& unit) {
        out_.OpenElement("BaseUnit");
        for (auto const& [name, exponent] : {std::pair{"kg", unit.kg},
                                             {"m", unit.m},
                                             {"s", unit.s},
                                             {"A", unit.a},
                                             {"K", unit.k},
                                             {"rad", unit.rad}}) {
            if (exponent != 0) {
                out_.PushAttribute(name, exponent);
            }
        }
        if (unit.factor != 1) {
            number("factor", unit.factor);
        }
        if (unit.offset != 0) {
            number("offset", unit.offset);
        }
        out_.CloseElement();
    }

    void log_categories() {
        out_.OpenElement("LogCategories");
        out_.OpenElement("Category");
        text("name", "logStatusError");
        text("description", "why a function returned fmi3Error");
        out_.CloseElement();
        out_.CloseElement();
    }

    void experiment() {
        out_.OpenElement("DefaultExperiment");
        number("startTime", d_.start_s);
        number("stopTime", d_.stop_s);
        number("stepSize", d_.step_s);
        out_.CloseElement();
    }

    void variable(Variable const& v) {
        bool const words = v.type == Type::enumeration;
        out_.OpenElement(words ? "Enumeration" : v.type == Type::boolean ? "Boolean" : "Float64");
        text("name", v.name);
        out_.PushAttribute("valueReference", static_cast<unsigned>(v.reference));
        text("description", v.description);
        text("causality", std::string{name_of(v.causality)});
        text("variability", std::string{name_of(v.variability)});
        text("declaredType", words ? type_of(v) : "");
        text("unit", v.unit);
        number("min", v.min);
        number("max", v.max);
        text("start", v.start.value_or(""));
        out_.CloseElement();
    }

    void structure() {
        out_.OpenElement("ModelStructure");
        for (char const* element : {"Output", "InitialUnknown"}) {
            for (Variable const& v : d_.variables) {
                if (v.causality == Causality::output) {
                    out_.OpenElement(element);
                    out_.PushAttribute("valueReference", static_cast<unsigned>(v.reference));
                    out_.PushAttribute("dependencies", "");
                    out_.CloseElement();
                }
            }
        }
        out_.CloseElement();
    }

    ModelDescription const& d_;
    XMLPrinter out_;
};

} // namespace

std::string write_model_description(ModelDescription const& description) {
    return DescriptionWriter{description}.run();
}

} // namespace gridspace::fmi
