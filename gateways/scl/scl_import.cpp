// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/scl_import.hpp"

#include "common/text.hpp"
#include "gateways/scl/control_address.hpp"
#include "gateways/scl/data_types.hpp"
#include "gateways/streams/stream.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>

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

constexpr unsigned kLargestVlan = 0xFFE;
constexpr double kNoRatePerPeriod = 1000; // nobody samples a period so often: smpMod was forgotten

/// xs:boolean.
bool is_true(std::string const& text) {
    return text == "true" || text == "1";
}

bool is_vlan_priority(std::string const& text) {
    return text.size() == 1 && text[0] >= '0' && text[0] <= '7';
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

    /// An attribute, or what stands in for one that is not given.
    std::string attribute_or(Element const& control, char const* name, char const* fallback) {
        std::string value = attribute(control, name);
        if (value.empty()) {
            note(control, fmt::format("control block '{}' has no {}: {} is assumed", attribute(control, "name"), name,
                                      fallback));
            value = fallback;
        }
        return value;
    }

    void note_of_protection(Element const& control) {
        std::string const wanted = attribute(control, "securityEnable", "None");
        if (wanted != "None") {
            note(control,
                 fmt::format("control block '{}' has securityEnable {}: streams are neither signed nor encrypted",
                             attribute(control, "name"), wanted));
        }
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
        auto const mac = mac_of(p["MAC-Address"]);
        bool const goose = local_name(control) == "GSEControl";
        auto const app_id = p["APPID"].empty() ? std::optional{goose ? 0U : 0x4000U} : hexadecimal(p["APPID"]);
        if (!mac || !app_id) {
            note(control, fmt::format("control block '{}' has the MAC address '{}' and APPID '{}'; it was left out",
                                      attribute(control, "name"), p["MAC-Address"], p["APPID"]));
            return false;
        }
        stream.set("mac", Node::quoted_text(mac->to_string()));
        stream.set("app_id", Node::scalar(fmt::format("0x{:04X}", *app_id)));
        if (p["APPID"].empty()) {
            note(*address, fmt::format("control block '{}' has no APPID: the standard's default 0x{:04X}",
                                       attribute(control, "name"), *app_id));
        }
        if (auto const vlan = hexadecimal(p["VLAN-ID"]); vlan && *vlan <= kLargestVlan) {
            stream.set("vlan_id", Node::scalar(std::to_string(*vlan)));
        } else if (!p["VLAN-ID"].empty()) {
            note(*address, fmt::format("control block '{}' has the VLAN-ID '{}', which is none; it was left away",
                                       attribute(control, "name"), p["VLAN-ID"]));
        }
        if (std::string const& priority = p["VLAN-PRIORITY"]; is_vlan_priority(priority)) {
            stream.set("vlan_priority", Node::scalar(priority));
        } else if (!priority.empty()) {
            note(*address, fmt::format("control block '{}' has the VLAN-PRIORITY '{}', which is none (0 to 7); the "
                                       "default is used",
                                       attribute(control, "name"), priority));
        }
        return true;
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
    Element const* device_of(Element const& own, std::string const& inst) const {
        for (Element const* device : children(*own.Parent()->ToElement(), "LDevice")) {
            if (attribute(*device, "inst") == inst) {
                return device;
            }
        }
        return &own;
    }

    Result<DataNode> resolve(Element const& device, Element const& fcda, std::string const& ln_name,
                             std::string const& name) const {
        std::string const inst = attribute(fcda, "ldInst"), object = attribute(fcda, "doName");
        Element const* const ln = ln_of(*device_of(device, inst), fcda);
        if (ln == nullptr) {
            return fail(ExitCode::usage, fmt::format("there is no logical node '{}' in '{}'", ln_name, inst));
        }
        if (object.empty()) {
            return fail(ExitCode::usage, fmt::format("a member of '{}' names no data object", ln_name));
        }
        return types_.resolve({attribute(*ln, "lnType"), object, attribute(fcda, "daName"), attribute(fcda, "fc"),
                               !attribute(fcda, "ix").empty()},
                              name);
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
        Node members = Node::map();
        for (Element const* fcda : children(*found, "FCDA")) {
            std::string const ln =
                attribute(*fcda, "prefix") + attribute(*fcda, "lnClass") + attribute(*fcda, "lnInst");
            std::string const object = attribute(*fcda, "doName"), path = attribute(*fcda, "daName"),
                              index = attribute(*fcda, "ix");
            std::string name =
                ln + "_" + object + (path.empty() ? "" : "_" + path) + (index.empty() ? "" : "_" + index);
            std::replace(name.begin(), name.end(), '.', '_');
            for (int n = 2; members.find(name) != nullptr; ++n) { // the same name in two logical devices
                name = fmt::format("{}_{}", name, n);
            }
            auto const node = resolve(device, *fcda, ln, name);
            if (!node) {
                note(*fcda, fmt::format("{}; control block '{}' was left out", describe(node.error()),
                                        attribute(control, "name")));
                return false;
            }
            members.set(name, data_node(*node));
        }
        if (members.entries.empty()) {
            note(*found, fmt::format("data set '{}' is empty; control block '{}' was left out", wanted,
                                     attribute(control, "name")));
            return false;
        }
        stream.set("data_set", std::move(members));
        return true;
    }

    /// A time below a millisecond: frames cannot say one in timeAllowedToLive.
    void note_of_times(Element const& time, double ms) {
        constexpr double kShortest = 1, kPerSecond = 1000;
        if (ms < kShortest) {
            note(time,
                 fmt::format("{} {} of '{}' is taken as {} ms, because SCL counts milliseconds; were seconds meant, "
                             "it is {} ms",
                             local_name(time), text_of(time), attribute(*time.Parent()->ToElement(), "cbName"),
                             shortest(ms), shortest(ms * kPerSecond)));
        }
    }

    /// MinTime and MaxTime, unless they are nonsense: then the defaults are better than no stream.
    void read_times(Element const& where, Node& stream) {
        std::map<std::string, double> times;
        for (char const* name : {"MinTime", "MaxTime"}) {
            if (Element const* const e = child(where, name)) {
                auto const ms = config::number_of(Node::scalar(text_of(*e)));
                if (!ms || *ms <= 0 || (times.contains("MinTime") && *ms < times["MinTime"])) {
                    note(*e, fmt::format("'{}' is no {} of '{}'; the default is used", text_of(*e), name,
                                         attribute(where, "cbName")));
                    continue;
                }
                note_of_times(*e, *ms);
                times[name] = *ms;
            }
        }
        if (times.contains("MinTime") && !times.contains("MaxTime")) { // the default could be shorter
            times["MaxTime"] = std::max(times["MinTime"], streams::GooseTiming{}.max_time_ms);
        }
        if (times.contains("MaxTime") && !times.contains("MinTime")) {
            times["MinTime"] = std::min(times["MaxTime"], streams::GooseTiming{}.min_time_ms);
        }
        for (auto const& [name, key] : {std::pair{"MinTime", "min_time_ms"}, {"MaxTime", "max_time_ms"}}) {
            if (times.contains(name)) {
                stream.set(key, Node::scalar(shortest(times[name])));
            }
        }
    }

    /// Whether it can be used as it was read: a name that the wire does not carry, a frame that is too long.
    bool is_usable(Element const& control, Node const& stream) {
        Node one = Node::map();
        one.set("stream", stream);
        config::Diagnostics diagnostics;
        (void)streams::read_streams(one, diagnostics);
        for (auto const& problem : diagnostics.sorted()) {
            if (problem.severity == config::Severity::error) {
                note(control, fmt::format("control block '{}' was left out: {}{}", attribute(control, "name"),
                                          problem.message, problem.hint.empty() ? "" : " (" + problem.hint + ")"));
                return false;
            }
        }
        return true;
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
        Element const* const where = find_address(root_, {ied, point, inst, block}, goose ? "GSE" : "SMV");
        if (!read_address(control, where, stream)) {
            return;
        }
        stream.set("conf_rev", Node::scalar(attribute_or(control, "confRev", "1")));
        note_of_protection(control);
        std::string const data_set = ld + "/LLN0$" + attribute(control, "datSet");
        if (goose) {
            stream.set("control_block", Node::scalar(ld + "/LLN0$GO$" + block));
            stream.set("data_set_name", Node::scalar(data_set));
            if (std::string const id = attribute(control, "appID"); !id.empty()) {
                stream.set("go_id", Node::quoted_text(id));
            }
            read_times(*where, stream);
            if (is_true(attribute(control, "fixedOffs"))) {
                stream.set("integers", Node::scalar("fixed"));
            }
        } else if (!read_sampling(control, data_set, stream)) {
            return;
        }
        if (read_data_set(device, ln0, control, stream) && is_usable(control, stream)) {
            note_of_likeness(control, ied + ' ' + block, stream);
            add(ied + "_" + block, std::move(stream));
        }
    }

    /// Two streams that a receiver cannot tell apart by what is in their frames.
    void note_of_likeness(Element const& control, std::string const& name, Node const& stream) {
        std::string identity;
        for (char const* key : {"mac", "app_id", "sv_id", "control_block"}) {
            if (Node const* const part = stream.find(key)) {
                identity += part->text + ' ';
            }
        }
        if (auto const [like, added] = by_identity_.try_emplace(identity, name); !added) {
            note(control, fmt::format("control block '{}' has the MAC address, the APPID and the {} of '{}': a "
                                      "receiver cannot tell them apart",
                                      name, stream.find("sv_id") != nullptr ? "svID" : "gocbRef", like->second));
        }
    }

    /// By a name that may be a key.
    void add(std::string name, Node stream) {
        std::replace_if(
            name.begin(), name.end(), [](char c) { return std::isalnum(static_cast<unsigned char>(c)) == 0; }, '_');
        if (std::isdigit(static_cast<unsigned char>(name.front())) != 0) {
            name.insert(0, 1, '_');
        }
        std::string unique = name;
        for (int n = 2; out_.streams.find(unique) != nullptr; ++n) {
            unique = fmt::format("{}_{}", name, n);
        }
        out_.streams.set(unique, std::move(stream));
    }

    bool read_sampling(Element const& control, std::string const& data_set, Node& stream) {
        stream.set("sv_id", Node::quoted_text(attribute(control, "smvID")));
        double const count = control.DoubleAttribute("smpRate", 0);
        std::string mode = attribute(control, "smpMod", "SmpPerPeriod");
        if (count >= kNoRatePerPeriod && mode == "SmpPerPeriod") {
            note(control, fmt::format("control block '{}' has smpRate {}, which is taken as samples per second",
                                      attribute(control, "name"), count));
            mode = "SmpPerSec";
        }
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
        stream.set("samples_per_frame", Node::scalar(attribute_or(control, "nofASDU", "1")));
        if (Element const* const options = child(control, "SmvOpts")) {
            read_options(control, *options, data_set, stream);
            if (mode == "SmpPerPeriod" && is_true(attribute(*options, "sampleRate"))) {
                note(*options,
                     fmt::format("control block '{}' sends smpRate {} and smpMod 0 (samples per period); a stream "
                                 "with send_smp_rate sends {} and 1 (samples per second)",
                                 attribute(control, "name"), count, shortest(rate)));
            }
        }
        return true;
    }

    /// The optional fields of a frame.
    void read_options(Element const& control, Element const& options, std::string const& data_set, Node& stream) {
        auto const has = [&](char const* name) { return is_true(attribute(options, name)); };
        if (has("dataSet")) {
            stream.set("data_set_name", Node::scalar(data_set));
        }
        if (has("refreshTime")) {
            stream.set("send_refr_tm", Node::scalar("true"));
        }
        if (has("sampleRate")) {
            stream.set("send_smp_rate", Node::scalar("true"));
        }
        if (has("synchSourceId")) {
            note(options,
                 fmt::format("control block '{}' sends the identity of its clock (synchSourceId), which SCL does "
                             "not hold: a publisher needs gm_identity",
                             attribute(control, "name")));
        }
        for (char const* name : {"security", "timestamp"}) {
            if (has(name)) {
                note(options, fmt::format("control block '{}' has the option {}, which streams do not send",
                                          attribute(control, "name"), name));
            }
        }
    }

    Element const& root_;
    ImportOptions options_;
    DataTypes types_;
    std::map<std::string, std::string> by_identity_; ///< the control block that was first
    Import out_;
};

} // namespace

Result<Import> import_streams(std::string const& text, std::string const& name, ImportOptions const& options) {
    if (text.starts_with("\xFF\xFE") || text.starts_with("\xFE\xFF")) {
        return fail(ExitCode::usage, fmt::format("{}: the file is UTF-16", name),
                    "convert it: iconv -f UTF-16 -t UTF-8");
    }
    tinyxml2::XMLDocument document;
    if (document.Parse(text.data(), text.size()) != tinyxml2::XML_SUCCESS) {
        return fail(ExitCode::usage,
                    fmt::format("{}:{}: not XML: {}", name, document.ErrorLineNum(), document.ErrorName()),
                    "expected an SCD, ICD or CID file");
    }
    Element const* const root = document.RootElement();
    if (root == nullptr || local_name(*root) != "SCL") {
        return fail(ExitCode::usage, fmt::format("{}: the root element is '{}', not SCL", name,
                                                 root == nullptr ? "nothing" : root->Name()));
    }
    return Importer{*root, options}.run();
}

} // namespace gridspace::scl
