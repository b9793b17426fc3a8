// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_import.hpp"

#include "common/text.hpp"
#include "gateways/iec61850/frame.hpp"
#include "gateways/scl/data_types.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <map>

namespace gridspace::scl {
namespace {

using config::Node;
using iec61850::DataNode;

Node data_node(DataNode const& node) {
    if (node.kind == DataNode::Kind::leaf) {
        Node const type = Node::scalar(std::string{iec61850::type_name(node.type)});
        if (node.length == 0) {
            return type;
        }
        Node out = Node::map();
        out.set("type", type);
        out.set("length", Node::scalar(std::to_string(node.length)));
        return out;
    }
    Node out = Node::map();
    for (DataNode const& member : node.members) {
        out.set(member.name, data_node(member));
    }
    return out;
}

std::optional<unsigned> hex(std::string const& text) {
    unsigned value = 0;
    auto const [end, ec] = std::from_chars(text.data(), text.data() + text.size(), value, 16);
    return ec == std::errc{} && end == text.data() + text.size() ? std::optional{value} : std::nullopt;
}

/// What one LN0 needs to know of its surroundings.
class Importer {
  public:
    Importer(Element const& root, ImportOptions const& options)
        : root_{root}, options_{options}, types_{child(root, "DataTypeTemplates")} {}

    Result<Import> run() {
        out_.streams = Node::map();
        std::vector<std::string> names;
        for (Element const* ied : children(root_, "IED")) {
            std::string const name = attribute(*ied, "name");
            names.push_back(name);
            if (options_.ied.empty() || name == options_.ied) {
                read_ied(*ied, name);
            }
        }
        if (!options_.ied.empty() && std::find(names.begin(), names.end(), options_.ied) == names.end()) {
            return fail(ExitCode::usage, fmt::format("there is no IED '{}' in the file", options_.ied),
                        spelling_hint(options_.ied, names));
        }
        return std::move(out_);
    }

  private:
    void note(Element const& where, std::string text) {
        out_.notes.push_back(fmt::format("line {}: {}", where.GetLineNum(), text));
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
                read_control(device, ln0, *control, ied, point, ld, inst);
            }
        }
    }

    /// GSE or SMV of the section Communication.
    Element const* address_of(std::string const& ied, std::string const& point, char const* kind,
                              std::string const& inst, std::string const& block) const {
        Element const* const communication = child(root_, "Communication");
        for (Element const* net :
             communication == nullptr ? std::vector<Element const*>{} : children(*communication, "SubNetwork")) {
            for (Element const* connected : children(*net, "ConnectedAP")) {
                if (attribute(*connected, "iedName") != ied || attribute(*connected, "apName") != point) {
                    continue;
                }
                for (Element const* e : children(*connected, kind)) {
                    if (attribute(*e, "ldInst") == inst && attribute(*e, "cbName") == block) {
                        return e;
                    }
                }
            }
        }
        return nullptr;
    }

    bool read_address(Element const& control, Element const* where, Node& stream) {
        Element const* const address = where == nullptr ? nullptr : child(*where, "Address");
        if (address == nullptr) {
            note(control, fmt::format("control block '{}' has no address under Communication; it was left out",
                                      attribute(control, "name")));
            return false;
        }
        std::map<std::string, std::string> p;
        for (Element const* e : children(*address, "P")) {
            p[attribute(*e, "type")] = text_of(*e);
        }
        auto const mac = iec61850::Mac::parse(p["MAC-Address"]);
        auto const app_id = hex(p["APPID"]);
        if (!mac || !app_id) {
            note(control, fmt::format("control block '{}' has the MAC address '{}' and APPID '{}'; it was left out",
                                      attribute(control, "name"), p["MAC-Address"], p["APPID"]));
            return false;
        }
        stream.set("mac", Node::quoted_text(mac->to_string()));
        stream.set("app_id", Node::scalar(fmt::format("0x{:04X}", *app_id)));
        if (auto const vlan = hex(p["VLAN-ID"])) {
            stream.set("vlan_id", Node::scalar(std::to_string(*vlan)));
        }
        if (!p["VLAN-PRIORITY"].empty()) {
            stream.set("vlan_priority", Node::scalar(p["VLAN-PRIORITY"]));
        }
        return true;
    }

    /// The type of the logical node that an FCDA names.
    std::string ln_type(Element const& device, Element const& fcda) const {
        std::string const cls = attribute(fcda, "lnClass"), inst = attribute(fcda, "lnInst"),
                          prefix = attribute(fcda, "prefix");
        for (Element const* ln : children(device, cls == "LLN0" ? "LN0" : "LN")) {
            if (cls == "LLN0" || (attribute(*ln, "lnClass") == cls && attribute(*ln, "inst") == inst &&
                                  attribute(*ln, "prefix") == prefix)) {
                return attribute(*ln, "lnType");
            }
        }
        return {};
    }

    /// FCDAs may point into other logical devices of the same server.
    Element const* device_of(Element const& own, std::string const& inst) const {
        for (Element const* device : children(*own.Parent()->ToElement(), "LDevice")) {
            if (attribute(*device, "inst") == inst) {
                return device;
            }
        }
        return &own;
    }

