// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/station.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <set>

namespace gridspace::scl {
namespace {

/// What an ExtRef asks for.
struct Wanted {
    std::string ied, ld, prefix, ln_class, ln_inst, object, attribute;
    std::string service, block, block_ld;
    [[nodiscard]] std::string text() const {
        std::string out = fmt::format("{}{}/{}{}{}.{}", ied, ld, prefix, ln_class, ln_inst, object);
        return attribute.empty() ? out : out + "." + attribute;
    }
};

bool is_part(std::string const& whole, std::string const& part) {
    return whole.empty() || whole == part || (part.starts_with(whole) && part[whole.size()] == '.');
}

/// Whether a member of a data set brings it: as a whole, as a part, or in what is asked for.
bool brings(MemberOrigin const& m, Wanted const& w) {
    bool const same_node = m.ld_inst == w.ld && m.prefix == w.prefix && m.ln_class == w.ln_class &&
                           (m.ln_inst == w.ln_inst || m.ln_class == "LLN0");
    // "A.phsA" with "cVal.mag.f" and "A" with "phsA.cVal.mag.f" are the same
    std::string const member = m.attribute.empty() ? m.object : m.object + "." + m.attribute,
                      asked = w.attribute.empty() ? w.object : w.object + "." + w.attribute;
    return same_node && (is_part(member, asked) || is_part(asked, member));
}

class Reader {
  public:
    Reader(Document const& document, Findings& findings, Station& out)
        : document_{document}, findings_{findings}, out_{out} {
        for (std::size_t i = 0; i < out.import.blocks.size(); ++i) {
            ControlBlock const& block = out.import.blocks[i];
            by_ied_[block.ied].push_back(i);
            by_reference_[block.ld_name + "/" + block.block] = i;
        }
    }

    void run() {
        std::set<std::string> seen;
        for (Element const* ied : children(document_.root(), "IED")) {
            std::string const name = attribute(*ied, "name");
            if (!seen.insert(name).second) {
                continue; // said already
            }
            out_.ieds.push_back(
                {name, attribute(*ied, "manufacturer"), attribute(*ied, "type"), document_.places().of(*ied)});
        }
        for (Element const* ied : children(document_.root(), "IED")) {
            if (seen.erase(attribute(*ied, "name")) != 0) {
                read_ied(*ied);
            }
        }
    }

  private:
    void read_ied(Element const& ied) {
        ied_ = attribute(ied, "name");
        heard_.clear();
        for (Element const* point : children(ied, "AccessPoint")) {
            for (Element const* server : children(*point, "Server")) {
                for (Element const* device : children(*server, "LDevice")) {
                    read_device(*device);
                }
            }
            for (Element const* ln : children(*point, "LN")) { // a client without a server
                read_inputs(*ln);
            }
        }
        for (auto& [block, subscription] : heard_) {
            std::vector<std::string> ordered;
            for (MemberOrigin const& m : out_.import.blocks[block].members) {
                if (std::find(subscription.members.begin(), subscription.members.end(), m.name) !=
                    subscription.members.end()) {
                    ordered.push_back(m.name);
                }
            }
            subscription.members = std::move(ordered);
            out_.subscriptions.push_back(std::move(subscription));
        }
    }

    void read_device(Element const& device) {
        for (char const* kind : {"LN0", "LN"}) {
            for (Element const* ln : children(device, kind)) {
                read_inputs(*ln);
                std::string const cls = attribute(*ln, "lnClass");
                if (cls == "LGOS" || cls == "LSVS") {
                    read_supervision(*ln, attribute(device, "inst"), cls == "LGOS");
                }
            }
        }
    }

    void read_inputs(Element const& ln) {
        for (Element const* inputs : children(ln, "Inputs")) {
            for (Element const* ref : children(*inputs, "ExtRef")) {
                read_reference(*ref);
            }
        }
    }

    void left_out(Element const& where, char const* at, std::string text, std::string remedy = {}) {
        findings_.add(Finding::Kind::left_out, where, at, {ied_, std::move(text), std::move(remedy)});
    }

    void read_reference(Element const& ref) {
        Wanted const w{attribute(ref, "iedName"),  attribute(ref, "ldInst"),      attribute(ref, "prefix"),
                       attribute(ref, "lnClass"),  attribute(ref, "lnInst"),      attribute(ref, "doName"),
                       attribute(ref, "daName"),   attribute(ref, "serviceType"), attribute(ref, "srcCBName"),
                       attribute(ref, "srcLDInst")};
        if (w.ied.empty()) { // later binding (Ed. 2.1): an input that is bound to nothing yet
            std::string const input = attribute(ref, "intAddr", attribute(ref, "desc"));
            findings_.add(Finding::Kind::left_out, ref, nullptr,
                          {ied_, fmt::format("the input '{}' is bound to nothing (an ExtRef without iedName)", input),
                           "bind it in the engineering tool, or leave it as it is"});
            return;
        }
        if (w.ied == "@" || w.ied == ied_) {
            return; // within the device
        }
        if (w.service == "Report" || w.service == "Poll") {
            left_out(ref, "serviceType", fmt::format("'{}' comes by {}: MMS is not played", w.text(), w.service));
            return;
        }
        auto const publisher = by_ied_.find(w.ied);
        if (publisher == by_ied_.end() && tell_refused(ref, w)) {
            return;
        }
        if (publisher == by_ied_.end()) {
            std::vector<std::string> names;
            bool known = false;
            for (Ied const& ied : out_.ieds) {
                names.push_back(ied.name);
                known = known || ied.name == w.ied;
            }
            left_out(ref, "iedName",
                     known
                         ? fmt::format("'{}' is asked of IED '{}', which has no usable control block", w.text(), w.ied)
                         : fmt::format("'{}' is asked of IED '{}', which is not in the file", w.text(), w.ied),
                     known ? "" : spelling_hint(w.ied, names));
            return;
        }
        bind(ref, w, publisher->second);
    }

