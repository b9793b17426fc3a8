// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
// The state of a hash is a plain value in the older half of OpenSSL's interface, and a heap object behind a fetch in
// the newer one, which takes more than twice as long for a frame (bench/wire): 240 and 570 ns for 130 octets.
#define OPENSSL_SUPPRESS_DEPRECATED
#include "common/crypto/message_code.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/sha.h>

namespace gridspace::crypto {
namespace {

constexpr std::size_t kShortestHmacKey = 16, kGmacOctets = 16;

struct Free {
    void operator()(EVP_CIPHER_CTX* p) const { EVP_CIPHER_CTX_free(p); }
};

/// HMAC-SHA256 (RFC 2104, clause 4): the states after the padded key, inner and outer, are kept.
class Hmac {
  public:
    bool prepare(std::span<std::uint8_t const> key) {
        std::array<std::uint8_t, SHA256_CBLOCK> block{};
        if (key.size() <= block.size()) {
            std::ranges::copy(key, block.begin());
        } else {
            SHA256(key.data(), key.size(), block.data());
        }
        bool const ready = absorb(inner_, block, 0x36) && absorb(outer_, block, 0x5c);
        wipe(block);
        return ready;
    }
    bool compute(std::span<std::uint8_t const> message, MessageCode::Code& out) const {
        SHA256_CTX inner = inner_, outer = outer_;
        return SHA256_Update(&inner, message.data(), message.size()) == 1 && SHA256_Final(out.data(), &inner) == 1 &&
               SHA256_Update(&outer, out.data(), SHA256_DIGEST_LENGTH) == 1 && SHA256_Final(out.data(), &outer) == 1;
    }
    Hmac() = default;
    Hmac(Hmac const&) = delete;
    Hmac& operator=(Hmac const&) = delete;
    ~Hmac() {
        OPENSSL_cleanse(&inner_, sizeof inner_);
        OPENSSL_cleanse(&outer_, sizeof outer_);
    }

  private:
    static bool absorb(SHA256_CTX& state, std::array<std::uint8_t, SHA256_CBLOCK> block, std::uint8_t pad) {
        for (std::uint8_t& octet : block) {
            octet ^= pad;
        }
        bool const ready = SHA256_Init(&state) == 1 && SHA256_Update(&state, block.data(), block.size()) == 1;
        wipe(block);
        return ready;
    }

    SHA256_CTX inner_{}, outer_{};
};

} // namespace

struct MessageCode::Impl {
    CodeKind kind{CodeKind::hmac_sha256};
    Hmac hmac;
    std::unique_ptr<EVP_CIPHER_CTX, Free> gmac;

    bool prepare(std::span<std::uint8_t const> key) {
        if (kind == CodeKind::hmac_sha256) {
            return hmac.prepare(key);
        }
        gmac.reset(EVP_CIPHER_CTX_new());
        return gmac != nullptr &&
               EVP_EncryptInit_ex(gmac.get(), key.size() == 16 ? EVP_aes_128_gcm() : EVP_aes_256_gcm(), nullptr,
                                  key.data(), nullptr) == 1;
    }
};

MessageCode::MessageCode(std::unique_ptr<Impl> impl) : impl_{std::move(impl)} {}
MessageCode::MessageCode(MessageCode&&) noexcept = default;
MessageCode& MessageCode::operator=(MessageCode&&) noexcept = default;
MessageCode::~MessageCode() = default;

Result<MessageCode> MessageCode::create(CodeKind kind, std::span<std::uint8_t const> key) {
    bool const hmac = kind == CodeKind::hmac_sha256;
    if (hmac ? key.size() < kShortestHmacKey : key.size() != 16 && key.size() != 32) {
        return fail(ExitCode::usage,
                    fmt::format("a key of {} octets for {}", key.size(), hmac ? "HMAC-SHA256" : "AES-GMAC"),
                    hmac ? "expected 16 octets or more, best 32" : "expected 16 or 32 octets");
    }
    auto impl = std::make_unique<Impl>();
    impl->kind = kind;
    if (!impl->prepare(key)) {
        return fail(ExitCode::environment,
                    fmt::format("OpenSSL does not offer {}", hmac ? "HMAC with SHA-256" : "AES-GCM"));
    }
    return MessageCode{std::move(impl)};
}

bool MessageCode::compute(std::span<std::uint8_t const> message, Vector vector, Code& out) noexcept {
    if (impl_->kind == CodeKind::hmac_sha256) {
        return impl_->hmac.compute(message, out);
    }
    int octets = 0;
    EVP_CIPHER_CTX* const context = impl_->gmac.get();
    return EVP_EncryptInit_ex(context, nullptr, nullptr, nullptr, vector.data()) == 1 &&
           EVP_EncryptUpdate(context, nullptr, &octets, message.data(), static_cast<int>(message.size())) == 1 &&
           EVP_EncryptFinal_ex(context, out.data(), &octets) == 1 &&
           EVP_CIPHER_CTX_ctrl(context, EVP_CTRL_GCM_GET_TAG, static_cast<int>(kGmacOctets), out.data()) == 1;
}

bool same_octets(std::span<std::uint8_t const> a, std::span<std::uint8_t const> b) noexcept {
    return a.size() == b.size() && CRYPTO_memcmp(a.data(), b.data(), a.size()) == 0;
}

void wipe(std::span<std::uint8_t> secret) noexcept {
    OPENSSL_cleanse(secret.data(), secret.size());
}

} // namespace gridspace::crypto
