// SPDX-FileCopyrightText: 2026 Gridspace contributors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include "common/result.hpp"

#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace gridspace::crypto {

/// From when to when something is valid, seconds since 1970, UTC.
struct Validity {
    std::int64_t from_unix_s{0}, until_unix_s{0};
};

/// A certificate (X.509) and the private key that belongs to it (PKCS #8, not encrypted), as PEM.
struct Identity {
    std::string certificate, key;
};

/// What a certificate says.
struct CertificateFacts {
    std::string subject; ///< as RFC 2253 writes it: "CN=relay2,O=Gridspace"
    std::string name;    ///< its common name alone
    std::string serial;  ///< hexadecimal
    Validity valid;
};

inline constexpr std::size_t kLongestCommonName = 64; ///< RFC 5280, ub-common-name

/// A new authority, which signs its own certificate: ECDSA with SHA-256 on P-256, as all keys here.
[[nodiscard]] Result<Identity> make_authority(std::string_view common_name, Validity valid);
/// A new key, and a certificate for it that the authority signs. It can sign nothing but its owner's words.
[[nodiscard]] Result<Identity> issue(Identity const& authority, std::string_view common_name, Validity valid);

[[nodiscard]] Result<CertificateFacts> facts_of(std::string const& certificate);
/// Whether the authority has signed the certificate, whatever the time is.
[[nodiscard]] bool is_signed_by(std::string const& certificate, std::string const& authority);

/// A list of serial numbers (hexadecimal) that are not to be believed any more, signed by the authority; PEM.
[[nodiscard]] Result<std::string> revocation_list(Identity const& authority, std::span<std::string const> serials,
                                                  Validity valid);
/// The serial numbers of such a list; fails when the authority has not signed it.
[[nodiscard]] Result<std::vector<std::string>> revoked_serials(std::string const& list, std::string const& authority);

/// A text with the authority's signature behind it: S/MIME 2, clear text, as DDS Security wants its documents.
[[nodiscard]] Result<std::string> sign_document(Identity const& authority, std::string const& text);

} // namespace gridspace::crypto
