// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/native_sample.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

namespace gridspace::idl {
namespace {

constexpr std::size_t kHeader = 4; ///< octets of the encapsulation, from behind which alignment counts
static_assert(std::endian::native == std::endian::little);

template <class T>
T value_at(void const* at) {
    T value;
    std::memcpy(&value, at, sizeof value);
    return value;
}

std::byte const* advanced(void const* at, std::size_t by) {
    return static_cast<std::byte const*>(at) + by;
}

class Decoder {
  public:
    Decoder(NativeLayout const& layout, std::span<std::byte const> cdr, std::pmr::memory_resource& memory)
        : layout_{layout}, data_{cdr.subspan(kHeader)}, swaps_{cdr[1] == std::byte{0}}, memory_{memory} {}

    bool read(std::size_t index, std::byte* out) {
        Type const& type = layout_.model().types[index];
        switch (type.kind) {
        case Kind::structure:
            for (std::size_t i = 0; i < type.members.size(); ++i) {
                if (!read(type.members[i].type, out + layout_.place(index).offsets[i])) {
                    return false;
                }
            }
            return true;
        case Kind::array:
            return items(type.element, type.bound, out);
        case Kind::sequence:
            return sequence(type, out);
        case Kind::string:
            return text(type, out);
        case Kind::boolean:
            if (!number(out, 1)) {
                return false;
            }
            *out = *out == std::byte{0} ? std::byte{0} : std::byte{1};
            return true;
        case Kind::enumeration: {
            std::int32_t value = 0;
            if (!number(reinterpret_cast<std::byte*>(&value), type.octets)) {
                return false;
            }
            std::memcpy(out, &value, sizeof value);
            return true;
        }
        default:
            return number(out, layout_.place(index).size);
        }
    }

  private:
    bool number(std::byte* out, std::size_t size) {
        at_ = (at_ + size - 1) / size * size;
        if (at_ + size > data_.size()) {
            return false;
        }
        std::memcpy(out, data_.data() + at_, size);
        if (swaps_) {
            std::reverse(out, out + size);
        }
        at_ += size;
        return true;
    }

    bool items(std::size_t element, std::size_t count, std::byte* out) {
        Kind const kind = layout_.model().types[element].kind;
        std::size_t const size = layout_.place(element).size;
        bool const as_it_is = !swaps_ && kind != Kind::structure && kind != Kind::array && kind != Kind::sequence &&
                              kind != Kind::string && kind != Kind::boolean && kind != Kind::enumeration;
        if (as_it_is && count > 0) { // a measured curve of thousands of numbers at once
            at_ = (at_ + size - 1) / size * size;
            if (at_ > data_.size() || count > (data_.size() - at_) / size) {
                return false;
            }
            std::memcpy(out, data_.data() + at_, count * size);
            at_ += count * size;
            return true;
        }
        for (std::size_t i = 0; i < count; ++i) {
            if (!read(element, out + i * size)) {
                return false;
            }
        }
        return true;
    }

    bool sequence(Type const& type, std::byte* out) {
        std::uint32_t length = 0;
        if (!number(reinterpret_cast<std::byte*>(&length), sizeof length) || (type.bound != 0 && length > type.bound) ||
            length > (data_.size() - at_) / layout_.place(type.element).min_cdr) {
            return false;
        }
        NativeSequence sequence{length, nullptr};
        if (length > 0) {
            NativeLayout::Place const& element = layout_.place(type.element);
            auto* const items_at = static_cast<std::byte*>(memory_.allocate(length * element.size, element.align));
            std::memset(items_at, 0, length * element.size);
            sequence.items = items_at;
            if (!items(type.element, length, items_at)) {
                return false;
            }
        }
        std::memcpy(out, &sequence, sizeof sequence);
        return true;
    }

    bool text(Type const& type, std::byte* out) {
        std::uint32_t size = 0; // with its NUL
        if (!number(reinterpret_cast<std::byte*>(&size), sizeof size) || size == 0 || size > data_.size() - at_ ||
            (type.bound != 0 && size - 1 > type.bound)) {
            return false;
        }
        auto* const chars = static_cast<char*>(memory_.allocate(size, 1));
        std::memcpy(chars, data_.data() + at_, size);
        chars[size - 1] = '\0';
        at_ += size;
        std::memcpy(out, &chars, sizeof chars);
        return true;
    }

    NativeLayout const& layout_;
    std::span<std::byte const> data_;
    bool swaps_;
    std::pmr::memory_resource& memory_;
    std::size_t at_{0};
};

class Encoder {
  public:
    Encoder(NativeLayout const& layout, std::vector<std::byte>& out) : layout_{layout}, out_{out} {
        out_.assign({std::byte{0}, std::byte{1}, std::byte{0}, std::byte{0}});
    }

