// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/web/tls.hpp"

#include <algorithm>
#include <cctype>
#include <fmt/format.h>
#include <openssl/err.h>
#include <openssl/ssl.h>
#include <openssl/x509v3.h>
#include <sys/stat.h>

namespace gridspace::web {
namespace {

/// The first of OpenSSL's complaints, in its words.
std::string complaint() {
    unsigned long const first = ::ERR_get_error();
    ::ERR_clear_error();
    char const* const why = first == 0 ? nullptr : ::ERR_reason_error_string(first);
    return why == nullptr ? "it is not a PEM file" : why;
}

std::unexpected<Error> refuse(std::filesystem::path const& file, char const* what) {
    return std::unexpected{Error{ExitCode::usage, fmt::format("'{}' is no {}: {}", file.string(), what, complaint()),
                                 "for a laboratory: openssl req -x509 -newkey rsa:2048 -nodes -days 365 -subj /CN=HOST "
                                 "-addext subjectAltName=DNS:HOST -keyout key.pem -out cert.pem"}};
}

/// Nobody is asked for the passphrase of a key while a run starts.
int no_passphrase(char*, int, int, void*) {
    return -1;
}

} // namespace

void TlsContextDeleter::operator()(ssl_ctx_st* context) const {
    ::SSL_CTX_free(context);
}

std::vector<std::string> names_of(ssl_ctx_st* context) {
    std::vector<std::string> out;
    auto const add = [&out](ASN1_STRING const* text) {
        std::string name{reinterpret_cast<char const*>(::ASN1_STRING_get0_data(text)),
                         static_cast<std::size_t>(::ASN1_STRING_length(text))};
        std::transform(name.begin(), name.end(), name.begin(),
                       [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
        bool const plain = std::all_of(name.begin(), name.end(),
                                       [](unsigned char c) { return std::isalnum(c) != 0 || c == '-' || c == '.'; });
        if (plain && !name.empty()) {
            out.push_back(std::move(name));
        }
    };
    X509* const certificate = ::SSL_CTX_get0_certificate(context);
    if (certificate == nullptr) {
        return out;
    }
    bool named = false;
    if (auto* const names =
            static_cast<GENERAL_NAMES*>(::X509_get_ext_d2i(certificate, NID_subject_alt_name, nullptr, nullptr))) {
        for (int i = 0; i < sk_GENERAL_NAME_num(names); ++i) {
            GENERAL_NAME const* const name = sk_GENERAL_NAME_value(names, i);
            if (name->type == GEN_DNS) {
                named = true;
                add(name->d.dNSName);
            }
        }
        ::GENERAL_NAMES_free(names);
    }
    X509_NAME* const subject = ::X509_get_subject_name(certificate);
    int const at = ::X509_NAME_get_index_by_NID(subject, NID_commonName, -1);
    if (!named && at >= 0) {
        add(::X509_NAME_ENTRY_get_data(::X509_NAME_get_entry(subject, at)));
    }
    return out;
}

Result<TlsContext> load_tls(TlsFiles const& files) {
    struct stat state{};
    for (std::filesystem::path const& file : {files.certificate, files.key}) {
        if (::stat(file.c_str(), &state) != 0) {
            return fail(ExitCode::usage, fmt::format("there is no file '{}'", file.string()),
                        "tls_cert and tls_key name a certificate and its key, both PEM");
        }
    }
    if ((state.st_mode & 007) != 0) { // of the key, which was looked at last; a group for keys is usual
        return fail(ExitCode::usage,
                    fmt::format("the key '{}' can be read by everybody (mode {:03o})", files.key.string(),
                                state.st_mode & 0777U),
                    fmt::format("chmod 600 {}", files.key.string()));
    }
    TlsContext context{::SSL_CTX_new(::TLS_server_method())};
    if (context == nullptr) {
        return fail(ExitCode::environment, "OpenSSL does not start: " + complaint());
    }
    ::SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
    ::SSL_CTX_set_options(context.get(), SSL_OP_NO_RENEGOTIATION | SSL_OP_CIPHER_SERVER_PREFERENCE);
    ::SSL_CTX_set_default_passwd_cb(context.get(), no_passphrase);
    if (::SSL_CTX_use_certificate_chain_file(context.get(), files.certificate.c_str()) != 1) {
        return refuse(files.certificate, "certificate");
    }
    if (::SSL_CTX_use_PrivateKey_file(context.get(), files.key.c_str(), SSL_FILETYPE_PEM) != 1 ||
        ::SSL_CTX_check_private_key(context.get()) != 1) {
        return refuse(files.key, "key of that certificate");
    }
    return context;
}

} // namespace gridspace::web
