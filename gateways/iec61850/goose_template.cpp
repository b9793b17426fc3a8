// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/iec61850/goose_template.hpp"

#include "gateways/iec61850/encode_error.hpp"
#include "gateways/iec61850/quality.hpp"

#include <algorithm>
#include <cassert>
#include <fmt/format.h>

namespace gridspace::iec61850 {
namespace {

/// A value of the leaf's type that takes the most octets.
Value longest_value(Leaf const& leaf, std::vector<std::uint8_t> const& text) {
    Value v;
    v.type = leaf.type;
    v.bits = is_signed(leaf.type) ? std::uint64_t{1} << (8 * integer_octets(leaf.type) - 1) : ~std::uint64_t{0};
    if (is_signed(leaf.type)) {
        v.bits = static_cast<std::uint64_t>(-static_cast<std::int64_t>(v.bits - 1) - 1);
    } else if (is_unsigned(leaf.type)) {
        v.bits = ~std::uint64_t{0} >> (64 - 8 * integer_octets(leaf.type));
    }
    v.bit_count = static_cast<std::uint8_t>(leaf.type == BasicType::bit_string ? leaf.length : 0);
    v.text = is_string(leaf.type) ? Octets{text}.first(leaf.length) : Octets{};
    return v;
}

std::size_t longest_members(std::vector<DataNode> const& members, std::vector<Leaf> const& leaves, std::size_t& leaf,
                            IntegerForm form, std::vector<std::uint8_t> const& text) {
    std::size_t sum = 0;
    for (DataNode const& member : members) {
        std::size_t const content = member.kind == DataNode::Kind::leaf
                                        ? data_content_octets(longest_value(leaves[leaf++], text), form)
                                        : longest_members(member.members, leaves, leaf, form, text);
        sum += element_octets(content);
    }
    return sum;
}

std::size_t depth_of(std::vector<DataNode> const& members) {
    std::size_t depth = 0;
    for (DataNode const& member : members) {
        if (member.kind != DataNode::Kind::leaf) {
            depth = std::max(depth, 1 + depth_of(member.members));
        }
    }
    return depth;
}

Result<void> check(GooseDescription const& d, std::vector<Leaf> const& leaves) {
    if (auto ok = check_visible("gocbRef", d.gocb_ref, GooseTemplate::kMaxReference); !ok) {
        return ok;
    }
    if (auto ok = check_visible("datSet", d.dat_set, GooseTemplate::kMaxReference); !ok) {
        return ok;
    }
    if (!d.go_id.empty()) {
        if (auto ok = check_visible("goID", d.go_id, GooseTemplate::kMaxReference); !ok) {
            return ok;
        }
    }
    if (leaves.empty()) {
        return unencodable(fmt::format("the data set of '{}' is empty", d.gocb_ref));
    }
    if (depth_of(d.data_set.members) > kMaxDepth) {
        return unencodable(
            fmt::format("the data set of '{}' is nested more than {} levels deep", d.gocb_ref, kMaxDepth));
    }
    for (Leaf const& leaf : leaves) {
        if (leaf.type == BasicType::bit_string && (leaf.length == 0 || leaf.length > 64)) {
            return unencodable(fmt::format("'{}' is a bit string of {} bits", leaf.name, leaf.length), "1 to 64");
        }
    }
    return {};
}

} // namespace

Result<GooseTemplate> GooseTemplate::create(Address const& address, GooseDescription const& description) {
    GooseTemplate out;
    out.description_ = description;
    out.leaves_ = leaves_of(description.data_set);
    if (auto ok = check(description, out.leaves_); !ok) {
        return std::unexpected{ok.error()};
    }
    std::uint32_t text_octets = 0;
    std::size_t longest_text = 0;
    for (Leaf const& leaf : out.leaves_) {
        Slot slot;
        slot.text_at = text_octets;
        slot.bit_count = static_cast<std::uint8_t>(leaf.type == BasicType::bit_string ? leaf.length : 0);
        if (is_string(leaf.type)) {
            text_octets += leaf.length;
            longest_text = std::max<std::size_t>(longest_text, leaf.length);
        }
        out.slots_.push_back(slot);
    }
    out.texts_.resize(text_octets);

    std::vector<std::uint8_t> const text(longest_text, 'x');
    std::size_t leaf = 0;
    std::size_t const data =
        longest_members(description.data_set.members, out.leaves_, leaf, description.integers, text);
    GooseState const longest{0xFFFFFFFF, 0xFFFFFFFF, 0xFFFFFFFF, {}, false, false};
    std::size_t const length = kHeaderOctets + element_octets(out.pdu_octets(longest, data));
    if (length > kMaxLength) {
        return unencodable(
            fmt::format("a message of '{}' could have {} octets behind the ethertype", description.gocb_ref, length),
            fmt::format("Ethernet carries {}: make the data set smaller", kMaxLength));
    }
    append_header(out.buffer_, address, kGooseEthertype);
    out.app_id_ = app_id_offset(address);
    out.buffer_.resize(out.app_id_ + length);
    return out;
}

std::optional<std::size_t> GooseTemplate::index_of(std::string_view leaf) const noexcept {
    auto const found = std::find_if(leaves_.begin(), leaves_.end(), [&](Leaf const& l) { return l.name == leaf; });
    if (found == leaves_.end()) {
        return std::nullopt;
    }
    return static_cast<std::size_t>(found - leaves_.begin());
}

Value GooseTemplate::get(std::size_t leaf) const noexcept {
    Slot const& slot = slots_[leaf];
    Value out{leaves_[leaf].type, slot.bit_count, slot.bits, {}};
    if (is_string(out.type)) {
        out.text = Octets{texts_}.subspan(slot.text_at, slot.text_octets);
    }
    return out;
}

GooseTemplate::Stored GooseTemplate::set(std::size_t leaf, Value const& value) noexcept {
    Leaf const& wanted = leaves_[leaf];
    Slot& slot = slots_[leaf];
    if (value.type != wanted.type) {
        return Stored::refused;
    }
    if (is_string(value.type)) {
        if (value.text.size() > wanted.length) {
            return Stored::refused;
        }
        if (std::ranges::equal(get(leaf).text, value.text)) {
            return Stored::same;
        }
        std::copy(value.text.begin(), value.text.end(), texts_.begin() + slot.text_at);
        slot.text_octets = static_cast<std::uint16_t>(value.text.size());
        slot.dirty = true;
        return Stored::changed;
    }
    if (is_integer(value.type) && value.type != BasicType::int64 && value.type != BasicType::uint64) {
        auto const width = static_cast<unsigned>(8 * integer_octets(value.type));
        std::int64_t const v = value.as_signed();
        std::int64_t const high =
            is_signed(value.type) ? (std::int64_t{1} << (width - 1)) - 1 : (std::int64_t{1} << width) - 1;
        if (v > high || v < (is_signed(value.type) ? -high - 1 : 0)) {
            return Stored::refused;
        }
    }
    constexpr std::uint64_t kQuality = (1U << quality::kBits) - 1;
    std::uint64_t const bits = value.type == BasicType::quality ? value.bits & ~std::uint64_t{quality::kDerived}
                                                                : value.bits; // of sampled values only
    std::uint64_t const mask = value.type == BasicType::boolean      ? 1
                               : value.type == BasicType::position   ? 3
                               : value.type == BasicType::quality    ? kQuality
                               : value.type == BasicType::bit_string ? ~std::uint64_t{0} >> (64 - slot.bit_count)
                                                                     : ~std::uint64_t{0};
    if ((bits & ~mask) != 0) {
        return Stored::refused;
    }
    if (slot.bits == bits) {
        return Stored::same;
    }
    slot.bits = bits;
    slot.dirty = true;
    return Stored::changed;
}

std::size_t GooseTemplate::unsigned_octets(std::uint32_t value) const noexcept {
    return description_.integers == IntegerForm::fixed ? 5 : minimal_unsigned_octets(value);
}

std::size_t GooseTemplate::pdu_octets(GooseState const& state, std::size_t data) const noexcept {
    auto const text = [](std::string const& t) { return t.empty() ? 0 : element_octets(t.size()); };
    return text(description_.gocb_ref) + 2 + unsigned_octets(state.live_ms) + text(description_.dat_set) +
           text(description_.go_id) + 10 + 2 + unsigned_octets(state.st_num) + 2 + unsigned_octets(state.sq_num) + 3 +
           2 + unsigned_octets(description_.conf_rev) + 3 + 2 +
           unsigned_octets(static_cast<std::uint32_t>(description_.data_set.members.size())) + element_octets(data);
}

std::size_t GooseTemplate::members_octets(std::vector<DataNode> const& members, std::size_t& leaf) const noexcept {
    std::size_t sum = 0;
    for (DataNode const& member : members) {
        if (member.kind == DataNode::Kind::leaf) {
            sum += element_octets(data_content_octets(get(leaf++), description_.integers));
        } else {
            sum += element_octets(members_octets(member.members, leaf));
        }
    }
    return sum;
}

void GooseTemplate::write_members(BerWriter& out, std::size_t start, std::vector<DataNode> const& members,
                                  std::size_t& leaf) noexcept {
    for (DataNode const& member : members) {
        if (member.kind == DataNode::Kind::leaf) {
            Slot& slot = slots_[leaf];
            Value const value = get(leaf++);
            slot.at = static_cast<std::uint32_t>(start + out.size());
            slot.content = static_cast<std::uint32_t>(data_content_octets(value, description_.integers));
            slot.dirty = false;
            write_data_value(out, value, description_.integers);
        } else {
            std::size_t ahead = leaf;
            out.head(member.kind == DataNode::Kind::structure ? 0xA2 : 0xA1, members_octets(member.members, ahead));
            write_members(out, start, member.members, leaf);
        }
    }
}

void GooseTemplate::write_all(GooseState const& state) noexcept {
    std::size_t leaf = 0;
    std::size_t const data = members_octets(description_.data_set.members, leaf);
    std::size_t const pdu = pdu_octets(state, data);
    std::size_t const start = app_id_ + kHeaderOctets;
    BerWriter w{std::span{buffer_}.subspan(start)};
    auto const number = [&](std::uint8_t tag, std::uint32_t value) {
        std::size_t const octets = unsigned_octets(value);
        w.head(tag, octets);
        Number const at{static_cast<std::uint32_t>(start + w.size()), static_cast<std::uint32_t>(octets)};
        w.integer(value, octets);
        return at;
    };
    auto const flag = [&](std::uint8_t tag, bool value) {
        w.head(tag, 1);
        auto const at = static_cast<std::uint32_t>(start + w.size());
        w.octet(value ? 1 : 0);
        return at;
    };
    w.head(0x61, pdu);
    w.element(0x80, octets_of(description_.gocb_ref));
    live_ = number(0x81, state.live_ms);
    w.element(0x82, octets_of(description_.dat_set));
    if (!description_.go_id.empty()) {
        w.element(0x83, octets_of(description_.go_id));
    }
    w.head(0x84, 8);
    t_at_ = static_cast<std::uint32_t>(start + w.size());
    w.integer(state.t.bits(), 8);
    st_num_ = number(0x85, state.st_num);
    sq_num_ = number(0x86, state.sq_num);
    simulation_at_ = flag(0x87, state.simulation);
    number(0x88, description_.conf_rev);
    nds_com_at_ = flag(0x89, state.nds_com);
    number(0x8A, static_cast<std::uint32_t>(description_.data_set.members.size()));
    w.head(0xAB, data);
    leaf = 0;
    write_members(w, start, description_.data_set.members, leaf);
    assert(w.ok()); // create() made room for the longest message
    size_ = start + w.size();
    store_be(buffer_.data() + app_id_ + 2, static_cast<std::uint16_t>(size_ - app_id_));
    written_ = true;
}

bool GooseTemplate::patchable(GooseState const& state) const noexcept {
    return written_ && unsigned_octets(state.live_ms) == live_.octets &&
           unsigned_octets(state.st_num) == st_num_.octets && unsigned_octets(state.sq_num) == sq_num_.octets && [&] {
               for (std::size_t i = 0; i < slots_.size(); ++i) {
                   if (slots_[i].dirty && data_content_octets(get(i), description_.integers) != slots_[i].content) {
                       return false;
                   }
               }
               return true;
           }();
}

void GooseTemplate::patch(GooseState const& state) noexcept {
    auto const number = [&](Number const& at, std::uint32_t value) {
        BerWriter{std::span{buffer_}.subspan(at.at, at.octets)}.integer(value, at.octets);
    };
    number(live_, state.live_ms);
    store_be(buffer_.data() + t_at_, state.t.bits());
    number(st_num_, state.st_num);
    number(sq_num_, state.sq_num);
    buffer_[simulation_at_] = state.simulation ? 1 : 0;
    buffer_[nds_com_at_] = state.nds_com ? 1 : 0;
    for (std::size_t i = 0; i < slots_.size(); ++i) {
        if (slots_[i].dirty) {
            BerWriter out{std::span{buffer_}.subspan(slots_[i].at, element_octets(slots_[i].content))};
            write_data_value(out, get(i), description_.integers);
            slots_[i].dirty = false;
        }
    }
}

Octets GooseTemplate::frame(GooseState const& state) noexcept {
    if (patchable(state)) {
        patch(state);
    } else {
        write_all(state);
    }
    std::uint16_t const reserved1 = state.simulation ? kSimulatedBit : std::uint16_t{0};
    store_be(buffer_.data() + app_id_ + 4, reserved1);
    return Octets{buffer_}.first(size_);
}

void GooseTemplate::set_source(Mac const& source) noexcept {
    std::copy(source.octets.begin(), source.octets.end(), buffer_.begin() + 6);
}

} // namespace gridspace::iec61850
