// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/mapping/record_writer.hpp"

#include <algorithm>
#include <array>
#include <cstring>

namespace gridspace::mapping {
namespace {

constexpr std::size_t kKeyOctets = 16;

std::size_t text_octets(RecordType::Node const& node) {
    return node.bound == 0 ? RecordType::kTextOctets : std::min<std::size_t>(node.bound, RecordType::kTextOctets);
}

/// Octets of the longest key, aligned as it stands, as the rule of the key hash counts them.
std::size_t key_end(RecordType::Node const& node, std::size_t at) {
    using Shape = RecordType::Shape;
    if (node.shape == Shape::leaf) {
        if (!node.is_key) {
            return at;
        }
        std::size_t const octets = cdr_octets(node.kind);
        at = (at + octets - 1) / octets * octets + octets;
        return node.kind == idl::Kind::string ? at + (node.bound == 0 ? kKeyOctets : node.bound) + 1 : at;
    }
    std::size_t repeats = 1;
    if (node.shape == Shape::array) {
        repeats = node.bound;
    } else if (node.shape == Shape::sequence && node.is_key) {
        at = (at + 3) / 4 * 4 + 4;
        repeats = node.bound == 0 ? kKeyOctets : node.bound;
    }
    for (std::size_t i = 0; i < repeats && at <= kKeyOctets; ++i) {
        for (RecordType::Node const& child : node.children) {
            at = key_end(child, at);
        }
    }
    return at;
}

} // namespace

RecordWriter::RecordWriter(RecordType const& type, std::vector<std::size_t> const& used, std::size_t elements)
    : type_{type}, values_(type.fields().size()), last_used_(type.fields().size() + 1),
      capacity_{type.each_bound() == 0 ? elements : std::min<std::size_t>(elements, type.each_bound())} {
    std::vector<bool> is_used(values_.size());
    for (std::size_t const field : used) {
        is_used[field] = true;
    }
    for (std::size_t f = 0; f < values_.size(); ++f) {
        last_used_[f + 1] = is_used[f] ? static_cast<std::uint32_t>(f + 1) : last_used_[f];
        values_[f].type = type.fields()[f].type;
        if (auto const& names = type.enumerators(f); !names.empty()) {
            values_[f] = Value::integer(BasicType::enumerated, names.front().second);
        }
    }
    element_values_.resize(capacity_ * type.each_fields());
    buffer_.resize(4 + largest(type.root(), 0));
    key_is_short_ = key_end(type.root(), 0) <= kKeyOctets;
}

std::uint32_t RecordWriter::length_of(RecordType::Node const& node, std::uint32_t field) const noexcept {
    if (node.shape == RecordType::Shape::array) {
        return node.bound;
    }
    std::uint32_t const last = last_used_[field + node.slots * node.stride]; // plus 1
    return node.stride == 0 || last <= field ? 0 : (last - 1 - field) / node.stride + 1;
}

std::size_t RecordWriter::largest(RecordType::Node const& node, std::uint32_t field) const {
    using Shape = RecordType::Shape;
    if (node.shape == Shape::leaf) {
        return 2 * cdr_octets(node.kind) - 1 + (node.kind == idl::Kind::string ? text_octets(node) + 1 : 0);
    }
    std::size_t octets = node.shape == Shape::sequence ? 7 : 0;
    if (node.shape == Shape::structure) {
        for (RecordType::Node const& member : node.children) {
            octets += largest(member, field + member.first_field - node.first_field);
        }
        return octets;
    }
    if (node.is_each) {
        return octets + (node.children.empty() ? 0 : capacity_ * largest(node.children.front(), field));
    }
    for (std::uint32_t i = 0; i < length_of(node, field); ++i) {
        octets += largest(node.children.front(), field + i * node.stride);
    }
    return octets;
}

bool RecordWriter::append() noexcept {
    if (elements_ == capacity_) {
        return false;
    }
    auto const first = values_.begin() + type_.first_each_field();
    std::copy(first, first + type_.each_fields(),
              element_values_.begin() + static_cast<std::ptrdiff_t>(elements_ * type_.each_fields()));
    ++elements_;
    return true;
}

std::span<std::byte const> RecordWriter::write() noexcept {
    only_key_ = false;
    little_ = true;
    constexpr std::array kHeader{std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}};
    std::copy(kHeader.begin(), kHeader.end(), buffer_.begin());
    start_ = at_ = kHeader.size();
    walk(type_.root(), 0);
    return {buffer_.data(), at_};
}

std::span<std::byte const> RecordWriter::write_key() noexcept {
    only_key_ = true;
    little_ = false;
    start_ = at_ = 0;
    walk(type_.root(), 0);
    return {buffer_.data(), at_};
}

void RecordWriter::walk(RecordType::Node const& node, std::uint32_t field) noexcept {
    using Shape = RecordType::Shape;
    if (node.shape == Shape::leaf) {
        if (!only_key_ || node.is_key) {
            leaf(node, values_[field]);
        }
        return;
    }
    if (node.shape == Shape::structure) {
        for (RecordType::Node const& member : node.children) {
            walk(member, field + member.first_field - node.first_field);
        }
        return;
    }
    if (node.is_each) {
        if (only_key_ && !node.is_key) {
            return;
        }
        number(elements_, 4);
        for (std::size_t i = 0; i < elements_; ++i) {
            auto const kept = element_values_.begin() + static_cast<std::ptrdiff_t>(i * type_.each_fields());
            std::copy(kept, kept + type_.each_fields(), values_.begin() + field);
            walk(node.children.front(), field);
        }
        return;
    }
    std::uint32_t const length = length_of(node, field);
    if (node.shape == Shape::sequence && (!only_key_ || node.is_key)) {
        number(length, 4);
    }
    for (std::uint32_t i = 0; i < length; ++i) {
        walk(node.children.front(), field + i * node.stride);
    }
}

void RecordWriter::leaf(RecordType::Node const& node, Value const& value) noexcept {
    if (node.kind != idl::Kind::string) {
        number(value.bits, cdr_octets(node.kind));
        return;
    }
    std::size_t const size = std::min(value.text.size(), text_octets(node));
    number(size + 1, 4);
    if (size > 0) {
        std::memcpy(buffer_.data() + at_, value.text.data(), size);
    }
    buffer_[at_ + size] = std::byte{0};
    at_ += size + 1;
}

void RecordWriter::number(std::uint64_t bits, std::uint32_t octets) noexcept {
    while ((at_ - start_) % octets != 0) {
        buffer_[at_++] = std::byte{0};
    }
    for (std::uint32_t i = 0; i < octets; ++i) {
        buffer_[at_++] = static_cast<std::byte>(bits >> 8 * (little_ ? i : octets - 1 - i));
    }
}

} // namespace gridspace::mapping
