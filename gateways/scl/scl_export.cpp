// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_export.hpp"

#include "common/text.hpp"
#include "gateways/scl/data_types.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::scl {
namespace {

using iec61850::BasicType;
using iec61850::DataNode;
using streams::Stream;
using tinyxml2::XMLElement;

/// The name of an attribute of a structure: the schema wants a small letter, then letters and digits, unless the
/// standard has it otherwise. No frame carries it.
std::string attribute_name(std::string const& name, std::set<std::string>& taken) {
    static std::set<std::string> const standard{"T", "Test", "Check", "SIUnit", "Oper", "SBO", "SBOw", "Cancel"};
    std::string out;
    for (std::size_t i = 0; i < name.size(); ++i) {
        auto const c = static_cast<unsigned char>(name[i]);
        bool const begins = i > 0 && std::isalnum(static_cast<unsigned char>(name[i - 1])) == 0;
        if (c < 0x80 && std::isalnum(c) != 0) {
            out += static_cast<char>(begins && !out.empty() ? std::toupper(c) : c);
        }
    }
    if (out.empty() || std::isdigit(static_cast<unsigned char>(out[0])) != 0) {
        out.insert(0, 1, 'x');
    }
    if (!standard.contains(out)) {
        out[0] = static_cast<char>(std::tolower(static_cast<unsigned char>(out[0])));
    }
    std::string unique = out;
    for (int n = 2; !taken.insert(unique).second; ++n) {
        unique = fmt::format("{}x{}", out, n);
    }
    return unique;
}

/// Writes elements into one document.
class Exporter {
  public:
    std::string run(std::vector<std::pair<Stream const*, Place>> const& streams, std::string const& id) {
        document_.InsertEndChild(document_.NewDeclaration());
        XMLElement* const root = document_.NewElement("SCL");
        document_.InsertEndChild(root);
        set(root,
            {{"xmlns", "http://www.iec.ch/61850/2003/SCL"}, {"version", "2007"}, {"revision", "B"}, {"release", "4"}});
        set(add(root, "Header"), {{"id", id}, {"nameStructure", "IEDName"}});
        XMLElement* const net = add(add(root, "Communication"), "SubNetwork");
        set(net, {{"name", "process_bus"}, {"type", "8-MMS"}});
        templates_ = document_.NewElement("DataTypeTemplates");
        std::map<std::string, Streams> ieds;
        for (auto const& one : streams) {
            ieds[one.second.ied].push_back(one);
        }
        write_common_types();
        for (auto const& [ied, own] : ieds) {
            write_addresses(net, ied, own);
            write_ied(root, ied, own);
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
        return printer.CStr();
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
                if (s->udp) {
                    iec61850::Ipv4 const& g = s->udp->group;
                    p("IP", fmt::format("{}.{}.{}.{}", g[0], g[1], g[2], g[3]));
                    p("IP-ClassOfTraffic", std::to_string(s->udp->dscp));
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

    void write_ied(XMLElement* root, std::string const& ied, Streams const& own) {
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
            std::set<std::string> sets; // streams that name the same one share it
            for (auto const& [s, place] : streams) {
                if (sets.insert(place.data_set).second) {
                    write_data_set(ln0, *s, place);
                }
            }
            write_control_blocks(ln0, streams);
            set(add(device, "LN"), {{"lnClass", "GGIO"}, {"inst", "1"}, {"lnType", ln_type}});
        }
    }

    void write_protocol(XMLElement* control, Stream const& s) {
        if (s.udp) {
            set(add(control, "Protocol"), {{"mustUnderstand", "true"}})
                ->SetText(s.kind == streams::Kind::goose ? "R-GOOSE" : "R-SV");
        }
    }

    void write_control_blocks(XMLElement* ln0, Streams const& streams) {
        for (auto const& [s, place] : streams) {
            if (s->kind == streams::Kind::goose) {
                XMLElement* const e = add(ln0, "GSEControl");
                set(e, {{"name", place.block},
                        {"datSet", place.data_set},
                        {"confRev", std::to_string(s->conf_rev)},
                        {"type", "GOOSE"},
                        {"appID", s->go_id.empty() ? s->control_block : s->go_id},
                        {"fixedOffs", s->integers == iec61850::IntegerForm::fixed ? "true" : "false"}});
                write_protocol(e, *s);
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
                                        {"dataSet", flag(!s->data_set_name.empty())},
                                        {"synchSourceId", flag(s->gm_identity.has_value())}});
                write_protocol(e, *s);
            }
        }
    }