    /// What is wrong, empty when nothing is; the path of the member is in `path_` then.
    std::string write(std::size_t index, std::byte const* in) {
        Type const& type = layout_.model().types[index];
        switch (type.kind) {
        case Kind::structure:
            for (std::size_t i = 0; i < type.members.size(); ++i) {
                if (auto wrong = write(type.members[i].type, in + layout_.place(index).offsets[i]); !wrong.empty()) {
                    path_ = type.members[i].name + (path_.empty() || path_.front() == '[' ? "" : ".") + path_;
                    return wrong;
                }
            }
            return {};
        case Kind::array:
            return items(type.element, type.bound, in);
        case Kind::sequence: {
            auto const sequence = value_at<NativeSequence>(in);
            if (type.bound != 0 && sequence.length > type.bound) {
                return fmt::format("holds {} items, and at most {} fit", sequence.length, type.bound);
            }
            if (sequence.length > 0 && sequence.items == nullptr) {
                return fmt::format("says that it holds {} items, and has none", sequence.length);
            }
            number(&sequence.length, sizeof sequence.length);
            return items(type.element, sequence.length, static_cast<std::byte const*>(sequence.items));
        }
        case Kind::string: {
            auto const* const chars = value_at<char const*>(in);
            std::size_t const length = chars == nullptr ? 0 : std::strlen(chars);
            if (type.bound != 0 && length > type.bound) {
                return fmt::format("has {} characters, and at most {} fit", length, type.bound);
            }
            auto const size = static_cast<std::uint32_t>(length + 1);
            number(&size, sizeof size);
            auto const* const octets = reinterpret_cast<std::byte const*>(chars);
            out_.insert(out_.end(), octets, octets + length);
            out_.push_back(std::byte{0});
            return {};
        }
        case Kind::enumeration: {
            auto const value = value_at<std::int32_t>(in);
            if (std::none_of(type.values.begin(), type.values.end(),
                             [&](auto const& v) { return v.second == value; })) {
                return fmt::format("is {}, which is no value of {}", value, type.name);
            }
            number(&value, type.octets);
            return {};
        }
        case Kind::boolean: {
            auto const octet = *in == std::byte{0} ? std::byte{0} : std::byte{1};
            out_.push_back(octet);
            return {};
        }
        case Kind::float32:
        case Kind::float64: {
            double const value =
                type.kind == Kind::float32 ? static_cast<double>(value_at<float>(in)) : value_at<double>(in);
            if (!std::isfinite(value)) {
                return fmt::format("is {}, which is not finite", value);
            }
            [[fallthrough]];
        }
        default:
            number(in, layout_.place(index).size);
            return {};
        }
    }
    [[nodiscard]] std::string const& path() const { return path_; }

  private:
    void number(void const* value, std::size_t size) {
        std::size_t const at = out_.size() - kHeader;
        out_.resize(kHeader + (at + size - 1) / size * size, std::byte{0});
        auto const* const octets = static_cast<std::byte const*>(value);
        out_.insert(out_.end(), octets, octets + size);
    }

    std::string items(std::size_t element, std::size_t count, std::byte const* in) {
        for (std::size_t i = 0; i < count; ++i) {
            if (auto wrong = write(element, advanced(in, i * layout_.place(element).size)); !wrong.empty()) {
                path_ = fmt::format("[{}]{}{}", i, path_.empty() || path_.front() == '[' ? "" : ".", path_);
                return wrong;
            }
        }
        return {};
    }

    NativeLayout const& layout_;
    std::vector<std::byte>& out_;
    std::string path_;
};

} // namespace

bool decode(NativeLayout const& layout, std::span<std::byte const> cdr, void* out, std::pmr::memory_resource& memory) {
    // Encapsulation: 00 00 big endian, 00 01 little endian.
    if (cdr.size() < kHeader || cdr[0] != std::byte{0} || (cdr[1] != std::byte{0} && cdr[1] != std::byte{1})) {
        return false;
    }
    std::memset(out, 0, layout.size());
    return Decoder{layout, cdr, memory}.read(layout.type(), static_cast<std::byte*>(out));
}

Result<void> encode(NativeLayout const& layout, void const* sample, std::vector<std::byte>& out) {
    Encoder encoder{layout, out};
    if (std::string const wrong = encoder.write(layout.type(), static_cast<std::byte const*>(sample)); !wrong.empty()) {
        return fail(ExitCode::usage, fmt::format("{}.{} {}", layout.root().name, encoder.path(), wrong));
    }
    return {};
}

} // namespace gridspace::idl
