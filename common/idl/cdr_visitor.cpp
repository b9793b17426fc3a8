// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/cdr_visitor.hpp"

#include "common/text.hpp"

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>
#include <limits>

namespace gridspace::idl {
namespace {

constexpr int kMaxDepth = 32;

class Walker {
  public:
    Walker(Model const& model, std::span<std::byte const> cdr, Visitor& visitor)
        : model_{model}, data_{cdr.subspan(std::min<std::size_t>(4, cdr.size()))}, visitor_{visitor} {
        // Encapsulation: 00 00 big endian, 00 01 little endian.
        header_ok_ = cdr.size() >= 4 && cdr[0] == std::byte{0} && (cdr[1] == std::byte{0} || cdr[1] == std::byte{1});
        little_ = header_ok_ && cdr[1] == std::byte{1};
    }

    bool run(std::size_t type) { return header_ok_ && walk(type, 0); }
    [[nodiscard]] std::string const& path() const { return path_; }

  private:
    bool walk(std::size_t index, int depth) {
        // Types without content cost no octets: an array of arrays of them would be walked for ever.
        if (depth > kMaxDepth || ++steps_ > 4096 + kMaxDepth * data_.size()) {
            return false;
        }
        Type const& type = model_.types[index];
        switch (type.kind) {
        case Kind::structure:
            for (Type::Member const& member : type.members) {
                std::size_t const length = path_.size();
                path_.append(path_.empty() ? "" : ".").append(member.name);
                if (!walk(member.type, depth + 1) || visitor_.done()) {
                    return false;
                }
                path_.resize(length);
            }
            return true;
        case Kind::sequence: {
            std::uint32_t count = 0;
            if (!number(count) || (type.bound != 0 && count > type.bound) || count > data_.size()) {
                return false;
            }
            visitor_.sequence(path_, count);
            return elements(type.element, count, depth);
        }
        case Kind::array:
            return elements(type.element, type.bound, depth);
        default:
            return leaf(type);
        }
    }

    bool elements(std::size_t element, std::uint32_t count, int depth) {
        for (std::uint32_t i = 0; i < count; ++i) {
            std::size_t const length = path_.size();
            path_ += fmt::format("[{}]", i);
            if (!walk(element, depth + 1)) {
                return false;
            }
            path_.resize(length);
        }
        return true;
    }

    template <class T>
    bool number(T& value) {
        at_ = (at_ + sizeof(T) - 1) / sizeof(T) * sizeof(T);
        if (at_ + sizeof(T) > data_.size()) {
            return false;
        }
        std::array<std::byte, sizeof(T)> raw;
        std::memcpy(raw.data(), data_.data() + at_, sizeof(T));
        if (little_ != (std::endian::native == std::endian::little)) {
            std::reverse(raw.begin(), raw.end());
        }
        std::memcpy(&value, raw.data(), sizeof(T));
        at_ += sizeof(T);
        return true;
    }

    template <class Raw, class Out>
    bool give(Type const& type) {
        Raw raw{};
        if (!number(raw)) {
            return false;
        }
        visitor_.leaf(path_, type, Value{static_cast<Out>(raw)});
        return true;
    }

    bool leaf(Type const& type) {
        switch (type.kind) {
        case Kind::boolean: {
            std::uint8_t raw = 0;
            if (!number(raw)) {
                return false;
            }
            visitor_.leaf(path_, type, Value{raw != 0});
            return true;
        }
        case Kind::octet:
            return give<std::uint8_t, std::uint64_t>(type);
        case Kind::character:
        case Kind::int8:
            return give<std::int8_t, std::int64_t>(type);
        case Kind::int16:
            return give<std::int16_t, std::int64_t>(type);
        case Kind::uint16:
            return give<std::uint16_t, std::uint64_t>(type);
        case Kind::enumeration:
            return type.octets == 1   ? give<std::uint8_t, std::int64_t>(type)
                   : type.octets == 2 ? give<std::uint16_t, std::int64_t>(type)
                                      : give<std::int32_t, std::int64_t>(type);
        case Kind::int32:
            return give<std::int32_t, std::int64_t>(type);
        case Kind::uint32:
            return give<std::uint32_t, std::uint64_t>(type);
        case Kind::int64:
            return give<std::int64_t, std::int64_t>(type);
        case Kind::uint64:
            return give<std::uint64_t, std::uint64_t>(type);
        case Kind::float32:
            return give<float, double>(type);
        case Kind::float64:
            return give<double, double>(type);
        case Kind::string: {
            std::uint32_t size = 0; // with its terminating NUL
            if (!number(size) || size == 0 || at_ + size > data_.size()) {
                return false;
            }
            visitor_.leaf(path_, type, Value{std::string{reinterpret_cast<char const*>(data_.data() + at_), size - 1}});
            at_ += size;
            return true;
        }
        default:
            return false;
        }
    }

    Model const& model_;
    std::span<std::byte const> data_;
    Visitor& visitor_;
    std::size_t at_{0};
    std::size_t steps_{0};
    bool little_{true}, header_ok_{false};
    std::string path_;
};

} // namespace

std::string to_text(Value const& value) {
    return std::visit(
        [](auto const& v) -> std::string {
            using T = std::decay_t<decltype(v)>;
            if constexpr (std::is_same_v<T, std::string>) {
                return v;
            } else if constexpr (std::is_same_v<T, bool>) {
                return v ? "true" : "false";
            } else if constexpr (std::is_same_v<T, double>) {
                return shortest(v);
            } else {
                return std::to_string(v);
            }
        },
        value);
}

double to_number(Value const& value) {
    return std::visit(
        [](auto const& v) -> double {
            if constexpr (std::is_same_v<std::decay_t<decltype(v)>, std::string>) {
                return std::numeric_limits<double>::quiet_NaN();
            } else {
                return static_cast<double>(v);
            }
        },
        value);
}

Result<void> visit(Model const& model, std::size_t type, std::span<std::byte const> cdr, Visitor& visitor) {
    if (Type const& wanted = model.types[type]; !wanted.unsupported.empty()) {
        return fail(ExitCode::usage,
                    fmt::format("samples of {} cannot be decoded: IDL {}", wanted.name, wanted.unsupported));
    }
    Walker walker{model, cdr, visitor};
    if (!walker.run(type)) {
        return fail(ExitCode::usage,
                    fmt::format("a sample of {} octets does not fit its type {}: it ends or goes wrong at '{}'",
                                cdr.size(), model.types[type].name, walker.path()));
    }
    return {};
}

std::optional<std::int64_t> find_integer(Model const& model, std::size_t type, std::span<std::byte const> cdr,
                                         std::string_view member) {
    struct Finder final : Visitor {
        std::string_view wanted;
        std::optional<std::int64_t> found;
        void leaf(std::string_view path, Type const&, Value const& value) override {
            if (path == wanted) {
                if (auto const* v = std::get_if<std::int64_t>(&value)) {
                    found = *v;
                }
            }
        }
        [[nodiscard]] bool done() const override { return found.has_value(); }
    } finder;
    finder.wanted = member;
    (void)visit(model, type, cdr, finder);
    return finder.found;
}

} // namespace gridspace::idl
