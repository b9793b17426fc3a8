// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/crypto/message_code.hpp"

#include <fmt/format.h>
#include <openssl/core_names.h>
#include <openssl/crypto.h>
#include <openssl/evp.h>
#include <openssl/params.h>

namespace gridspace::crypto {
namespace {

constexpr std::size_t kShortestHmacKey = 16, kGmacOctets = 16;

struct Free {
    void operator()(EVP_MAC* p) const { EVP_MAC_free(p); }
    void operator()(EVP_MAC_CTX* p) const { EVP_MAC_CTX_free(p); }
    void operator()(EVP_CIPHER_CTX* p) const { EVP_CIPHER_CTX_free(p); }
};

} // namespace

struct MessageCode::Impl {
    CodeKind kind{CodeKind::hmac_sha256};
    std::unique_ptr<EVP_MAC, Free> algorithm;
    std::unique_ptr<EVP_MAC_CTX, Free> hmac;
    std::unique_ptr<EVP_CIPHER_CTX, Free> gmac;

    bool prepare(std::span<std::uint8_t const> key) {
        if (kind == CodeKind::aes_gmac) {
            gmac.reset(EVP_CIPHER_CTX_new());
            return gmac != nullptr &&
                   EVP_EncryptInit_ex(gmac.get(), key.size() == 16 ? EVP_aes_128_gcm() : EVP_aes_256_gcm(), nullptr,
                                      key.data(), nullptr) == 1;
        }
        algorithm.reset(EVP_MAC_fetch(nullptr, "HMAC", nullptr));
        hmac.reset(algorithm == nullptr ? nullptr : EVP_MAC_CTX_new(algorithm.get()));
        char digest[] = "SHA256"; // the library's parameters are not const
        std::array<OSSL_PARAM, 2> const parameters{OSSL_PARAM_construct_utf8_string(OSSL_MAC_PARAM_DIGEST, digest, 0),
                                                   OSSL_PARAM_construct_end()};
        return hmac != nullptr && EVP_MAC_init(hmac.get(), key.data(), key.size(), parameters.data()) == 1;
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
        std::size_t octets = 0;
        return EVP_MAC_init(impl_->hmac.get(), nullptr, 0, nullptr) == 1 &&
               EVP_MAC_update(impl_->hmac.get(), message.data(), message.size()) == 1 &&
               EVP_MAC_final(impl_->hmac.get(), out.data(), &octets, out.size()) == 1 && octets == out.size();
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
