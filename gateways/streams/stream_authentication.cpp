// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#include "gateways/streams/stream_authentication.hpp"

namespace gridspace::streams {

void describe(config::Fields& f, std::optional<StreamAuthentication>& authentication) {
    using Algorithm = iec61850::CodeAlgorithm;
    StreamAuthentication read;
    bool const given = f.object(
        "authentication", {.doc = "frames carry a code made with a secret key, in the style of IEC 62351-6"},
        [&](config::Fields& a) {
            a.file("key_file", read.key_file,
                   {.doc = "file of keys, mode 0600: lines of `ID SECRET [from=TIME] [until=TIME]`"});
            a.text(
                "key_name", read.key_name,
                {.doc = "instead of a file, for studies: a key that is computed from this name, and so is no secret"});
            a.choice<Algorithm>("algorithm", read.algorithm,
                                {{"hmac_sha256", Algorithm::hmac_sha256_128},
                                 {"hmac_sha256_80", Algorithm::hmac_sha256_80},
                                 {"hmac_sha256_256", Algorithm::hmac_sha256_256},
                                 {"aes_gmac", Algorithm::aes_gmac_128},
                                 {"aes_gmac_64", Algorithm::aes_gmac_64}},
                                {.doc = "codes of 128 bits, or of as many as the name says"});
            a.flag("required", read.required,
                   {.doc = "subscribers do not use a frame that is not genuine; false: they use and report it"});
            a.number("max_age_ms", read.max_age_ms,
                     {.doc =
                          "farthest that the time in a frame may be from the receiver's UTC; 0: not judged, for clocks "
                          "that are not synchronised",
                      .min = 0});
            if (read.key_file.empty() == read.key_name.empty()) {
                a.error("", "which key?", "expected one of key_file and key_name");
            }
        });
    if (given) {
        authentication = read;
    }
}

} // namespace gridspace::streams
