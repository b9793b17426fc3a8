// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "launcher/run/tls_client.hpp"

#include <fmt/format.h>
#include <memory>
#include <openssl/err.h>
#include <openssl/ssl.h>

namespace gridspace::launcher {
namespace {

std::string complaint() {
    unsigned long const first = ::ERR_get_error();
    ::ERR_clear_error();
    char const* const why = first == 0 ? nullptr : ::ERR_reason_error_string(first);
    return why == nullptr ? "the connection ended" : why;
}

} // namespace

Result<Answer> exchange_by_tls(int socket, std::filesystem::path const& certificate, std::string const& request) {
    std::unique_ptr<SSL_CTX, decltype(&::SSL_CTX_free)> const context{::SSL_CTX_new(::TLS_client_method()),
                                                                      &::SSL_CTX_free};
    if (context == nullptr || ::SSL_CTX_load_verify_locations(context.get(), certificate.c_str(), nullptr) != 1) {
        return fail(ExitCode::environment,
                    fmt::format("cannot read the certificate '{}': {}", certificate.string(), complaint()));
    }
    ::SSL_CTX_set_min_proto_version(context.get(), TLS1_2_VERSION);
    ::SSL_CTX_set_verify(context.get(), SSL_VERIFY_PEER, nullptr);
    ::X509_VERIFY_PARAM_set_flags(::SSL_CTX_get0_param(context.get()),
                                  X509_V_FLAG_PARTIAL_CHAIN); // it is trusted itself
    std::unique_ptr<SSL, decltype(&::SSL_free)> const tls{::SSL_new(context.get()), &::SSL_free};
    bool const can_try = tls != nullptr && ::SSL_set_fd(tls.get(), socket) == 1;
    int const connected = can_try ? ::SSL_connect(tls.get()) : -1;
    if (can_try && connected != 1 && ::SSL_get_error(tls.get(), connected) == SSL_ERROR_WANT_READ) {
        return Answer{{}, true};
    }
    if (connected != 1) {
        return fail(ExitCode::environment, fmt::format("no TLS with the monitor: {}", complaint()),
                    fmt::format("does it show the certificate '{}'?", certificate.string()));
    }
    if (::SSL_write(tls.get(), request.data(), static_cast<int>(request.size())) <= 0) {
        return fail(ExitCode::environment, "the monitor does not listen: " + complaint());
    }
    Answer answer;
    char buffer[65536];
    int size = 0;
    while ((size = ::SSL_read(tls.get(), buffer, sizeof buffer)) > 0) {
        answer.text.append(buffer, static_cast<std::size_t>(size));
    }
    answer.silent = ::SSL_get_error(tls.get(), size) == SSL_ERROR_WANT_READ; // the socket's patience is over
    ::ERR_clear_error();
    if (!answer.silent) {
        ::SSL_shutdown(tls.get());
    }
    return answer;
}

} // namespace gridspace::launcher