    void write_data_set(XMLElement* ln0, Stream const& s, Place const& place) {
        XMLElement* const set_element = set(add(ln0, "DataSet"), {{"name", place.data_set}});
        for (DataNode const& member : s.data_set.members) {
            Reference const where = write_member(member);
            XMLElement* const fcda =
                set(add(set_element, "FCDA"),
                    {{"ldInst", place.inst}, {"lnClass", "GGIO"}, {"lnInst", "1"}, {"doName", where.object}});
            if (!where.attribute.empty()) {
                fcda->SetAttribute("daName", where.attribute.c_str());
            }
            fcda->SetAttribute("fc", where.constraint.c_str());
        }
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
        case BasicType::octet_string:
            return {"SPCSO", "SPC", "origin.orIdent", "ST"};
        default:
            return {"IntIn", "INS", "stVal", "ST"};
        }
    }

    /// A data object of its own for a member, with its type.
    Reference write_member(DataNode const& member) {
        Class const c = class_of(iec61850::leaves_of({{member}})[0].type);
        std::string const object = fmt::format("{}{}", c.object, ++counters_[c.object]);
        std::string const id = fmt::format("{}_{}", ln_type_->Attribute("id"), object);
        set(add(ln_type_, "DO"), {{"name", object}, {"type", id}, {"desc", member.name}});
        XMLElement* const definition = type(do_types_, "DOType", {{"id", id}, {"cdc", c.cdc}});
        if (member.kind == DataNode::Kind::structure) {
            write_members(definition, "DA", member, c.constraint, id);
            return {object, "", c.constraint};
        }
        bool const simple = member.kind == DataNode::Kind::leaf || member.members[0].kind == DataNode::Kind::leaf;
        std::string const path = simple ? c.attribute : "array";
        std::vector<std::string> const names = split(path, '.');
        DataNode node = member;
        node.name = names.back();
        for (std::size_t i = names.size() - 1; i-- > 0;) {
            node = DataNode{names[i], DataNode::Kind::structure, {}, 0, {std::move(node)}};
        }
        write_members(definition, "DA", {{}, DataNode::Kind::structure, {}, 0, {std::move(node)}}, c.constraint, id);
        return {object, path, c.constraint};
    }

    /// The members of a structure as attributes of `parent`, of the kind DA (of an object) or BDA (of an attribute).
    void write_members(XMLElement* parent, char const* kind, DataNode const& structure, char const* constraint,
                       std::string const& id) {
        std::set<std::string> taken;
        for (DataNode const& member : structure.members) {
            bool const array = member.kind == DataNode::Kind::array;
            DataNode const& node = array ? member.members[0] : member;
            std::string const name = attribute_name(member.name, taken);
            XMLElement* const e = set(add(parent, kind), {{"name", name}});
            if (name != member.name) {
                e->SetAttribute("desc", member.name.c_str());
            }
            if (node.kind == DataNode::Kind::leaf) {
                e->SetAttribute("bType", b_type_of(iec61850::leaves_of({{node}})[0]).c_str());
                if (node.type == BasicType::enumerated) {
                    e->SetAttribute("type", "AnyEnum");
                }
            } else {
                std::string const inner = fmt::format("{}_{}", id, name);
                set(e, {{"bType", "Struct"}, {"type", inner}});
                write_members(type(da_types_, "DAType", {{"id", inner}}), "BDA", node, constraint, inner);
            }
            if (array) {
                e->SetAttribute("count", std::to_string(member.members.size()).c_str());
            }
            if (std::string_view{kind} == "DA") {
                e->SetAttribute("fc", constraint);
            }
        }
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

Export export_streams(std::vector<Stream> const& streams, std::string const& id) {
    Placed placed = place_streams(streams);
    return {Exporter{}.run(placed.streams, id), std::move(placed.refused)};
}

} // namespace gridspace::scl
