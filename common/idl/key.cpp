// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/idl/key.hpp"

#include "common/idl/aligned.hpp"
#include "common/idl/cdr_visitor.hpp"

#include <algorithm>
#include <bit>
#include <fmt/format.h>
#include <optional>

namespace gridspace::idl {
namespace {

constexpr std::size_t kHashOctets = 16;
constexpr int kMaxKeyDepth = 16; ///< of structs in a key; a type that contains itself has no bounded key
/// Members looked at, one in another, to find a key: half a kilobyte of IDL describes one of 4^16 members.
constexpr int kMaxKeySteps = 512;

bool has_key(Type const& type) {
    return std::any_of(type.members.begin(), type.members.end(), [](Type::Member const& m) { return m.key; });
}

/// A nested struct without keys of its own is a key as a whole. False: `steps` were too few.
bool key_members(Model const& model, std::size_t index, std::string const& prefix, int depth, int& steps,
                 std::vector<std::string>& out) {
    for (Type::Member const& member : model.types[index].members) {
        if (!member.key) {
            continue;
        }
        if (--steps < 0) {
            return false;
        }
        Type const& type = model.types[member.type];
        if (type.kind == Kind::structure && has_key(type) && depth < kMaxKeyDepth) {
            if (!key_members(model, member.type, prefix + member.name + ".", depth + 1, steps, out)) {
                return false;
            }
        } else {
            out.push_back(prefix + member.name);
        }
    }
    return true;
}

std::size_t octets_of(Type const& type) {
    switch (type.kind) {
    case Kind::int16:
    case Kind::uint16:
        return 2;
    case Kind::int32:
    case Kind::uint32:
    case Kind::float32:
    case Kind::string: // its length
        return 4;
    case Kind::int64:
    case Kind::uint64:
    case Kind::float64:
        return 8;
    case Kind::enumeration:
        return type.octets;
    default:
        return 1;
    }
}

/// Where the longest value ends that starts at `at`; nothing when that is beyond a hash, or `steps` were too few.
/// `only_keys`: of a struct.
std::optional<std::size_t> longest_end(Model const& model, std::size_t index, std::size_t at, bool only_keys, int depth,
                                       int& steps) {
    if (--steps < 0) {
        return std::nullopt;
    }
    Type const& type = model.types[index];
    std::optional<std::size_t> end = at;
    switch (type.kind) {
    case Kind::structure:
        for (Type::Member const& member : type.members) {
            if (only_keys && !member.key) {
                continue;
            }
            if (end && depth < kMaxKeyDepth) {
                end = longest_end(model, member.type, *end, has_key(model.types[member.type]), depth + 1, steps);
            } else {
                return std::nullopt;
            }
        }
        return end;
    case Kind::sequence:
    case Kind::array: {
        if (type.kind == Kind::sequence && type.bound == 0) {
            return std::nullopt;
        }
        end = type.kind == Kind::sequence ? aligned(at, 4) + 4 : at;
        for (std::uint32_t i = 0; i < type.bound && end; ++i) {
            std::size_t const before = *end;
            end =
                depth < kMaxKeyDepth ? longest_end(model, type.element, before, false, depth + 1, steps) : std::nullopt;
            if (end == before) {
                break; // elements without content
            }
        }
        return end;
    }
    default:
        end = aligned(at, octets_of(type)) + octets_of(type);
        if (type.kind == Kind::string) {
            end = type.bound == 0 ? std::nullopt : std::optional{*end + type.bound + 1};
        }
        return end && *end <= kHashOctets ? end : std::nullopt;
    }
}

struct KeyWriter final : Visitor {
    explicit KeyWriter(KeyFinder const& finder) : key{finder} {}

    void leaf(std::string_view path, Type const& type, Value const& value) override {
        if (!key.covers(path)) {
            return;
        }
        if (std::string const* const text = std::get_if<std::string>(&value); text != nullptr) {
            number(text->size() + 1, 4);
            auto const* octets = reinterpret_cast<std::byte const*>(text->data());
            out.insert(out.end(), octets, octets + text->size());
            out.push_back(std::byte{0});
            return;
        }
        std::size_t const octets = octets_of(type);
        std::uint64_t bits = 0;
        if (double const* const real = std::get_if<double>(&value); real != nullptr) {
            bits = type.kind == Kind::float32 ? std::bit_cast<std::uint32_t>(static_cast<float>(*real))
                                              : std::bit_cast<std::uint64_t>(*real);
        } else if (bool const* const flag = std::get_if<bool>(&value); flag != nullptr) {
            bits = *flag ? 1 : 0;
        } else if (auto const* const integer = std::get_if<std::int64_t>(&value); integer != nullptr) {
            bits = static_cast<std::uint64_t>(*integer);
        } else {
            bits = std::get<std::uint64_t>(value);
        }
        number(bits, octets);
    }
    void sequence(std::string_view path, std::size_t length) override {
        if (key.covers(path)) {
            number(length, 4);
        }
    }

    void number(std::uint64_t bits, std::size_t octets) {
        out.resize(aligned(out.size(), octets));
        for (std::size_t i = octets; i-- > 0;) {
            out.push_back(static_cast<std::byte>(bits >> (8 * i)));
        }
    }

    KeyFinder const& key;
    std::vector<std::byte> out;
};

} // namespace

KeyFinder::KeyFinder(Model const& model, std::size_t type) : model_{model}, type_{type} {
    int steps = kMaxKeySteps;
    is_known_ = key_members(model, type, "", 0, steps, members_);
    if (!is_known_) {
        members_.clear();
    }
    steps = kMaxKeySteps;
    is_short_ = is_known_ && longest_end(model, type, 0, true, 0, steps).has_value();
}

bool KeyFinder::covers(std::string_view path) const {
    return std::any_of(members_.begin(), members_.end(), [&](std::string const& member) {
        return path.starts_with(member) &&
               (path.size() == member.size() || path[member.size()] == '.' || path[member.size()] == '[');
    });
}

Result<std::vector<std::byte>> KeyFinder::key_of(std::span<std::byte const> cdr) const {
    if (!is_known_) {
        return fail(ExitCode::usage, fmt::format("the key of type '{}' has too many members (more than {})",
                                                 model_.types[type_].name, kMaxKeySteps));
    }
    KeyWriter writer{*this};
    if (auto ok = visit(model_, type_, cdr, writer); !ok) {
        return std::unexpected{ok.error()};
    }
    return std::move(writer.out);
}

} // namespace gridspace::idl
