// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "fmi/model_description.hpp"

#include "common/text.hpp"
#include "fmi/archive.hpp"

#include <algorithm>
#include <array>
#include <cctype>
#include <charconv>
#include <fmt/format.h>
#include <map>
#include <set>
#include <span>
#include <tinyxml2.h>

namespace gridspace::fmi {
namespace {

using Element = tinyxml2::XMLElement;

constexpr std::array<std::string_view, 15> kTypes{"float32", "float64", "int8",   "uint8",       "int16",
                                                  "uint16",  "int32",   "uint32", "int64",       "uint64",
                                                  "boolean", "string",  "binary", "enumeration", "clock"};
constexpr std::array<std::string_view, 7> kCausalities{
    "structuralParameter", "parameter", "calculatedParameter", "input", "output", "local", "independent"};
constexpr std::array<std::string_view, 5> kVariabilities{"constant", "fixed", "tunable", "discrete", "continuous"};
constexpr std::array<std::string_view, 4> kInitials{"", "exact", "approx", "calculated"};
constexpr std::array<std::pair<std::string_view, Type>, 5> kTypesOfFmi2{{{"Real", Type::float64},
                                                                         {"Integer", Type::int32},
                                                                         {"Boolean", Type::boolean},
                                                                         {"String", Type::string},
                                                                         {"Enumeration", Type::enumeration}}};
constexpr std::array<std::pair<std::string_view, Type>, 15> kTypesOfFmi3{{{"Float32", Type::float32},
                                                                          {"Float64", Type::float64},
                                                                          {"Int8", Type::int8},
                                                                          {"UInt8", Type::uint8},
                                                                          {"Int16", Type::int16},
                                                                          {"UInt16", Type::uint16},
                                                                          {"Int32", Type::int32},
                                                                          {"UInt32", Type::uint32},
                                                                          {"Int64", Type::int64},
                                                                          {"UInt64", Type::uint64},
                                                                          {"Boolean", Type::boolean},
                                                                          {"String", Type::string},
                                                                          {"Binary", Type::binary},
                                                                          {"Enumeration", Type::enumeration},
                                                                          {"Clock", Type::clock}}};
constexpr std::size_t kMostVariables = 200'000;

template <class Names>
std::optional<std::size_t> place_of(Names const& names, std::string_view name) {
    auto const found = std::find(names.begin(), names.end(), name);
    return found == names.end() ? std::nullopt : std::optional{static_cast<std::size_t>(found - names.begin())};
}

std::optional<Type> type_of(std::span<std::pair<std::string_view, Type> const> known, std::string_view name) {
    auto const found = std::find_if(known.begin(), known.end(), [&](auto const& one) { return one.first == name; });
    return found == known.end() ? std::nullopt : std::optional{found->second};
}

std::string text(Element const& element, char const* name) {
    char const* const value = element.Attribute(name);
    return value == nullptr ? "" : value;
}

/// Reads one description; stops at the first mistake.
class Reader {
  public:
    explicit Reader(std::string const& file) : file_{file} { out_.file = file; }

    Result<ModelDescription> run(std::string_view xml) {
        tinyxml2::XMLDocument document;
        if (document.Parse(xml.data(), xml.size()) != tinyxml2::XML_SUCCESS) {
            refuse(document.ErrorLineNum(), fmt::format("it is not XML: {}", document.ErrorName()));
        } else if (Element const* root = document.RootElement(); root == nullptr) {
            refuse(0, "it is empty");
        } else if (std::string_view{root->Name()} != "fmiModelDescription") {
            refuse(root->GetLineNum(), fmt::format("the root element is '{}', not fmiModelDescription", root->Name()));
        } else {
            read(*root);
        }
        return mistake_ ? Result<ModelDescription>{std::unexpected{*mistake_}} : std::move(out_);
    }

  private:
    void refuse(int line, std::string const& what, std::string remedy = {}) {
        if (!mistake_) {
            std::string const place = line > 0 ? fmt::format(":{}", line) : "";
            mistake_ = Error{ExitCode::usage, fmt::format("{}: modelDescription.xml{}: {}", file_, place, what),
                             std::move(remedy)};
        }
    }