    bool read_data_set(Element const& device, Element const& ln0, Element const& control, Node& stream) {
        std::string const wanted = attribute(control, "datSet");
        Element const* found = nullptr;
        for (Element const* e : children(ln0, "DataSet")) {
            found = attribute(*e, "name") == wanted ? e : found;
        }
        if (found == nullptr) {
            note(control, fmt::format("control block '{}' has no data set '{}'; it was left out",
                                      attribute(control, "name"), wanted));
            return false;
        }
        bool const sampled = local_name(control) == "SampledValueControl";
        Node members = Node::map();
        for (Element const* fcda : children(*found, "FCDA")) {
            std::string const object = attribute(*fcda, "doName"), path = attribute(*fcda, "daName");
            std::string name = attribute(*fcda, "prefix") + attribute(*fcda, "lnClass") + attribute(*fcda, "lnInst") +
                               "_" + object + (path.empty() ? "" : "_" + path);
            std::replace(name.begin(), name.end(), '.', '_');
            for (int n = 2; members.find(name) != nullptr; ++n) { // the same name in two logical devices
                name = fmt::format("{}_{}", name, n);
            }
            auto const node = types_.resolve(ln_type(*device_of(device, attribute(*fcda, "ldInst")), *fcda), object,
                                             path, attribute(*fcda, "fc"), name);
            if (!node) {
                note(*fcda, fmt::format("{}; control block '{}' was left out", describe(node.error()),
                                        attribute(control, "name")));
                return false;
            }
            members.set(name, data_node(*node));
        }
        (void)sampled; // structures are flattened on the wire of sampled values: the leaves are the same
        stream.set("data_set", std::move(members));
        return true;
    }

    static std::string milliseconds(Element const& where, char const* name) {
        Element const* const e = child(where, name);
        return e == nullptr ? "" : text_of(*e);
    }

    void read_control(Element const& device, Element const& ln0, Element const& control, std::string const& ied,
                      std::string const& point, std::string const& ld, std::string const& inst) {
        bool const goose = local_name(control) == "GSEControl";
        std::string const block = attribute(control, "name");
        if (goose && attribute(control, "type", "GOOSE") != "GOOSE") {
            note(control, fmt::format("control block '{}' is GSSE; it was left out", block));
            return;
        }
        Node stream = Node::map();
        stream.set("kind", Node::scalar(goose ? "goose" : "smv"));
        Element const* const where = address_of(ied, point, goose ? "GSE" : "SMV", inst, block);
        if (!read_address(control, where, stream)) {
            return;
        }
        stream.set("conf_rev", Node::scalar(attribute(control, "confRev", "1")));
        std::string const data_set = ld + "/LLN0$" + attribute(control, "datSet");
        if (goose) {
            stream.set("control_block", Node::scalar(ld + "/LLN0$GO$" + block));
            stream.set("data_set_name", Node::scalar(data_set));
            if (std::string const id = attribute(control, "appID"); !id.empty()) {
                stream.set("go_id", Node::scalar(id));
            }
            for (auto const& [element, key] : {std::pair{"MinTime", "min_time_ms"}, {"MaxTime", "max_time_ms"}}) {
                if (std::string const ms = milliseconds(*where, element); !ms.empty()) {
                    stream.set(key, Node::scalar(ms));
                }
            }
            if (attribute(control, "fixedOffs") == "true") {
                stream.set("integers", Node::scalar("fixed"));
            }
        } else if (!read_sampling(control, data_set, stream)) {
            return;
        }
        if (read_data_set(device, ln0, control, stream)) {
            std::string name = ied + "_" + block;
            std::replace_if(
                name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
            for (int n = 2; out_.streams.find(name) != nullptr; ++n) {
                name = fmt::format("{}_{}_{}", ied, block, n);
            }
            out_.streams.set(name, std::move(stream));
        }
    }

    bool read_sampling(Element const& control, std::string const& data_set, Node& stream) {
        stream.set("sv_id", Node::scalar(attribute(control, "smvID")));
        double const count = control.DoubleAttribute("smpRate", 0);
        std::string const mode = attribute(control, "smpMod", "SmpPerPeriod");
        double const rate = mode == "SmpPerPeriod" ? count * options_.nominal_hz : count;
        if (mode == "SecPerSmp" || rate < 1) {
            note(control, fmt::format("control block '{}' has {} {}; it was left out", attribute(control, "name"), mode,
                                      attribute(control, "smpRate")));
            return false;
        }
        if (mode == "SmpPerPeriod") {
            note(control,
                 fmt::format("control block '{}' has {} samples per period: {} Hz, because the nominal frequency is {} "
                             "Hz (--nominal-hz)",
                             attribute(control, "name"), count, shortest(rate), shortest(options_.nominal_hz)));
        }
        stream.set("rate_hz", Node::scalar(shortest(rate)));
        stream.set("samples_per_frame", Node::scalar(attribute(control, "nofASDU", "1")));
        if (Element const* const options = child(control, "SmvOpts")) {
            if (attribute(*options, "dataSet") == "true") {
                stream.set("data_set_name", Node::scalar(data_set));
            }
            if (attribute(*options, "refreshTime") == "true") {
                stream.set("send_refr_tm", Node::scalar("true"));
            }
            if (attribute(*options, "sampleRate") == "true") {
                stream.set("send_smp_rate", Node::scalar("true"));
            }
        }
        return true;
    }

    Element const& root_;
    ImportOptions options_;
    DataTypes types_;
    Import out_;
};

} // namespace

Result<Import> import_streams(std::string const& text, std::string const& name, ImportOptions const& options) {
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        return fail(ExitCode::usage,
                    fmt::format("{}:{}: not XML: {}", name, document.ErrorLineNum(), document.ErrorName()));
    }
    Element const* const root = document.RootElement();
    if (root == nullptr || local_name(*root) != "SCL") {
        return fail(ExitCode::usage, fmt::format("{}: the root element is '{}', not SCL", name,
                                                 root == nullptr ? "nothing" : root->Name()));
    }
    return Importer{*root, options}.run();
}

} // namespace gridspace::scl
