// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "common/crypto/certificates.hpp"

#include <array>
#include <ctime>
#include <fmt/format.h>
#include <memory>
#include <openssl/bio.h>
#include <openssl/bn.h>
#include <openssl/ec.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/pkcs7.h>
#include <openssl/rand.h>
#include <openssl/x509.h>
#include <openssl/x509v3.h>

namespace gridspace::crypto {
namespace {

struct Free {
    void operator()(BIO* p) const { BIO_free(p); }
    void operator()(EVP_PKEY* p) const { EVP_PKEY_free(p); }
    void operator()(X509* p) const { X509_free(p); }
    void operator()(X509_CRL* p) const { X509_CRL_free(p); }
    void operator()(X509_EXTENSION* p) const { X509_EXTENSION_free(p); }
    void operator()(X509_NAME* p) const { X509_NAME_free(p); }
    void operator()(X509_REVOKED* p) const { X509_REVOKED_free(p); }
    void operator()(ASN1_STRING* p) const { ASN1_STRING_free(p); } // numbers and times too
    void operator()(BIGNUM* p) const { BN_free(p); }
    void operator()(PKCS7* p) const { PKCS7_free(p); }
    void operator()(char* p) const { OPENSSL_free(p); }
};
template <class T>
using Owned = std::unique_ptr<T, Free>;

/// What the library says about its last mistake, and no more of it.
std::unexpected<Error> failure(std::string_view what) {
    std::array<char, 256> text{};
    ERR_error_string_n(ERR_get_error(), text.data(), text.size());
    ERR_clear_error();
    return fail(ExitCode::environment, fmt::format("OpenSSL cannot {}: {}", what, text.data()));
}

Owned<BIO> reading(std::string const& text) {
    return Owned<BIO>{BIO_new_mem_buf(text.data(), static_cast<int>(text.size()))};
}
std::string text_of(BIO* bio) {
    char* data = nullptr;
    long const size = BIO_get_mem_data(bio, &data);
    return size > 0 ? std::string(data, static_cast<std::size_t>(size)) : std::string{};
}

Owned<X509> certificate_of(std::string const& pem) {
    auto const in = reading(pem);
    return Owned<X509>{PEM_read_bio_X509(in.get(), nullptr, nullptr, nullptr)};
}
Owned<EVP_PKEY> key_of(std::string const& pem) {
    auto const in = reading(pem);
    return Owned<EVP_PKEY>{PEM_read_bio_PrivateKey(in.get(), nullptr, nullptr, nullptr)};
}

bool set_time(ASN1_TIME* to, std::int64_t unix_s) {
    return ASN1_TIME_set(to, static_cast<std::time_t>(unix_s)) != nullptr;
}
bool set_validity(X509* certificate, Validity valid) {
    return set_time(X509_getm_notBefore(certificate), valid.from_unix_s) &&
           set_time(X509_getm_notAfter(certificate), valid.until_unix_s);
}
std::int64_t unix_of(ASN1_TIME const* time) {
    std::tm parts{};
    return ASN1_TIME_to_tm(time, &parts) == 1 ? static_cast<std::int64_t>(timegm(&parts)) : 0;
}

/// 126 random bits, and never 0: two certificates of an authority must not have the same (RFC 5280, 4.1.2.2).
bool set_serial(X509* certificate) {
    std::array<unsigned char, 16> octets{};
    if (RAND_bytes(octets.data(), static_cast<int>(octets.size())) != 1) {
        return false;
    }
    octets[0] = static_cast<unsigned char>((octets[0] & 0x3fU) | 0x20U);
    Owned<BIGNUM> const number{BN_bin2bn(octets.data(), static_cast<int>(octets.size()), nullptr)};
    return number != nullptr && BN_to_ASN1_INTEGER(number.get(), X509_get_serialNumber(certificate)) != nullptr;
}
std::string hexadecimal(ASN1_INTEGER const* serial) {
    Owned<BIGNUM> const number{ASN1_INTEGER_to_BN(serial, nullptr)};
    Owned<char> const text{number == nullptr ? nullptr : BN_bn2hex(number.get())};
    return text == nullptr ? "" : text.get();
}

bool set_subject(X509* certificate, std::string_view common_name) {
    Owned<X509_NAME> const name{X509_NAME_new()};
    auto const add = [&](char const* field, std::string_view value) {
        return X509_NAME_add_entry_by_txt(name.get(), field, MBSTRING_UTF8,
                                          reinterpret_cast<unsigned char const*>(value.data()),
                                          static_cast<int>(value.size()), -1, 0) == 1;
    };
    return name != nullptr && add("O", "Gridspace") && add("CN", common_name) &&
           X509_set_subject_name(certificate, name.get()) == 1;
}

bool add_extension(X509* certificate, X509* issuer, int kind, char const* value) {
    X509V3_CTX context;
    X509V3_set_ctx_nodb(&context);
    X509V3_set_ctx(&context, issuer, certificate, nullptr, nullptr, 0);
    Owned<X509_EXTENSION> const extension{X509V3_EXT_conf_nid(nullptr, &context, kind, value)};
    return extension != nullptr && X509_add_ext(certificate, extension.get(), -1) == 1;
}

/// `issuer` and `issuer_key` null: it signs itself, and may sign others.
Result<Identity> make(std::string_view common_name, Validity valid, X509* issuer, EVP_PKEY* issuer_key) {
    if (common_name.empty() || common_name.size() > kLongestCommonName) {
        return fail(ExitCode::usage,
                    fmt::format("'{}' cannot be the name in a certificate: it has {} characters", common_name,
                                common_name.size()),
                    fmt::format("1 to {}", kLongestCommonName));
    }
    Owned<EVP_PKEY> const key{EVP_EC_gen("P-256")};
    Owned<X509> const certificate{X509_new()};
    if (key == nullptr || certificate == nullptr) {
        return failure("make a key");
    }
    X509* const by = issuer != nullptr ? issuer : certificate.get();
    bool const authority = issuer == nullptr;
    bool const made =
        X509_set_version(certificate.get(), X509_VERSION_3) == 1 && set_serial(certificate.get()) &&
        set_validity(certificate.get(), valid) && set_subject(certificate.get(), common_name) &&
        X509_set_issuer_name(certificate.get(), X509_get_subject_name(by)) == 1 &&
        X509_set_pubkey(certificate.get(), key.get()) == 1 &&
        add_extension(certificate.get(), by, NID_basic_constraints,
                      authority ? "critical,CA:TRUE,pathlen:0" : "critical,CA:FALSE") &&
        add_extension(certificate.get(), by, NID_key_usage,
                      authority ? "critical,keyCertSign,cRLSign,digitalSignature" : "critical,digitalSignature") &&
        X509_sign(certificate.get(), authority ? key.get() : issuer_key, EVP_sha256()) > 0;
    Owned<BIO> const out{BIO_new(BIO_s_mem())}, secret{BIO_new(BIO_s_secmem())};
    if (!made || PEM_write_bio_X509(out.get(), certificate.get()) != 1 ||
        PEM_write_bio_PKCS8PrivateKey(secret.get(), key.get(), nullptr, nullptr, 0, nullptr, nullptr) != 1) {
        return failure(fmt::format("make the certificate of '{}'", common_name));
    }
    return Identity{text_of(out.get()), text_of(secret.get())};
}

} // namespace

Result<Identity> make_authority(std::string_view common_name, Validity valid) {
    return make(common_name, valid, nullptr, nullptr);
}

Result<Identity> issue(Identity const& authority, std::string_view common_name, Validity valid) {
    auto const certificate = certificate_of(authority.certificate);
    auto const key = key_of(authority.key);
    if (certificate == nullptr || key == nullptr) {
        return failure("read the authority's certificate and key");
    }
    return make(common_name, valid, certificate.get(), key.get());
}

Result<CertificateFacts> facts_of(std::string const& pem) {
    auto const certificate = certificate_of(pem);
    if (certificate == nullptr) {
        return failure("read a certificate");
    }
    CertificateFacts facts;
    X509_NAME* const subject = X509_get_subject_name(certificate.get());
    Owned<BIO> const text{BIO_new(BIO_s_mem())};
    if (X509_NAME_print_ex(text.get(), subject, 0, XN_FLAG_RFC2253 & ~ASN1_STRFLGS_ESC_MSB) < 0) {
        return failure("read the subject of a certificate");
    }
    facts.subject = text_of(text.get());
    if (int const at = X509_NAME_get_index_by_NID(subject, NID_commonName, -1); at >= 0) {
        ASN1_STRING const* const value = X509_NAME_ENTRY_get_data(X509_NAME_get_entry(subject, at));
        facts.name.assign(reinterpret_cast<char const*>(ASN1_STRING_get0_data(value)),
                          static_cast<std::size_t>(ASN1_STRING_length(value)));
    }
    facts.serial = hexadecimal(X509_get0_serialNumber(certificate.get()));
    facts.valid = {unix_of(X509_get0_notBefore(certificate.get())), unix_of(X509_get0_notAfter(certificate.get()))};
    return facts;
}

bool is_signed_by(std::string const& certificate, std::string const& authority) {
    auto const who = certificate_of(certificate), by = certificate_of(authority);
    bool const yes = who != nullptr && by != nullptr &&
                     X509_NAME_cmp(X509_get_issuer_name(who.get()), X509_get_subject_name(by.get())) == 0 &&
                     X509_verify(who.get(), X509_get0_pubkey(by.get())) == 1;
    ERR_clear_error();
    return yes;
}

Result<std::string> revocation_list(Identity const& authority, std::span<std::string const> serials, Validity valid) {
    auto const by = certificate_of(authority.certificate);
    auto const key = key_of(authority.key);
    Owned<X509_CRL> const list{X509_CRL_new()};
    Owned<ASN1_TIME> const from{ASN1_TIME_set(nullptr, static_cast<std::time_t>(valid.from_unix_s))};
    Owned<ASN1_TIME> const until{ASN1_TIME_set(nullptr, static_cast<std::time_t>(valid.until_unix_s))};
    if (by == nullptr || key == nullptr || list == nullptr || from == nullptr || until == nullptr) {
        return failure("read the authority's certificate and key");
    }
    bool made = X509_CRL_set_version(list.get(), X509_CRL_VERSION_2) == 1 &&
                X509_CRL_set_issuer_name(list.get(), X509_get_subject_name(by.get())) == 1 &&
                X509_CRL_set1_lastUpdate(list.get(), from.get()) == 1 &&
                X509_CRL_set1_nextUpdate(list.get(), until.get()) == 1;
    for (std::string const& serial : serials) {
        BIGNUM* read = nullptr;
        int const digits = BN_hex2bn(&read, serial.c_str());
        Owned<BIGNUM> const number{read};
        Owned<ASN1_INTEGER> const value{number == nullptr ? nullptr : BN_to_ASN1_INTEGER(number.get(), nullptr)};
        Owned<X509_REVOKED> entry{X509_REVOKED_new()};
        made = made && digits > 0 && static_cast<std::size_t>(digits) == serial.size() && value != nullptr &&
               X509_REVOKED_set_serialNumber(entry.get(), value.get()) == 1 &&
               X509_REVOKED_set_revocationDate(entry.get(), from.get()) == 1 &&
               X509_CRL_add0_revoked(list.get(), entry.get()) == 1;
        if (made) {
            (void)entry.release(); // the list's now
        }
    }
    Owned<BIO> const out{BIO_new(BIO_s_mem())};
    if (!made || X509_CRL_sort(list.get()) != 1 || X509_CRL_sign(list.get(), key.get(), EVP_sha256()) <= 0 ||
        PEM_write_bio_X509_CRL(out.get(), list.get()) != 1) {
        return failure("make a list of revoked certificates");
    }
    return text_of(out.get());
}

Result<std::vector<std::string>> revoked_serials(std::string const& list, std::string const& authority) {
    auto const in = reading(list);
    Owned<X509_CRL> const crl{PEM_read_bio_X509_CRL(in.get(), nullptr, nullptr, nullptr)};
    auto const by = certificate_of(authority);
    if (crl == nullptr || by == nullptr) {
        return failure("read a list of revoked certificates");
    }
    if (X509_CRL_verify(crl.get(), X509_get0_pubkey(by.get())) != 1) {
        return failure("confirm who has signed the list of revoked certificates");
    }
    std::vector<std::string> out;
    STACK_OF(X509_REVOKED)* const entries = X509_CRL_get_REVOKED(crl.get());
    for (int i = 0; i < sk_X509_REVOKED_num(entries); ++i) {
        out.push_back(hexadecimal(X509_REVOKED_get0_serialNumber(sk_X509_REVOKED_value(entries, i))));
    }
    return out;
}

Result<std::string> sign_document(Identity const& authority, std::string const& text) {
    auto const by = certificate_of(authority.certificate);
    auto const key = key_of(authority.key);
    auto const in = reading(text);
    if (by == nullptr || key == nullptr || in == nullptr) {
        return failure("read the authority's certificate and key");
    }
    constexpr int kFlags = PKCS7_DETACHED | PKCS7_TEXT;
    Owned<PKCS7> const signature{PKCS7_sign(by.get(), key.get(), nullptr, in.get(), kFlags)};
    auto const again = reading(text);
    Owned<BIO> const out{BIO_new(BIO_s_mem())};
    if (signature == nullptr || SMIME_write_PKCS7(out.get(), signature.get(), again.get(), kFlags) != 1) {
        return failure("sign a document");
    }
    return text_of(out.get());
}

} // namespace gridspace::crypto