    void read(Element const& root) {
        out_.version_text = text(root, "fmiVersion");
        if (out_.version_text == "2.0" || out_.version_text.starts_with("2.0.")) {
            out_.version = Version::fmi2;
        } else if (out_.version_text == "3.0" || out_.version_text.starts_with("3.0")) {
            out_.version = Version::fmi3;
        } else {
            return refuse(root.GetLineNum(),
                          fmt::format("fmiVersion is '{}', and 2.0 and 3.0 are known", out_.version_text),
                          "export it as FMI 2.0 or 3.0 for co-simulation");
        }
        bool const second = out_.version == Version::fmi2;
        out_.name = required(root, "modelName");
        out_.token = required(root, second ? "guid" : "instantiationToken");
        out_.description = text(root, "description");
        out_.model_version = text(root, "version");
        out_.author = text(root, "author");
        out_.tool = text(root, "generationTool");
        out_.generated = text(root, "generationDateAndTime");
        out_.license = text(root, "license");
        out_.model_exchange = root.FirstChildElement("ModelExchange") != nullptr;
        out_.scheduled_execution = root.FirstChildElement("ScheduledExecution") != nullptr;
        if (Element const* one = root.FirstChildElement("CoSimulation")) {
            read_co_simulation(*one);
        }
        if (Element const* one = root.FirstChildElement("DefaultExperiment")) {
            out_.start_s = number(*one, "startTime");
            out_.stop_s = number(*one, "stopTime");
            out_.step_s = number(*one, "stepSize");
            out_.tolerance = number(*one, "tolerance");
        }
        if (Element const* types = root.FirstChildElement("TypeDefinitions")) {
            read_units_of_types(*types);
        }
        Element const* const variables = root.FirstChildElement("ModelVariables");
        if (variables == nullptr) {
            return refuse(root.GetLineNum(), "it has no ModelVariables");
        }
        for (Element const* one = variables->FirstChildElement(); one != nullptr && !mistake_;
             one = one->NextSiblingElement()) {
            second ? read_variable2(*one) : read_variable3(*one);
        }
    }

    std::string required(Element const& element, char const* name) {
        if (element.Attribute(name) == nullptr) {
            refuse(element.GetLineNum(), fmt::format("{} has no '{}'", element.Name(), name));
        }
        return text(element, name);
    }

    bool flag(Element const& element, char const* name) {
        std::string const value = text(element, name);
        if (!value.empty() && value != "true" && value != "false" && value != "1" && value != "0") {
            refuse(element.GetLineNum(), fmt::format("{} is '{}', expected true or false", name, value));
        }
        return value == "true" || value == "1";
    }

    std::optional<double> number(Element const& element, char const* name) {
        std::string const written = text(element, name);
        if (written.empty()) {
            return std::nullopt;
        }
        double value = 0;
        auto const [end, code] = std::from_chars(written.data(), written.data() + written.size(), value);
        if (code != std::errc{} || end != written.data() + written.size()) {
            refuse(element.GetLineNum(), fmt::format("{} is '{}', expected a number", name, written));
        }
        return value;
    }

    void read_co_simulation(Element const& element) {
        bool const second = out_.version == Version::fmi2;
        CoSimulation one;
        one.identifier = required(element, "modelIdentifier");
        bool const plain = std::all_of(one.identifier.begin(), one.identifier.end(), [](unsigned char c) {
            return std::isalnum(c) != 0 || c == '_' || c == '-' || c == '.';
        });
        if (one.identifier.empty() || !plain || one.identifier.starts_with('.')) { // it becomes the name of a file
            refuse(element.GetLineNum(),
                   fmt::format("modelIdentifier is '{}', expected letters, digits and '_'", one.identifier));
        }
        one.variable_step = flag(element, "canHandleVariableCommunicationStepSize");
        one.can_get_and_set_state = flag(element, second ? "canGetAndSetFMUstate" : "canGetAndSetFMUState");
        one.can_serialize_state = flag(element, second ? "canSerializeFMUstate" : "canSerializeFMUState");
        one.has_event_mode = flag(element, "hasEventMode");
        one.needs_execution_tool = flag(element, "needsExecutionTool");
        one.fixed_internal_step_s = number(element, "fixedInternalStepSize");
        out_.co_simulation = std::move(one);
    }

    /// Units of declared types: <SimpleType name><Real unit/></SimpleType>, or <Float64Type name unit/>.
    void read_units_of_types(Element const& types) {
        for (Element const* one = types.FirstChildElement(); one != nullptr; one = one->NextSiblingElement()) {
            Element const* const within = one->FirstChildElement("Real");
            units_.emplace(text(*one, "name"), text(within == nullptr ? *one : *within, "unit"));
        }
    }

    template <class E, class Names>
    void word(Element const& element, char const* name, Names const& names, E& value) {
        char const* const written = element.Attribute(name);
        if (written == nullptr) {
            return;
        }
        if (auto const place = place_of(names, written)) {
            value = static_cast<E>(*place);
        } else {
            refuse(element.GetLineNum(),
                   fmt::format("{} is '{}', expected {}", name, written, join(names_in(names), ", ")));
        }
    }
    template <class Names>
    static std::vector<std::string> names_in(Names const& names) {
        std::vector<std::string> out;
        for (std::string_view const name : names) {
            if (!name.empty()) {
                out.emplace_back(name);
            }
        }
        return out;
    }

