// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_import.hpp"

#include "common/text.hpp"
#include "gateways/scl/control_address.hpp"
#include "gateways/scl/control_settings.hpp"
#include "gateways/scl/data_types.hpp"
#include "gateways/streams/stream.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::scl {
namespace {

using config::Node;
using iec61850::DataNode;

Node data_node(DataNode const& node) {
    if (node.kind == DataNode::Kind::leaf) {
        Node type = Node::scalar(std::string{iec61850::type_name(node.type)});
        if (node.length == 0) {
            return type;
        }
        Node out = Node::map();
        out.set("type", type);
        out.set("length", Node::scalar(std::to_string(node.length)));
        return out;
    }
    Node out = Node::map();
    if (node.kind == DataNode::Kind::array) { // all members are alike
        out.set("array", data_node(node.members.front()));
        out.set("count", Node::scalar(std::to_string(node.members.size())));
        return out;
    }
    for (DataNode const& member : node.members) {
        out.set(member.name, data_node(member));
    }
    return out;
}

constexpr std::size_t kMostMembers = 1500; // a frame has no more octets

/// What one LN0 needs to know of its surroundings.
class Importer {
  public:
    Importer(Document const& document, ImportOptions const& options, Findings& findings)
        : document_{document}, options_{options}, findings_{findings}, settings_{findings, options.nominal_hz},
          types_{child(document.root(), "DataTypeTemplates")}, addresses_{document.root()} {}

    Result<Import> run() {
        out_.streams = Node::map();
        std::vector<std::string> names;
        std::map<std::string, Element const*> first;
        for (Element const* ied : children(document_.root(), "IED")) {
            std::string const name = attribute(*ied, "name");
            names.push_back(name);
            if (auto const [other, fresh] = first.try_emplace(name, ied); !fresh) {
                findings_.add(Finding::Kind::left_out, *ied, "name",
                              {name,
                               fmt::format("there are two IEDs '{}', the first in line {}: the second was left out",
                                           name, other->second->GetLineNum()),
                               "names of IEDs are unique"});
                continue;
            }
            if (options_.ieds.empty() ||
                std::find(options_.ieds.begin(), options_.ieds.end(), name) != options_.ieds.end()) {
                read_ied(*ied, name);
            }
        }
        for (std::string const& wanted : options_.ieds) {
            if (!first.contains(wanted)) {
                return fail(ExitCode::usage, fmt::format("there is no IED '{}' in the file", wanted),
                            spelling_hint(wanted, names));
            }
        }
        return std::move(out_);
    }

  private:
    void left_out(Element const& where, Element const& control, std::string text, std::string remedy = {}) {
        findings_.left_out(where, {subject_of(control), std::move(text), std::move(remedy)});
    }

    void read_ied(Element const& ied, std::string const& name) {
        for (Element const* point : children(ied, "AccessPoint")) {
            for (Element const* server : children(*point, "Server")) {
                for (Element const* device : children(*server, "LDevice")) {
                    if (Element const* ln0 = child(*device, "LN0")) {
                        read_ln0(*device, *ln0, name, attribute(*point, "name"));
                    }
                }
            }
        }
    }

    void read_ln0(Element const& device, Element const& ln0, std::string const& ied, std::string const& point) {
        std::string const inst = attribute(device, "inst");
        std::string const ld = attribute(device, "ldName", ied + inst);
        for (char const* kind : {"GSEControl", "SampledValueControl"}) {
            for (Element const* control : children(ln0, kind)) {
                ControlBlock block;
                block.ied = ied;
                block.ld_inst = inst;
                block.ld_name = ld;
                block.block = attribute(*control, "name");
                block.goose = local_name(*control) == "GSEControl";
                if (!read_control(device, ln0, *control, point, block)) {
                    out_.refused.push_back({ied, inst, block.block, document_.places().of(*control)});
                }
            }
        }
    }

    /// The logical node that an FCDA names.
    static Element const* ln_of(Element const& device, Element const& fcda) {
        std::string const cls = attribute(fcda, "lnClass"), inst = attribute(fcda, "lnInst"),
                          prefix = attribute(fcda, "prefix");
        for (Element const* ln : children(device, cls == "LLN0" ? "LN0" : "LN")) {
            if (cls == "LLN0" || (attribute(*ln, "lnClass") == cls && attribute(*ln, "inst") == inst &&
                                  attribute(*ln, "prefix") == prefix)) {
                return ln;
            }
        }
        return nullptr;
    }

    /// FCDAs may point into other logical devices of the same server.
    static Element const* device_of(Element const& own, std::string const& inst) {
        for (Element const* device : children(*own.Parent()->ToElement(), "LDevice")) {
            if (attribute(*device, "inst") == inst) {
                return device;
            }
        }
        return &own;
    }

