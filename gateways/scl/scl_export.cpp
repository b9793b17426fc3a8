// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_export.hpp"

#include "common/text.hpp"
#include "gateways/scl/data_types.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

namespace gridspace::scl {
namespace {

using iec61850::BasicType;
using iec61850::DataNode;
using streams::Stream;
using tinyxml2::XMLElement;

/// Where a stream stands in the model.
struct Place {
    std::string ied, inst, ld_name; ///< ld_name: empty when it is ied + inst
    std::string block, data_set;
};

std::string identifier(std::string text) {
    std::replace_if(
        text.begin(), text.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
    return text.empty() || std::isalpha(static_cast<unsigned char>(text[0])) == 0 ? "S" + text : text;
}

/// "IED2LD0" is device LD0 of IED2; another name is a functional one, of an IED called so.
void place_device(std::string const& ld, Place& out) {
    std::size_t const at = ld.rfind("LD");
    bool const usual = at != std::string::npos && at > 0 && at + 2 < ld.size() &&
                       identifier(ld.substr(0, at)) == ld.substr(0, at) &&
                       std::all_of(ld.begin() + static_cast<std::ptrdiff_t>(at) + 2, ld.end(),
                                   [](char c) { return c >= '0' && c <= '9'; });
    out.ied = usual ? ld.substr(0, at) : identifier(ld);
    out.inst = usual ? ld.substr(at) : "LD0";
    out.ld_name = usual ? "" : ld;
}

Place place_of(Stream const& s, std::size_t number) {
    Place out;
    std::string const& reference = s.kind == streams::Kind::goose ? s.control_block : s.data_set_name;
    std::size_t const slash = reference.find('/');
    place_device(slash == std::string::npos ? identifier(s.kind == streams::Kind::goose ? s.name.name : s.sv_id) + "LD0"
                                            : reference.substr(0, slash),
                 out);
    std::size_t const block = s.control_block.rfind('$');
    out.block = s.kind == streams::Kind::goose
                    ? identifier(block == std::string::npos ? s.control_block : s.control_block.substr(block + 1))
                    : fmt::format("MSVCB{:02}", number);
    std::size_t const set = s.data_set_name.rfind('$');
    out.data_set = set == std::string::npos ? s.name.name : s.data_set_name.substr(set + 1);
    return out;
}

/// Writes elements into one document.
class Exporter {
  public:
    Result<std::string> run(std::vector<Stream> const& streams, std::string const& id) {
        document_.InsertEndChild(document_.NewDeclaration());
        XMLElement* const root = document_.NewElement("SCL");
        document_.InsertEndChild(root);
        set(root,
            {{"xmlns", "http://www.iec.ch/61850/2003/SCL"}, {"version", "2007"}, {"revision", "B"}, {"release", "4"}});
        set(add(root, "Header"), {{"id", id}, {"nameStructure", "IEDName"}});
        XMLElement* const net = add(add(root, "Communication"), "SubNetwork");
        set(net, {{"name", "process_bus"}, {"type", "8-MMS"}});
        templates_ = document_.NewElement("DataTypeTemplates");
        std::map<std::string, std::vector<std::pair<Stream const*, Place>>> ieds;
        std::size_t number = 0;
        for (Stream const& s : streams) {
            Place const place = place_of(s, ++number);
            ieds[place.ied].emplace_back(&s, place);
        }
        write_common_types();
        for (auto const& [ied, own] : ieds) {
            write_addresses(net, ied, own);
            if (auto ok = write_ied(root, ied, own); !ok) {
                return std::unexpected{ok.error()};
            }
        }
        root->InsertEndChild(templates_);
        // The schema wants the kinds of types one after the other.
        for (auto* list : {&ln_types_, &do_types_, &da_types_, &enums_}) {
            for (XMLElement* e : *list) {
                templates_->InsertEndChild(e);
            }
        }
        tinyxml2::XMLPrinter printer;
        document_.Print(&printer);
        return std::string{printer.CStr()};
    }

  private:
    using Attributes = std::vector<std::pair<char const*, std::string>>;
    using Streams = std::vector<std::pair<Stream const*, Place>>;

    XMLElement* add(XMLElement* parent, char const* name) {
        XMLElement* const e = document_.NewElement(name);
        parent->InsertEndChild(e);
        return e;
    }
    static XMLElement* set(XMLElement* e, Attributes const& attributes) {
        for (auto const& [name, value] : attributes) {
            e->SetAttribute(name, value.c_str());
        }
        return e;
    }
    XMLElement* type(std::vector<XMLElement*>& list, char const* kind, Attributes const& attributes) {
        list.push_back(set(document_.NewElement(kind), attributes));
        return list.back();
    }

    void write_addresses(XMLElement* net, std::string const& ied, Streams const& own) {
        XMLElement* const point = set(add(net, "ConnectedAP"), {{"iedName", ied}, {"apName", "AP1"}});
        for (streams::Kind const kind : {streams::Kind::goose, streams::Kind::smv}) { // GSE before SMV
            for (auto const& [s, place] : own) {
                if (s->kind != kind) {
                    continue;
                }
                bool const goose = kind == streams::Kind::goose;
                XMLElement* const e =
                    set(add(point, goose ? "GSE" : "SMV"), {{"ldInst", place.inst}, {"cbName", place.block}});
                XMLElement* const address = add(e, "Address");
                std::string mac = s->address.destination.to_string();
                std::replace(mac.begin(), mac.end(), ':', '-');
                auto const p = [&](char const* what, std::string const& value) {
                    set(add(address, "P"), {{"type", what}})->SetText(value.c_str());
                };
                p("MAC-Address", mac);
                p("APPID", fmt::format("{:04X}", s->address.app_id));
                if (s->address.vlan) {
                    p("VLAN-ID", fmt::format("{:03X}", s->address.vlan->id));
                    p("VLAN-PRIORITY", fmt::format("{}", s->address.vlan->priority));
                }
                if (goose) {
                    for (auto const& [name, ms] :
                         {std::pair{"MinTime", s->timing.min_time_ms}, {"MaxTime", s->timing.max_time_ms}}) {
                        set(add(e, name), {{"unit", "s"}, {"multiplier", "m"}})->SetText(shortest(ms).c_str());
                    }
                }
            }
        }
    }

    Result<void> write_ied(XMLElement* root, std::string const& ied, Streams const& own) {
        XMLElement* const server =
            add(set(add(set(add(root, "IED"), {{"name", ied}, {"manufacturer", "Gridspace"}}), "AccessPoint"),
                    {{"name", "AP1"}}),
                "Server");
        set(add(server, "Authentication"), {{"none", "true"}});
        std::map<std::string, Streams> devices;
        for (auto const& one : own) {
            devices[one.second.inst].push_back(one);
        }
        for (auto const& [inst, streams] : devices) {
            XMLElement* const device = set(add(server, "LDevice"), {{"inst", inst}});
            if (!streams[0].second.ld_name.empty()) {
                device->SetAttribute("ldName", streams[0].second.ld_name.c_str());
            }
            XMLElement* const ln0 =
                set(add(device, "LN0"), {{"lnClass", "LLN0"}, {"inst", ""}, {"lnType", "LLN0_type"}});
            std::string const ln_type = fmt::format("{}_{}_GGIO", ied, inst);
            ln_type_ = type(ln_types_, "LNodeType", {{"id", ln_type}, {"lnClass", "GGIO"}});
            set(add(ln_type_, "DO"), {{"name", "Beh"}, {"type", "ENS_Beh"}});
            counters_.clear();
            std::map<std::string, Stream const*> sets; // a name is one set, whoever sends it
            for (auto const& [s, place] : streams) {
                auto const [same_name, fresh] = sets.try_emplace(place.data_set, s);
                if (!fresh && same_name->second->data_set != s->data_set) {
                    return fail(ExitCode::usage,
                                fmt::format("streams '{}' and '{}' call different data sets '{}' in {}{}",
                                            same_name->second->name.name, s->name.name, place.data_set, ied, inst),
                                "another `data_set_name`, or the same `data_set`, for one of them");
                }
                if (auto ok = fresh ? write_data_set(ln0, *s, place) : Result<void>{}; !ok) {
                    return ok;
                }
            }
            write_control_blocks(ln0, streams);
            set(add(device, "LN"), {{"lnClass", "GGIO"}, {"inst", "1"}, {"lnType", ln_type}});
        }
        return {};
    }

    void write_control_blocks(XMLElement* ln0, Streams const& streams) {
        for (auto const& [s, place] : streams) {
            if (s->kind == streams::Kind::goose) {
                set(add(ln0, "GSEControl"),
                    {{"name", place.block},
                     {"datSet", place.data_set},
                     {"confRev", std::to_string(s->conf_rev)},
                     {"type", "GOOSE"},
                     {"appID", s->go_id.empty() ? s->control_block : s->go_id},
                     {"fixedOffs", s->integers == iec61850::IntegerForm::fixed ? "true" : "false"}});
            }
        }
        for (auto const& [s, place] : streams) {
            if (s->kind == streams::Kind::smv) {
                XMLElement* const e =
                    set(add(ln0, "SampledValueControl"), {{"name", place.block},
                                                          {"datSet", place.data_set},
                                                          {"confRev", std::to_string(s->conf_rev)},
                                                          {"smvID", s->sv_id},
                                                          {"multicast", "true"},
                                                          {"smpMod", "SmpPerSec"},
                                                          {"smpRate", std::to_string(s->rate_hz.num())},
                                                          {"nofASDU", std::to_string(s->samples_per_frame)}});
                auto const flag = [](bool v) { return std::string{v ? "true" : "false"}; };
                set(add(e, "SmvOpts"), {{"refreshTime", flag(s->send_refr_tm)},
                                        {"sampleSynchronized", "true"},
                                        {"sampleRate", flag(s->send_smp_rate)},
                                        {"dataSet", flag(!s->data_set_name.empty())}});
            }
        }
    }

    Result<void> write_data_set(XMLElement* ln0, Stream const& s, Place const& place) {
        XMLElement* const set_element = set(add(ln0, "DataSet"), {{"name", place.data_set}});
        for (DataNode const& member : s.data_set.members) {
            auto const where = write_member(member);
            if (!where) {
                return fail(ExitCode::usage,
                            fmt::format("stream '{}': member '{}' {}", s.name.name, member.name, where.error().message),
                            where.error().remedy);
            }
            XMLElement* const fcda =
                set(add(set_element, "FCDA"),
                    {{"ldInst", place.inst}, {"lnClass", "GGIO"}, {"lnInst", "1"}, {"doName", where->object}});
            if (!where->attribute.empty()) {
                fcda->SetAttribute("daName", where->attribute.c_str());
            }
            fcda->SetAttribute("fc", where->constraint.c_str());
        }
        return {};
    }

    struct Reference {
        std::string object, attribute, constraint;
    };
    struct Class {
        char const *object, *cdc, *attribute, *constraint;
    };
    static Class class_of(BasicType type) {
        switch (type) {
        case BasicType::float32:
        case BasicType::float64:
            return {"AnIn", "MV", "mag.f", "MX"};
        case BasicType::position:
            return {"DPCSO", "DPC", "stVal", "ST"};
        case BasicType::boolean:
            return {"Ind", "SPS", "stVal", "ST"};
        case BasicType::visible_string:
            return {"VSDesc", "VSS", "stVal", "ST"};
        case BasicType::quality:
            return {"Ind", "SPS", "q", "ST"};
        case BasicType::timestamp:
            return {"Ind", "SPS", "t", "ST"};
        case BasicType::enumerated:
            return {"IntIn", "ENS", "stVal", "ST"};
        default:
            return {"IntIn", "INS", "stVal", "ST"};
        }
    }

    /// A data object of its own for a member, with its type.
    Result<Reference> write_member(DataNode const& member) {
        std::vector<iec61850::Leaf> const leaves = iec61850::leaves_of({{member}});
        if (leaves.empty()) {
            return fail(ExitCode::usage, "is empty");
        }
        Class const c = class_of(leaves[0].type);
        std::string const object = fmt::format("{}{}", c.object, ++counters_[c.object]);
        std::string const id = fmt::format("{}_{}", ln_type_->Attribute("id"), object);
        set(add(ln_type_, "DO"), {{"name", object}, {"type", id}, {"desc", member.name}});
        XMLElement* const definition = type(do_types_, "DOType", {{"id", id}, {"cdc", c.cdc}});
        if (member.kind == DataNode::Kind::leaf) {
            if (auto ok = write_leaf(definition, "DA", split(c.attribute, '.'), 0, leaves[0], c.constraint, id); !ok) {
                return std::unexpected{ok.error()};
            }
            return Reference{object, c.attribute, c.constraint};
        }
        if (auto ok = write_structure(definition, "DA", member, c.constraint, id); !ok) {
            return std::unexpected{ok.error()};
        }
        return Reference{object, "", c.constraint};
    }

    Result<void> write_leaf(XMLElement* parent, char const* kind, std::vector<std::string> const& path, std::size_t at,
                            iec61850::Leaf const& leaf, char const* constraint, std::string const& id) {
        XMLElement* const e = set(add(parent, kind), {{"name", path[at]}});
        bool const last = at + 1 == path.size();
        std::string const b_type = last ? b_type_of(leaf) : "Struct";
        if (b_type.empty() || leaf.type == BasicType::bit_string || leaf.type == BasicType::octet_string ||
            leaf.type == BasicType::entry_time) {
            return fail(ExitCode::usage, fmt::format("is {}: SCL has no words for it", type_name(leaf.type)));
        }
        e->SetAttribute("bType", b_type.c_str());
        if (std::string_view{kind} == "DA") {
            e->SetAttribute("fc", constraint);
        }
        if (leaf.type == BasicType::enumerated && last) {
            e->SetAttribute("type", "AnyEnum");
        }
        if (last) {
            return {};
        }
        std::string const inner = id + "_" + path[at];
        e->SetAttribute("type", inner.c_str());
        return write_leaf(type(da_types_, "DAType", {{"id", inner}}), "BDA", path, at + 1, leaf, constraint, inner);
    }

    Result<void> write_structure(XMLElement* parent, char const* kind, DataNode const& node, char const* constraint,
                                 std::string const& id) {
        if (node.kind == DataNode::Kind::array) {
            return fail(ExitCode::usage, "is an array: SCL describes its elements, not a whole one");
        }
        for (DataNode const& member : node.members) {
            if (member.kind == DataNode::Kind::leaf) {
                if (auto ok = write_leaf(parent, kind, {identifier(member.name)}, 0, iec61850::leaves_of({{member}})[0],
                                         constraint, id);
                    !ok) {
                    return ok;
                }
                continue;
            }
            std::string const inner = id + "_" + identifier(member.name);
            XMLElement* const e =
                set(add(parent, kind), {{"name", identifier(member.name)}, {"bType", "Struct"}, {"type", inner}});
            if (std::string_view{kind} == "DA") {
                e->SetAttribute("fc", constraint);
            }
            if (auto ok = write_structure(type(da_types_, "DAType", {{"id", inner}}), "BDA", member, constraint, inner);
                !ok) {
                return ok;
            }
        }
        return {};
    }

    /// LLN0 and what every logical node has.
    void write_common_types() {
        XMLElement* const lln0 = type(ln_types_, "LNodeType", {{"id", "LLN0_type"}, {"lnClass", "LLN0"}});
        for (auto const& [name, id] :
             {std::pair{"Mod", "ENC_Mod"}, {"Beh", "ENS_Beh"}, {"Health", "ENS_Health"}, {"NamPlt", "LPL_NamPlt"}}) {
            set(add(lln0, "DO"), {{"name", name}, {"type", id}});
        }
        auto const state = [&](char const* id, char const* cdc, char const* kind) {
            XMLElement* const e = type(do_types_, "DOType", {{"id", id}, {"cdc", cdc}});
            set(add(e, "DA"), {{"name", "stVal"}, {"bType", "Enum"}, {"type", kind}, {"dchg", "true"}, {"fc", "ST"}});
            set(add(e, "DA"), {{"name", "q"}, {"bType", "Quality"}, {"qchg", "true"}, {"fc", "ST"}});
            set(add(e, "DA"), {{"name", "t"}, {"bType", "Timestamp"}, {"fc", "ST"}});
            return e;
        };
        set(add(state("ENC_Mod", "ENC", "BehaviourModeKind"), "DA"),
            {{"name", "ctlModel"}, {"bType", "Enum"}, {"type", "CtlModelKind"}, {"fc", "CF"}});
        state("ENS_Beh", "ENS", "BehaviourModeKind");
        state("ENS_Health", "ENS", "HealthKind");
        XMLElement* const plate = type(do_types_, "DOType", {{"id", "LPL_NamPlt"}, {"cdc", "LPL"}});
        for (char const* name : {"vendor", "swRev", "d", "configRev"}) {
            set(add(plate, "DA"), {{"name", name}, {"bType", "VisString255"}, {"fc", "DC"}});
        }
        auto const words = [&](char const* id, std::vector<std::pair<int, char const*>> const& values) {
            XMLElement* const e = type(enums_, "EnumType", {{"id", id}});
            for (auto const& [ord, word] : values) {
                set(add(e, "EnumVal"), {{"ord", std::to_string(ord)}})->SetText(word);
            }
        };
        words("BehaviourModeKind", {{1, "on"}, {2, "blocked"}, {3, "test"}, {4, "test/blocked"}, {5, "off"}});
        words("HealthKind", {{1, "Ok"}, {2, "Warning"}, {3, "Alarm"}});
        words("CtlModelKind", {{0, "status-only"}});
        words("AnyEnum", {{0, "0"}, {1, "1"}, {2, "2"}, {3, "3"}});
    }

    tinyxml2::XMLDocument document_;
    XMLElement* templates_{nullptr};
    XMLElement* ln_type_{nullptr}; ///< of the device that is being written
    std::vector<XMLElement*> ln_types_, do_types_, da_types_, enums_;
    std::map<std::string, int> counters_; ///< data objects by their name without number
};

} // namespace

Result<std::string> export_streams(std::vector<Stream> const& streams, std::string const& id) {
    return Exporter{}.run(streams, id);
}

} // namespace gridspace::scl