    void read_variable2(Element const& element) {
        if (std::string_view{element.Name()} != "ScalarVariable") {
            return; // extensions
        }
        Element const* typed = element.FirstChildElement();
        while (typed != nullptr && !type_of(kTypesOfFmi2, typed->Name())) {
            typed = typed->NextSiblingElement();
        }
        if (typed == nullptr) {
            return refuse(element.GetLineNum(), fmt::format("variable '{}' has no type", text(element, "name")));
        }
        add(element, *typed, *type_of(kTypesOfFmi2, typed->Name()));
    }

    void read_variable3(Element const& element) {
        auto const type = type_of(kTypesOfFmi3, element.Name());
        if (!type) {
            return; // Annotations
        }
        add(element, element, *type);
        Variable const original = out_.variables.empty() ? Variable{} : out_.variables.back();
        for (Element const* alias = element.FirstChildElement("Alias"); alias != nullptr && !mistake_;
             alias = alias->NextSiblingElement("Alias")) {
            Variable other = original;
            other.name = required(*alias, "name");
            other.description = text(*alias, "description");
            keep(std::move(other), *alias);
        }
    }

    /// `element` says what the variable is, `typed` (in FMI 2.0 the element within it) what its values are.
    void add(Element const& element, Element const& typed, Type type) {
        Variable one;
        one.type = type;
        one.name = required(element, "name");
        one.description = text(element, "description");
        bool const is_float = type == Type::float64 || type == Type::float32;
        one.variability = is_float ? Variability::continuous : Variability::discrete;
        word(element, "causality", kCausalities, one.causality);
        word(element, "variability", kVariabilities, one.variability);
        word(element, "initial", kInitials, one.initial);
        std::string const reference = required(element, "valueReference");
        auto const [end, code] = std::from_chars(reference.data(), reference.data() + reference.size(), one.reference);
        if (code != std::errc{} || end != reference.data() + reference.size()) {
            refuse(element.GetLineNum(), fmt::format("valueReference is '{}', expected a whole number", reference));
        }
        if (char const* start = typed.Attribute("start")) {
            one.start = start;
        } else if (Element const* within = typed.FirstChildElement("Start")) {
            one.start = text(*within, "value");
        }
        one.unit = text(typed, "unit");
        if (auto const known = units_.find(text(typed, "declaredType")); one.unit.empty() && known != units_.end()) {
            one.unit = known->second;
        }
        one.is_array = typed.FirstChildElement("Dimension") != nullptr;
        keep(std::move(one), element);
    }

    void keep(Variable one, Element const& element) {
        if (!names_.insert(one.name).second) {
            refuse(element.GetLineNum(), fmt::format("there are two variables '{}'", one.name));
        }
        if (out_.variables.size() >= kMostVariables) {
            refuse(element.GetLineNum(), fmt::format("it has more than {} variables", kMostVariables));
        }
        out_.variables.push_back(std::move(one));
    }

    std::string const& file_;
    ModelDescription out_;
    std::map<std::string, std::string> units_; ///< by declared type
    std::set<std::string> names_;
    std::optional<Error> mistake_;
};

} // namespace

std::string_view name_of(Version version) noexcept {
    return version == Version::fmi2 ? "2.0" : "3.0";
}
std::string_view name_of(Type type) noexcept {
    return kTypes[static_cast<std::size_t>(type)];
}
std::string_view name_of(Causality causality) noexcept {
    return kCausalities[static_cast<std::size_t>(causality)];
}
std::string_view name_of(Variability variability) noexcept {
    return kVariabilities[static_cast<std::size_t>(variability)];
}
bool is_number(Type type) noexcept {
    return type <= Type::uint64 || type == Type::enumeration;
}

/// A structural parameter is set in Configuration Mode only (FMI 3.0.1, 2.2.9), which we never enter.
bool Variable::takes_start() const noexcept {
    if (variability == Variability::constant || causality == Causality::independent ||
        causality == Causality::calculated_parameter || causality == Causality::structural_parameter) {
        return false;
    }
    bool const by_causality = causality == Causality::input || causality == Causality::parameter;
    bool const by_initial = initial == Initial::exact || initial == Initial::approx;
    return by_causality || by_initial || (initial == Initial::none && start.has_value());
}

Variable const* ModelDescription::find(std::string_view variable) const {
    auto const found =
        std::find_if(variables.begin(), variables.end(), [&](Variable const& v) { return v.name == variable; });
    return found == variables.end() ? nullptr : &*found;
}

Result<CoSimulation> ModelDescription::usable() const {
    if (co_simulation) {
        return *co_simulation;
    }
    std::string_view const only = model_exchange        ? "model exchange"
                                  : scheduled_execution ? "scheduled execution"
                                                        : "no interface at all";
    return fail(ExitCode::usage, fmt::format("{}: it is for {} only, and an agent needs co-simulation", file, only),
                "export it for co-simulation, where it brings its own solver");
}

Result<ModelDescription> parse_model_description(std::string_view xml, std::string const& file) {
    return Reader{file}.run(xml);
}

} // namespace gridspace::fmi
