// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/record_reader.hpp"

#include <algorithm>

namespace gridspace::mapping {
namespace {

/// Two's complement of so many octets as 64 bits.
std::uint64_t extended(std::uint64_t bits, std::uint32_t octets) noexcept {
    unsigned const shift = 64 - 8 * octets;
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(bits << shift) >> shift);
}

} // namespace

bool RecordReader::read(std::span<std::byte const> cdr, std::span<Value> values) noexcept {
    elements_ = given_ = 0;
    // Encapsulation: 00 00 big endian, 00 01 little endian; two octets of options.
    if (cdr.size() < 4 || cdr[0] != std::byte{0} || cdr[1] > std::byte{1}) {
        return false;
    }
    little_ = cdr[1] == std::byte{1};
    data_ = cdr.subspan(4);
    at_ = steps_ = 0;
    each_ = nullptr;
    return walk(type_.root(), 0, values);
}

bool RecordReader::next(std::span<Value> values) noexcept {
    if (given_ >= elements_ || each_ == nullptr) {
        return false;
    }
    at_ = each_at_;
    bool const ok = walk(each_->children.front(), each_->first_field, values); // read() has been here: it fits
    each_at_ = at_;
    ++given_;
    return ok;
}

bool RecordReader::walk(RecordType::Node const& node, std::uint32_t field, std::span<Value> values) noexcept {
    using Shape = RecordType::Shape;
    // Elements without content cost no octets: they must not be walked for ever.
    if (++steps_ > 65'536 + 32 * data_.size()) {
        return false;
    }
    switch (node.shape) {
    case Shape::leaf:
        return leaf(node, field, values);
    case Shape::structure:
        for (RecordType::Node const& member : node.children) {
            bool const named = field != RecordType::kNone;
            if (!walk(member, named ? field + member.first_field - node.first_field : RecordType::kNone, values)) {
                return false;
            }
        }
        return true;
    case Shape::array:
        for (std::uint32_t i = 0; i < node.bound; ++i) {
            if (!walk(node.children.front(), field == RecordType::kNone ? RecordType::kNone : field + i * node.stride,
                      values)) {
                return false;
            }
        }
        return true;
    case Shape::sequence:
        return sequence(node, field, values);
    }
    return false;
}

bool RecordReader::sequence(RecordType::Node const& node, std::uint32_t field, std::span<Value> values) noexcept {
    std::uint64_t length = 0;
    if (!raw(4, length) || (node.bound != 0 && length > node.bound) || length > data_.size()) {
        return false;
    }
    if (node.children.empty()) {
        return length == 0;
    }
    if (node.is_each && field != RecordType::kNone) {
        each_ = &node;
        each_at_ = at_;
        elements_ = static_cast<std::size_t>(length);
    }
    for (std::uint64_t i = 0; i < length; ++i) {
        bool const named = field != RecordType::kNone && !node.is_each && i < node.slots;
        if (!walk(node.children.front(),
                  named ? field + static_cast<std::uint32_t>(i) * node.stride : RecordType::kNone, values)) {
            return false;
        }
    }
    if (field != RecordType::kNone && !node.is_each) {
        for (std::uint64_t i = length; i < node.slots; ++i) {
            clear(field + static_cast<std::uint32_t>(i) * node.stride, node.stride, values);
        }
    }
    return true;
}

void RecordReader::clear(std::uint32_t first, std::uint32_t count, std::span<Value> values) noexcept {
    for (std::uint32_t f = first; f < first + count; ++f) {
        values[f] = {type_.fields()[f].type, 0, 0, {}};
    }
}

bool RecordReader::raw(std::uint32_t octets, std::uint64_t& bits) noexcept {
    at_ = (at_ + octets - 1) / octets * octets;
    if (at_ + octets > data_.size()) {
        return false;
    }
    bits = 0;
    for (std::uint32_t i = 0; i < octets; ++i) {
        auto const octet = static_cast<std::uint64_t>(data_[at_ + i]);
        bits |= octet << 8 * (little_ ? i : octets - 1 - i);
    }
    at_ += octets;
    return true;
}

bool RecordReader::leaf(RecordType::Node const& node, std::uint32_t field, std::span<Value> values) noexcept {
    std::uint64_t bits = 0;
    std::uint32_t const octets = cdr_octets(node.kind);
    if (!raw(octets, bits)) {
        return false;
    }
    if (node.kind == idl::Kind::string) { // the length counts the terminating NUL
        std::size_t const size = static_cast<std::size_t>(bits);
        if (size == 0 || size > data_.size() - at_ || (node.bound != 0 && size - 1 > node.bound)) {
            return false;
        }
        if (field != RecordType::kNone) {
            auto const* text = reinterpret_cast<std::uint8_t const*>(data_.data() + at_);
            values[field] = {BasicType::visible_string, 0, 0, {text, size - 1}};
        }
        at_ += size;
        return true;
    }
    if (field != RecordType::kNone) {
        BasicType const type = basic_type(node.kind);
        if (type == BasicType::boolean) {
            bits = bits != 0 ? 1 : 0;
        } else if (iec61850::is_signed(type)) {
            bits = extended(bits, octets);
        }
        values[field] = {type, 0, bits, {}};
    }
    return true;
}

} // namespace gridspace::mapping