    Result<DataNode> resolve(Element const& device, Element const& fcda, std::string const& ln_name,
                             MemberOrigin& origin) const {
        Element const* const ln = ln_of(*device_of(device, origin.ld_inst), fcda);
        if (ln == nullptr) {
            return fail(ExitCode::usage, fmt::format("there is no logical node '{}' in '{}'", ln_name, origin.ld_inst));
        }
        if (origin.object.empty()) {
            return fail(ExitCode::usage, fmt::format("a member of '{}' names no data object", ln_name));
        }
        auto const scale = types_.scale_of(*ln, origin.object);
        origin.scale = scale.factor;
        origin.offset = scale.offset;
        return types_.resolve({attribute(*ln, "lnType"), origin.object, origin.attribute, attribute(fcda, "fc"),
                               !attribute(fcda, "ix").empty()},
                              origin.name);
    }

    bool read_data_set(Element const& device, Element const& ln0, Element const& control, Node& stream,
                       ControlBlock& block) {
        std::string const wanted = attribute(control, "datSet");
        Element const* found = nullptr;
        std::vector<std::string> names;
        for (Element const* e : children(ln0, "DataSet")) {
            names.push_back(attribute(*e, "name"));
            found = names.back() == wanted ? e : found;
        }
        if (found == nullptr) {
            left_out(control, control,
                     fmt::format("control block '{}' has no data set '{}'; it was left out", block.block, wanted),
                     wanted.empty() ? "datSet: one of the DataSets of its LN0" : spelling_hint(wanted, names));
            return false;
        }
        auto const fcdas = children(*found, "FCDA");
        if (fcdas.size() > kMostMembers) {
            left_out(*found, control,
                     fmt::format("data set '{}' has {} members, more than a frame has octets; control block '{}' was "
                                 "left out",
                                 wanted, fcdas.size(), block.block));
            return false;
        }
        Node members = Node::map();
        for (Element const* fcda : fcdas) {
            MemberOrigin origin{{},
                                attribute(*fcda, "ldInst"),
                                attribute(*fcda, "prefix"),
                                attribute(*fcda, "lnClass"),
                                attribute(*fcda, "lnInst"),
                                attribute(*fcda, "doName"),
                                attribute(*fcda, "daName")};
            std::string const ln = origin.prefix + origin.ln_class + origin.ln_inst, index = attribute(*fcda, "ix");
            std::string name = ln + "_" + origin.object + (origin.attribute.empty() ? "" : "_" + origin.attribute) +
                               (index.empty() ? "" : "_" + index);
            std::replace(name.begin(), name.end(), '.', '_');
            for (int n = 2; members.find(name) != nullptr; ++n) { // the same name in two logical devices
                name = fmt::format("{}_{}", name, n);
            }
            origin.name = name;
            auto const node = resolve(device, *fcda, ln, origin);
            if (!node) {
                left_out(*fcda, control,
                         fmt::format("{}; control block '{}' was left out", describe(node.error()), block.block));
                return false;
            }
            members.set(name, data_node(*node));
            block.members.push_back(std::move(origin));
        }
        if (members.entries.empty()) {
            left_out(*found, control,
                     fmt::format("data set '{}' is empty; control block '{}' was left out", wanted, block.block));
            return false;
        }
        stream.set("data_set", std::move(members));
        return true;
    }

    /// Whether it can be used as it was read: a name that the wire does not carry, a frame that is too long.
    bool is_usable(Element const& control, Node const& stream) {
        Node one = Node::map();
        one.set("stream", stream);
        config::Diagnostics diagnostics;
        (void)streams::read_streams(one, diagnostics);
        for (auto const& problem : diagnostics.sorted()) {
            if (problem.severity == config::Severity::error) {
                left_out(control, control,
                         fmt::format("control block '{}' was left out: {}{}", attribute(control, "name"),
                                     problem.message, problem.hint.empty() ? "" : " (" + problem.hint + ")"));
                return false;
            }
        }
        return true;
    }

