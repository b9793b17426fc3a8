// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <array>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>

namespace gridspace::crypto {

/// How a message is authenticated with a secret that both ends have.
enum class CodeKind : std::uint8_t {
    hmac_sha256, ///< RFC 2104; a key of at least 16 octets, no initialisation vector; 32 octets
    aes_gmac,    ///< NIST SP 800-38D; a key of 16 or 32 octets, an initialisation vector of 12 octets; 16 octets
};

inline constexpr std::size_t kLongestCode = 32, kVectorOctets = 12;

/// Computes message authentication codes with one key, which is prepared once. Not thread-safe; no allocation of its
/// own after create(). The key is wiped from memory with it.
class MessageCode {
  public:
    using Code = std::array<std::uint8_t, kLongestCode>;
    using Vector = std::span<std::uint8_t const, kVectorOctets>;

    /// Fails when the key does not have a length that the kind allows, or the library does not have the algorithm.
    [[nodiscard]] static Result<MessageCode> create(CodeKind kind, std::span<std::uint8_t const> key);
    MessageCode(MessageCode&&) noexcept;
    MessageCode& operator=(MessageCode&&) noexcept;
    ~MessageCode();

    /// The code of `message`, in the first 32 or 16 octets. `vector` is for GMAC, and must never come twice with one
    /// key. False when the library fails: there is then no code.
    [[nodiscard]] bool compute(std::span<std::uint8_t const> message, Vector vector, Code& out) noexcept;

    struct Impl;

  private:
    explicit MessageCode(std::unique_ptr<Impl> impl);
    std::unique_ptr<Impl> impl_;
};

/// Whether both are the same; the time it takes depends on their length alone.
[[nodiscard]] bool same_octets(std::span<std::uint8_t const> a, std::span<std::uint8_t const> b) noexcept;

/// Overwrites a secret, also where a compiler would think that nobody looks.
void wipe(std::span<std::uint8_t> secret) noexcept;

} // namespace gridspace::crypto
