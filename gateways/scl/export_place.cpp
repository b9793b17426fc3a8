// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/scl/export_place.hpp"

#include "gateways/scl/data_types.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <optional>

namespace gridspace::scl {
namespace {

using iec61850::BasicType;
using iec61850::DataNode;
using streams::Kind;
using streams::Stream;

// By the schema: names of control blocks and of data sets; of logical devices and of IEDs.
constexpr std::size_t kLongestName = 32, kLongestDevice = 64;

bool is_letter(char c) {
    return (c >= 'A' && c <= 'Z') || (c >= 'a' && c <= 'z');
}
bool is_digit(char c) {
    return c >= '0' && c <= '9';
}

bool is_name(std::string_view text, std::size_t longest) {
    return !text.empty() && text.size() <= longest && is_letter(text[0]) &&
           std::all_of(text.begin(), text.end(), [](char c) { return is_letter(c) || is_digit(c) || c == '_'; });
}

/// A device name for what no frame carries.
std::string made_up_device(std::string text) {
    std::replace_if(text.begin(), text.end(), [](char c) { return !is_letter(c) && !is_digit(c); }, '_');
    text = text.empty() || !is_letter(text[0]) ? "S" + text : text;
    return text.substr(0, kLongestDevice - 4) + "LD0";
}

/// "IED2LD0" is device LD0 of IED2; another name is a functional one, of an IED called so. Its `inst` differs from all
/// of the first kind: IED2 and IED2LD0 are two devices of one IED.
void place_device(std::string const& ld, Place& out) {
    std::size_t const at = ld.rfind("LD");
    bool const usual = at != std::string::npos && at > 0 && at + 2 < ld.size() &&
                       std::all_of(ld.begin() + static_cast<std::ptrdiff_t>(at) + 2, ld.end(), is_digit);
    out.ied = usual ? ld.substr(0, at) : ld;
    out.inst = usual ? ld.substr(at) : "LD";
    out.ld_name = usual ? "" : ld;
}

struct Parts {
    std::string device, name;
};

/// The two names of a reference `DEVICE/LLN0$…$NAME`: SCL keeps control blocks of streams, and their data sets, in
/// LLN0.
Result<Parts> parts_of(std::string const& key, std::string const& reference, std::string const& middle) {
    std::size_t const at = reference.find(middle);
    Parts out;
    if (at != std::string::npos) {
        out = {reference.substr(0, at), reference.substr(at + middle.size())};
    }
    if (at == std::string::npos || !is_name(out.device, kLongestDevice) || !is_name(out.name, kLongestName)) {
        return fail(
            ExitCode::usage, fmt::format("SCL cannot say its {} '{}'", key, reference),
            fmt::format("expected DEVICE{}NAME: a letter, then letters, digits and _, at most {} and {} characters",
                        middle, kLongestDevice, kLongestName));
    }
    return out;
}

Result<Place> place_of(Stream const& s, std::size_t number) {
    Place out;
    std::string device;
    if (s.kind == Kind::goose) {
        auto block = parts_of("control_block", s.control_block, "/LLN0$GO$");
        if (!block) {
            return std::unexpected{block.error()};
        }
        device = block->device;
        out.block = block->name;
    }
    if (s.data_set_name.empty()) { // of sampled values only, which do not send it then
        device = made_up_device(s.sv_id);
        out.data_set = is_name(s.name.name, kLongestName) ? s.name.name : fmt::format("DataSet{:02}", number);
    } else {
        auto set = parts_of("data_set_name", s.data_set_name, "/LLN0$");
        if (!set) {
            return std::unexpected{set.error()};
        }
        if (s.kind == Kind::goose && set->device != device) {
            return fail(ExitCode::usage,
                        fmt::format("its data_set_name '{}' is of another device than its control_block '{}'",
                                    s.data_set_name, s.control_block),
                        fmt::format("SCL keeps both in one: {}/LLN0${}", device, set->name));
        }
        device = set->device;
        out.data_set = set->name;
    }
    place_device(device, out);
    return out;
}

/// Why SCL has no words for a basic value; empty when it has.
std::string problem_of_leaf(DataNode const& leaf) {
    auto const filled_in = iec61850::leaves_of({{leaf}})[0];
    if (!b_type_of(filled_in).empty()) {
        return "";
    }
    if (leaf.type == BasicType::bit_string) {
        return fmt::format("a bit_string of {} bits: SCL knows them with 2 (Check) and 10 (OptFlds)", filled_in.length);
    }
    if (leaf.type == BasicType::octet_string) {
        return fmt::format("an octet_string of {} octets: SCL knows them up to 64 (Octet64)", filled_in.length);
    }
    return fmt::format("{}, which is no type of SCL", type_name(leaf.type));
}

/// Why SCL has no words for a member, or for what is in it; empty when it has.
std::string problem_of(DataNode const& node) {
    if (node.kind == DataNode::Kind::leaf) {
        return problem_of_leaf(node);
    }
    if (node.kind == DataNode::Kind::array) {
        DataNode const& first = node.members.front();
        if (first.kind == DataNode::Kind::array) {
            return "an array of arrays, which SCL does not know";
        }
        if (std::any_of(node.members.begin(), node.members.end(), [&](DataNode const& m) { return m != first; })) {
            return "an array of different types: in SCL all elements are of one";
        }
        return problem_of(first);
    }
    for (DataNode const& member : node.members) {
        if (std::string problem = problem_of(member); !problem.empty()) {
            return problem;
        }
    }
    return "";
}

std::optional<Error> problem_of(Stream const& s) {
    for (DataNode const& member : s.data_set.members) {
        if (std::string const problem = problem_of(member); !problem.empty()) {
            return Error{ExitCode::usage, fmt::format("its member '{}' is or holds {}", member.name, problem), ""};
        }
    }
    return std::nullopt;
}

/// Streams of a device whose names are the same: one control block twice, or two data sets of one name.
class Names {
  public:
    std::optional<Error> take(Stream const& s, Place const& place) {
        std::string const device = place.ld_name.empty() ? place.ied + place.inst : place.ld_name;
        auto const block = blocks_.find({device, place.block});
        if (s.kind == Kind::goose && block != blocks_.end()) {
            return Error{
                ExitCode::usage,
                fmt::format("stream '{}' has the same control_block '{}'", block->second->name.name, s.control_block),
                "a control block has one address: another `control_block` for one of them"};
        }
        auto const set = sets_.find({device, place.data_set});
        if (set != sets_.end() && set->second->data_set != s.data_set) {
            return Error{ExitCode::usage,
                         fmt::format("streams '{}' and '{}' call different data sets '{}' in {}",
                                     set->second->name.name, s.name.name, place.data_set, device),
                         "another `data_set_name`, or the same `data_set`, for one of them"};
        }
        if (s.kind == Kind::goose) {
            blocks_[{device, place.block}] = &s;
        }
        sets_.try_emplace({device, place.data_set}, &s);
        return std::nullopt;
    }

  private:
    std::map<std::pair<std::string, std::string>, Stream const*> blocks_, sets_;
};

} // namespace

Placed place_streams(std::vector<Stream> const& streams) {
    Placed out;
    Names names;
    std::map<std::string, int> blocks; ///< of sampled values, by device
    std::size_t number = 0;
    for (Stream const& s : streams) {
        auto place = place_of(s, ++number);
        if (place && s.kind == Kind::smv) { // no frame carries it: of each device its own, so that the order of streams
                                            // does not matter
            place->block = fmt::format("MSVCB{:02}", ++blocks[place->ied + "/" + place->inst]);
        }
        std::optional<Error> problem = place ? problem_of(s) : std::optional{place.error()};
        if (!problem) {
            problem = names.take(s, *place);
        }
        if (problem) {
            out.refused.push_back({s.name, std::move(*problem)});
        } else {
            out.streams.emplace_back(&s, std::move(*place));
        }
    }
    return out;
}

} // namespace gridspace::scl
