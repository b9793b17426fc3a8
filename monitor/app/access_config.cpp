// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "monitor/app/access_config.hpp"

namespace gridspace::monitor {

void describe(config::Fields& f, AccessConfig& config) {
    f.text("listen", config.listen,
           {.doc = "address and port of the dashboard; port 0: a free one, printed. Elsewhere than 127.0.0.1 only with "
                   "a token and TLS"});
    f.references("allow_hosts", config.allow_hosts,
                 {.doc = "names beyond localhost and the address under which it may be reached"});
    f.file("token_file", config.token_file,
           {.doc = "file with the secret of whoever may look at the run: a line of at least 16 characters, mode 0600"});
    f.file("tls_cert", config.tls_cert, {.doc = "its certificate, with those that vouch for it (PEM)"});
    f.file("tls_key", config.tls_key, {.doc = "key of the certificate (PEM)"});
    f.file("idl", config.idl, {.doc = "IDL of foreign types, which nobody publishes on type_catalog"});
}

program::Declaration monitor_declaration() {
    return {.name = "gridspace-monitor",
            .description = "shows a run in a browser, and to programs over REST",
            .role = "monitor",
            .member = false,
            .settings = config::keys_of<AccessConfig>()};
}

} // namespace gridspace::monitor
