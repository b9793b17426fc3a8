// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"
#include "monitor/web/server.hpp"

#include <memory>

struct ssl_ctx_st; // OpenSSL's SSL_CTX

namespace gridspace::web {

struct TlsContextDeleter {
    void operator()(ssl_ctx_st* context) const;
};
using TlsContext = std::unique_ptr<ssl_ctx_st, TlsContextDeleter>;

/// A server's side of TLS 1.2 and 1.3. An error names the file and what OpenSSL says of it.
[[nodiscard]] Result<TlsContext> load_tls(TlsFiles const& files);

} // namespace gridspace::web