    /// Whether it comes with a control block that was left out; then that is said.
    bool tell_refused(Element const& ref, Wanted const& w) {
        auto const& refused = out_.import.refused;
        auto const found = std::find_if(refused.begin(), refused.end(), [&](RefusedBlock const& r) {
            return r.ied == w.ied && !w.block.empty() && r.block == w.block &&
                   (w.block_ld.empty() || r.ld_inst == w.block_ld);
        });
        if (found == refused.end()) {
            return false;
        }
        left_out(ref, "srcCBName",
                 fmt::format("'{}' comes with control block '{}', which was left out (line {})", w.text(), w.block,
                             found->where.line));
        return true;
    }

    void bind(Element const& ref, Wanted const& w, std::vector<std::size_t> const& blocks) {
        std::vector<std::string> names;
        std::size_t matches = 0;
        bool named = false;
        for (std::size_t const i : blocks) {
            ControlBlock const& block = out_.import.blocks[i];
            names.push_back(block.block);
            if ((w.service == "GOOSE" && !block.goose) || (w.service == "SMV" && block.goose) ||
                (!w.block.empty() &&
                 (block.block != w.block || (!w.block_ld.empty() && block.ld_inst != w.block_ld)))) {
                continue;
            }
            named = true;
            if (w.object.empty() && !w.block.empty()) { // the whole message
                ++matches;
                ++hear(i, {}).ext_refs;
                continue;
            }
            for (MemberOrigin const& member : block.members) { // of a whole object each of its attributes
                if (brings(member, w)) {
                    ++matches;
                    hear(i, member.name);
                }
            }
            if (matches > 0) {
                ++heard_[i].ext_refs;
                break; // without srcCBName the first that brings it, as it stands in the file
            }
        }
        if (matches > 0) {
            return;
        }
        if (tell_refused(ref, w)) {
            return;
        }
        if (!named && !w.block.empty()) {
            left_out(ref, "srcCBName",
                     fmt::format("IED '{}' has no control block '{}' that sends '{}'", w.ied, w.block, w.text()),
                     spelling_hint(w.block, names));
        } else {
            left_out(ref, "doName",
                     fmt::format("no data set of {} of IED '{}' has '{}'",
                                 w.block.empty() ? "a control block" : fmt::format("control block '{}'", w.block),
                                 w.ied, w.text()),
                     "an FCDA with the same ldInst, prefix, lnClass, lnInst and doName");
        }
    }

    StreamSubscription& hear(std::size_t block, std::string const& member) {
        StreamSubscription& out = heard_[block];
        out.ied = ied_;
        out.block = block;
        if (!member.empty() && std::find(out.members.begin(), out.members.end(), member) == out.members.end()) {
            out.members.push_back(member);
        }
        return out;
    }

    /// LGOS.GoCBRef and LSVS.SvCBRef: "LDNAME/LLN0.block", and as some tools write it "LDNAME/LLN0$GO$block".
    void read_supervision(Element const& ln, std::string const& ld, bool goose) {
        std::string const name =
            fmt::format("{}/{}{}{}", ld, attribute(ln, "prefix"), goose ? "LGOS" : "LSVS", attribute(ln, "inst"));
        for (Element const* object : children(ln, "DOI")) {
            if (attribute(*object, "name") != (goose ? "GoCBRef" : "SvCBRef")) {
                continue;
            }
            for (Element const* a : children(*object, "DAI")) {
                Element const* const value = child(*a, "Val");
                std::string const text = value == nullptr ? "" : text_of(*value);
                if (attribute(*a, "name") != "setSrcRef" || text.empty()) {
                    continue;
                }
                std::size_t const slash = text.find('/'), last = text.find_last_of(".$");
                auto const found = slash == std::string::npos || last == std::string::npos || last < slash
                                       ? by_reference_.end()
                                       : by_reference_.find(text.substr(0, slash + 1) + text.substr(last + 1));
                if (found == by_reference_.end() || out_.import.blocks[found->second].goose != goose) {
                    left_out(*value, nullptr,
                             fmt::format("{} supervises '{}', which is no usable {} control block of the file", name,
                                         text, goose ? "GOOSE" : "SMV"),
                             "LDNAME/LLN0.NAME of a control block");
                    continue;
                }
                hear(found->second, {}).supervisor = name;
            }
        }
    }

    Document const& document_;
    Findings& findings_;
    Station& out_;
    std::string ied_;
    std::map<std::string, std::vector<std::size_t>> by_ied_;
    std::map<std::string, std::size_t> by_reference_; ///< "LDNAME/block"
    std::map<std::size_t, StreamSubscription> heard_; ///< of the IED, by block
};

} // namespace

Result<Station> read_station(Document const& document, double nominal_hz) {
    Findings findings{document.places()};
    Station out;
    auto import = import_streams(document, {{}, nominal_hz}, findings);
    if (!import) {
        return std::unexpected{import.error()};
    }
    out.import = std::move(*import);
    Reader{document, findings, out}.run();
    keep_findings(findings, out.import);
    return out;
}

} // namespace gridspace::scl
