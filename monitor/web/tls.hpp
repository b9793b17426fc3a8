// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "monitor/web/server.hpp"

#include <memory>
#include <string>
#include <vector>

struct ssl_ctx_st; // OpenSSL's SSL_CTX

namespace gridspace::web {

struct TlsContextDeleter {
    void operator()(ssl_ctx_st* context) const;
};
using TlsContext = std::unique_ptr<ssl_ctx_st, TlsContextDeleter>;

/// The host names for which the certificate of a context speaks, in small letters: the DNS names of its subjectAltName,
/// or where there are none its common name. Patterns (*.lab) are left out.
[[nodiscard]] std::vector<std::string> names_of(ssl_ctx_st* context);

/// A server's side of TLS 1.2 and 1.3. An error names the file and what OpenSSL says of it.
[[nodiscard]] Result<TlsContext> load_tls(TlsFiles const& files);

} // namespace gridspace::web