    bool read_control(Element const& device, Element const& ln0, Element const& control, std::string const& point,
                      ControlBlock& block) {
        if (block.goose && attribute(control, "type", "GOOSE") != "GOOSE") {
            left_out(control, control, fmt::format("control block '{}' is GSSE; it was left out", block.block),
                     "type=\"GOOSE\"");
            return false;
        }
        Node stream = Node::map();
        stream.set("kind", Node::scalar(block.goose ? "goose" : "smv"));
        Element const* const where =
            addresses_.find({block.ied, point, block.ld_inst, block.block}, block.goose ? "GSE" : "SMV");
        if (!settings_.read_address(control, where, stream)) {
            return false;
        }
        stream.set("conf_rev", Node::scalar(settings_.attribute_or(control, "confRev", "1")));
        settings_.note_of_protection(control);
        std::string const data_set = block.ld_name + "/LLN0$" + attribute(control, "datSet");
        if (block.goose) {
            stream.set("control_block", Node::scalar(block.ld_name + "/LLN0$GO$" + block.block));
            stream.set("data_set_name", Node::scalar(data_set));
            if (std::string const id = attribute(control, "appID"); !id.empty()) {
                stream.set("go_id", Node::quoted_text(id));
            }
            settings_.read_times(*where, stream);
            if (is_true(attribute(control, "fixedOffs"))) {
                stream.set("integers", Node::scalar("fixed"));
            }
        } else if (!settings_.read_sampling(control, data_set, stream)) {
            return false;
        }
        if (!read_data_set(device, ln0, control, stream, block) || !is_usable(control, stream)) {
            return false;
        }
        note_of_likeness(control, *where, block, stream);
        block.where = document_.places().of(control);
        block.stream = add(block.ied + "_" + block.block, std::move(stream));
        out_.blocks.push_back(std::move(block));
        return true;
    }

    /// Two streams that a receiver cannot tell apart by what is in their frames, or that share what should be theirs.
    void note_of_likeness(Element const& control, Element const& address, ControlBlock const& block,
                          Node const& stream) {
        std::string const name = block.ied + ' ' + block.block;
        std::string const destination = destination_of(stream);
        std::string identity = destination + ' ';
        for (char const* key : {"app_id", "sv_id", "control_block"}) {
            if (Node const* const part = stream.find(key)) {
                identity += part->text + ' ';
            }
        }
        std::string const id = block.goose ? "gocbRef" : "svID";
        if (auto const [like, added] = by_identity_.try_emplace(identity, name); !added) {
            findings_.doubtful(control, {name,
                                         fmt::format("control block '{}' has the MAC address, the APPID and the {} of "
                                                     "'{}': a receiver cannot tell them apart",
                                                     name, id, like->second),
                                         "another MAC address, APPID or name for one of them"});
            return;
        }
        std::string const app_id = stream.find("app_id")->text;
        bool const default_id = app_id == "0x4000" || app_id == "0x0000"; // everybody may have these
        auto const [same_id, id_is_new] = by_app_id_.try_emplace(app_id, name);
        auto const [same_mac, mac_is_new] = by_mac_.try_emplace(destination, name);
        if (!id_is_new && !default_id) {
            findings_.doubtful(address, {name,
                                         fmt::format("control block '{}' has the APPID {}, which '{}' has too", name,
                                                     app_id, same_id->second),
                                         "an APPID is unique in a system (IEC 61850-8-1, annex C)"});
        } else if (!mac_is_new) {
            findings_.doubtful(address, {name,
                                         fmt::format("control block '{}' has the {} {}, which '{}' has too", name,
                                                     stream.find("udp") != nullptr ? "group" : "MAC address",
                                                     destination, same_mac->second),
                                         "an address of its own lets switches and ports keep it from who does not want "
                                         "it"});
        }
    }

    /// By a name that may be a key.
    std::string add(std::string name, Node stream) {
        std::replace_if(
            name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
        if (std::isdigit(static_cast<unsigned char>(name.front())) != 0) {
            name.insert(0, 1, '_');
        }
        std::string unique = name;
        for (int n = 2; !names_.insert(unique).second; ++n) {
            unique = fmt::format("{}_{}", name, n);
        }
        out_.streams.entries.push_back({unique, {}, std::move(stream)});
        return unique;
    }

    Document const& document_;
    ImportOptions options_;
    Findings& findings_;
    ControlSettings settings_;
    DataTypes types_;
    Addresses addresses_;
    std::map<std::string, std::string> by_identity_, by_mac_, by_app_id_; ///< the control block that was first
    std::set<std::string> names_;
    Import out_;
};

} // namespace

std::string destination_of(Node const& stream) {
    if (Node const* const udp = stream.find("udp")) {
        return udp->find("group")->text;
    }
    return stream.find("mac")->text;
}

Result<Import> import_streams(Document const& document, ImportOptions const& options, Findings& findings) {
    check_root(document, findings);
    return Importer{document, options, findings}.run();
}

void keep_findings(Findings const& findings, Import& out) {
    for (Finding const& one : findings.all()) {
        out.notes.push_back(fmt::format("line {}: {}", one.where.line, one.text));
    }
    out.findings = findings.all();
    out.findings_dropped = findings.dropped();
}

Result<Import> import_streams(std::string const& text, std::string const& name, ImportOptions const& options) {
    auto const document = Document::parse(text, name);
    if (!document) {
        return std::unexpected{document.error()};
    }
    Findings findings{document->places()};
    auto out = import_streams(*document, options, findings);
    if (out) {
        keep_findings(findings, *out);
    }
    return out;
}

} // namespace gridspace::scl
